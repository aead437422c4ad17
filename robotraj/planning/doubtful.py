"""What is doubtful about a problem and its settings before the first solve."""

from __future__ import annotations

from robotraj.planning.settings import GIVEN
from robotraj.problem.links.unlinked_phases import warn_of_unlinked_phases
from robotraj.problem.objectives.duration import warn_of_fixed_durations
from robotraj.problem.problem import Problem
from robotraj.solution.settings import Settings


def warn_of_doubtful(problem: Problem, settings: Settings) -> None:
    """Warn of a given mesh, of phases, durations and constraints that are seldom meant so.

    Raises
    ------
    InputError
        A moving obstacle comes nearer to a fixed end of the first phase than its margin.
    """
    if settings.reasons.get("mesh") == GIVEN:
        from robotraj.fixed_mesh.diagnosis.mesh_warnings import warn_of_mesh

        warn_of_mesh(problem, settings)
    warn_of_unlinked_phases(problem)
    warn_of_fixed_durations(problem.phases)
    first = problem.phases[0]
    if any(each.avoids_collisions for each in first.constraints):
        from robotraj.problem.clearance.end_checks import check_moving_obstacles

        check_moving_obstacles(first.name, first.constraints, first.robot, first.joint_ends, first.duration_bounds)
    fixed = any(phase.robot is not None and phase.robot.root == "fixed" for phase in problem.phases)
    if settings.goals is not None and fixed and any(phase.constraints for phase in problem.phases):
        from robotraj.fixed_mesh.diagnosis.oscillation import warn_of_oscillation

        warn_of_oscillation(problem)
