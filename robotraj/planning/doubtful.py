"""What is doubtful about a problem and its settings before the first solve."""

from __future__ import annotations

import numpy as np

from robotraj._util.errors import warn
from robotraj.planning.settings import GIVEN
from robotraj.problem.constraints.differential_drive import DifferentialDrive
from robotraj.problem.links.continuity import TIME
from robotraj.problem.objectives.base import Integral
from robotraj.problem.objectives.duration import Duration, warn_of_fixed_durations
from robotraj.problem.phase import Phase
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
        warn_of_oscillation(problem)


def warn_of_oscillation(problem: Problem) -> None:
    """Warn of phases of least time whose joints may oscillate, and name the cost that makes their motion unique.

    Warns
    -----
    UserWarning
    """
    for phase in problem.phases:
        limit = next((type(each).__name__ for each in phase.constraints if isinstance(each, DifferentialDrive)), None)
        if limit is not None and _takes_least_time(phase):
            warn(
                f"Phase {phase.name!r}: in least time under {limit}, joints may oscillate, and plans take long. "
                "Add 1e-3 * rt.objectives.SpeedVariation() to the objective."
            )


def _takes_least_time(phase: Phase) -> bool:
    terms = [term for _, term in phase.objective.terms] if phase.objective else []
    return any(isinstance(each, Duration) for each in terms) and not any(isinstance(each, Integral) for each in terms)


def warn_of_unlinked_phases(problem: Problem) -> None:
    """Warn of phases with the states of the one before that no link and no equal given states join to an earlier one.

    Warns
    -----
    UserWarning
        Names both phases and the link that is mostly meant.
    """
    joined = [link.phases for link in problem.bound_links if any(row is not TIME for row in link.rows)]
    for i, phase in enumerate(problem.phases[1:], 1):
        before = problem.phases[i - 1]
        linked = any(i in each and min(each) < i for each in joined)
        if linked or before.body.states != phase.body.states or _meet(before, phase):
            continue
        warn(
            f"Phases {before.name!r} and {phase.name!r} are not linked, so that the state may jump between them. Give "
            f"rt.Problem(phases, links=[rt.Continuity({i - 1}, {i})])."
        )


def _meet(before: Phase, after: Phase) -> bool:
    """Whether the given end of a phase is the given start of the next one."""
    end, start = before.end_bounds, after.start_bounds
    given = (end.lower, end.upper, start.lower, start.upper)
    return all(np.array_equal(given[0], each) for each in given[1:])
