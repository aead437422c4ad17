"""Warnings of a given mesh before planning: long plans by shooting, and power that collocation does not see.

A plan of an arm by shooting may take over a minute. An iteration evaluates second derivatives of every interval. It
takes (intervals) (variables of an interval) (operations of its integrator) operations. The variables of single shooting
are the controls of all intervals. Those of multiple shooting are one state and the controls of one interval. The
operations of forward dynamics are proportional to the number of joints.

Mechanical work is summed at collocation points. A torque that is free in the middle of an interval can oscillate there,
so that the work of the motion is several times the objective.
"""

from __future__ import annotations

from collections.abc import Sequence

from robotraj._util.errors import warn
from robotraj.problem.objectives.work import MechanicalWork
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.settings import Settings
from robotraj.transcription.schemes.collocation import Collocation, Scheme
from robotraj.transcription.schemes.integrators import RungeKutta4
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.shooting import Shooting, SingleShooting
from robotraj.transcription.transcribe import meshes_of

LONG = 60.0
"""Seconds above which a plan counts as long."""
ITERATIONS = 50
"""Iterations of multiple shooting without a good guess, and half of those of single shooting.

Some motions of a ur5 took over 400 by single shooting with ten intervals.
"""
SECONDS = 1.9e-5
"""Processor time of the forward dynamics of a joint and their derivatives [s]; measured with a ur5."""


def shooting_seconds(problem: Problem, mesh: Mesh | Sequence[Mesh]) -> float:
    """Return the estimated processor time [s] of the phases with shooting, 0 without any."""
    total = 0.0
    for phase, own in zip(problem.phases, meshes_of(problem, mesh), strict=True):
        scheme = own.schemes[0]
        if phase.robot is None or not isinstance(scheme, Shooting):
            continue
        # A step of Runge and Kutta evaluates the dynamics four times.
        evaluations = 4 * (scheme.integrator.substeps if isinstance(scheme.integrator, RungeKutta4) else 1)
        nu, nx = phase.robot.nu, 2 * phase.robot.nv
        variables = own.count * nu if isinstance(scheme, SingleShooting) else nx + nu
        iterations = 2 * ITERATIONS if isinstance(scheme, SingleShooting) else ITERATIONS
        total += iterations * own.count * variables * evaluations * phase.robot.nv
    return SECONDS * total


def hides_power(problem: Problem, mesh: Mesh | Sequence[Mesh]) -> bool:
    """Whether a phase minimises exact works of a robot whose torques are free inside the intervals."""
    return any(
        _minimises_work(phase) and any(_has_free_inner_controls(scheme) for scheme in own.given)
        for phase, own in zip(problem.phases, meshes_of(problem, mesh), strict=True)
    )


def warn_of_mesh(problem: Problem, settings: Settings) -> None:
    """Warn of shooting that would take over a minute, and of power that a mesh without refinement hides.

    Warns
    -----
    UserWarning

    Raises
    ------
    InputError
        There are fewer or more meshes than phases.
    """
    if settings.refinement is None and hides_power(problem, settings.mesh):
        warn(
            "Torques on this mesh are free between the knots and can hide power there, which the mechanical work does "
            "not count: leave mesh= open, or give rt.Mesh(n, rt.HermiteSimpson(control=rt.schemes.LinearControl()))."
        )
    seconds = shooting_seconds(problem, settings.mesh)
    if seconds > LONG:
        warn(
            f"Shooting on this mesh takes about {seconds:.0f} s of processor time "
            f"({seconds / LONG:.0f} minutes). Use collocation with inner points, such as mesh=rt.Mesh(20) or no mesh, "
            "or fewer intervals. time_limit= bounds the time."
        )


def _minimises_work(phase: Phase) -> bool:
    works = [term for _, term in phase.integrals if isinstance(term, MechanicalWork)]
    on_path_or_system = phase.robot is None or phase.path is not None
    return not on_path_or_system and any(term.smoothing is None for term in works)


def _has_free_inner_controls(scheme: Scheme) -> bool:
    """Whether controls are more than lines, which have two sites."""
    return isinstance(scheme, Collocation) and len(scheme.control_sites) > 2
