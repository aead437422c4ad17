"""A warning before planning: a plan of an arm by shooting that would take over a minute.

An iteration evaluates second derivatives of every interval. It takes (intervals) (variables of an interval) (operations
of its integrator) operations. The variables of single shooting are the controls of all intervals. Those of multiple
shooting are one state and the controls of one interval. The operations of forward dynamics are proportional to the
number of joints.
"""

from __future__ import annotations

from collections.abc import Sequence

from robotraj._util.errors import warn
from robotraj.problem.problem import Problem
from robotraj.transcription.schemes.integrators import RungeKutta4
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.shooting import Shooting, SingleShooting

LONG = 60.0
"""Seconds above which a plan counts as long."""
OPERATIONS = 380
"""Operations of the articulated-body algorithm for each joint."""
STAGES = 4
"""Evaluations in a step of Runge-Kutta."""
ITERATIONS, ITERATIONS_SINGLE = 50, 100
"""Iterations of multiple and of single shooting without a good guess. Some motions of a ur5 took over 400 by single
shooting with ten intervals."""
SECONDS = 5e-8
"""Processor time of an operation, its derivatives and interpretation [s]; measured with a ur5."""


def shooting_seconds(problem: Problem, mesh: Mesh | Sequence[Mesh]) -> float:
    """Return the estimated processor time [s] of the phases with shooting, 0 without any."""
    meshes = (mesh,) * len(problem.phases) if isinstance(mesh, Mesh) else tuple(mesh)
    total = 0.0
    for phase, own in zip(problem.phases, meshes, strict=True):
        scheme = own.schemes[0]
        if phase.robot is None or not isinstance(scheme, Shooting):
            continue
        evaluations = STAGES * (scheme.integrator.substeps if isinstance(scheme.integrator, RungeKutta4) else 1)
        nu, nx = phase.robot.nu, 2 * phase.robot.nv
        variables = own.count * nu if isinstance(scheme, SingleShooting) else nx + nu
        iterations = ITERATIONS_SINGLE if isinstance(scheme, SingleShooting) else ITERATIONS
        total += iterations * own.count * variables * evaluations * OPERATIONS * phase.robot.nv
    return SECONDS * total


def warn_of_long_shooting(problem: Problem, mesh: Mesh | Sequence[Mesh]) -> None:
    """Warn of shooting that would take over a minute, and name what takes less.

    Warns
    -----
    UserWarning
    """
    seconds = shooting_seconds(problem, mesh)
    if seconds > LONG:
        warn(
            f"Shooting on this mesh takes about {seconds:.0f} s of processor time "
            f"({seconds / LONG:.0f} minutes). Use collocation with inner points, such as mesh=rt.Mesh(20) or no mesh, "
            "or fewer intervals. time_limit= bounds the time."
        )
