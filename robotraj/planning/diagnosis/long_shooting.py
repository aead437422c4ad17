"""A warning before planning: a shooting plan of an arm that would take over a minute.

An iteration evaluates second derivatives of every interval: (intervals) (variables of an interval) (operations of its
integrator) steps. Single shooting has the controls of all intervals as variables, multiple shooting a state and the
controls of one. The forward dynamics of a robot take operations in proportion to its joints.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

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
ITERATIONS = 50
"""Those of a solve that has no good guess."""
SECONDS = 5e-8
"""Processor time of an operation, its derivatives and interpretation [s]; measured with a ur5."""


def shooting_seconds(problem: Problem, mesh: Mesh | Sequence[Mesh]) -> float:
    """Return the estimated processor time [s] of the phases that shoot, 0 without any."""
    meshes = (mesh,) * len(problem.phases) if isinstance(mesh, Mesh) else tuple(mesh)
    total = 0.0
    for phase, own in zip(problem.phases, meshes, strict=True):
        scheme = own.schemes[0]
        if phase.robot is None or not isinstance(scheme, Shooting):
            continue
        substeps = scheme.integrator.substeps if isinstance(scheme.integrator, RungeKutta4) else 1
        nu, nx = phase.robot.nu, 2 * phase.robot.nv
        variables = own.count * nu if isinstance(scheme, SingleShooting) else nx + nu
        total += own.count * variables * substeps * STAGES * OPERATIONS * phase.robot.nv
    return SECONDS * ITERATIONS * total


def warn_of_long_shooting(problem: Problem, mesh: Mesh | Sequence[Mesh]) -> None:
    """Warn of shooting that would take over a minute, and name what takes less.

    Warns
    -----
    UserWarning
    """
    seconds = shooting_seconds(problem, mesh)
    if seconds > LONG:
        warnings.warn(
            f"Shooting on this mesh takes about {seconds:.0f} s of processor time, {seconds / LONG:.0f} minutes: use "
            "collocation, such as mesh=rt.Mesh(20) or no mesh, or rt.schemes.MultipleShooting() on fewer intervals; "
            "time_limit= ends it.",
            stacklevel=3,
        )
