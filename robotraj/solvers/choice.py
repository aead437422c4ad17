"""Which solver plans a problem, and what evaluates its point functions, where the user does not say.

Measured on the cases of tests/ and benchmarks/: on robots whose every joint has a motor, arms above all, fatrop finds
the optima that IPOPT finds, tens of times faster. Where motors are missing there are many optima, and from the same
guess the two may find different ones; with contacts the stages are large. There IPOPT is the robust choice.

Engines give the same numbers to rounding, but plans with many optima can take another turn for less. Robots with a
free-flyer, legs above all, have the largest graphs, and the compiled module takes two thirds off a solve's evaluation
time and more; smaller ones stay with CasADi's virtual machine, with which their examples and cases were settled.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.engines import Engine, Native
from robotraj.schemes import Mesh, MovingMesh, OneStep
from robotraj.solvers.base import Solver
from robotraj.solvers.fatrop import Fatrop
from robotraj.solvers.ipopt import Ipopt

if TYPE_CHECKING:
    from robotraj.problem import Phase, Problem


def solver_for(problem: Problem, mesh: Mesh | Sequence[Mesh]) -> Solver:
    """Give ``Fatrop()`` for collocation of fully actuated robots on fixed roots, ``Ipopt()`` for all else."""
    meshes = [mesh] if isinstance(mesh, Mesh) else list(mesh)
    plain = not any(isinstance(m, MovingMesh) or isinstance(s, OneStep) for m in meshes for s in m.given)
    return Fatrop() if plain and all(_has_all_motors(phase) for phase in problem.phases) else Ipopt()


def engine_for(problem: Problem, solver: Solver) -> Engine:
    """Give ``Native()`` for robots with a free-flyer, and what the solver has by itself for all else."""
    flies = all(phase.robot is not None and phase.robot.root == "floating" for phase in problem.phases)
    return Native() if flies else solver.default_engine()


def _has_all_motors(phase: Phase) -> bool:
    body = phase.body
    return (
        isinstance(body, InverseRigidBody)
        and body.robot.root == "fixed"
        and len(body.controls) == body.robot.nv == body.robot.nq
        and not body.invariants
        # Costs with variables of their own, such as absolute power, have corners and many optima.
        and phase.dae is body
        and body.design is None
    )
