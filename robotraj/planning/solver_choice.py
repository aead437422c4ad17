"""Which solver plans a problem, and what evaluates its point functions, where the user does not say.

Measured by benchmarks/solvers.py, each from the same guess: on robots with a fixed root, with all motors or without
some, by rates of torques and jerks too, and on systems with a control for every second state, fatrop finds the optima
that IPOPT finds, in half the time and less. On systems with fewer controls, which have many optima, the two may find
different ones, and with contacts fatrop stalls more often. There IPOPT is the robust choice; for many optima there is
``rt.multistart``, with fatrop.

Engines give the same numbers to rounding, but plans with many optima can take another turn for less. Robots with a
free-flyer, legs above all, have the largest graphs, and the compiled module takes two thirds off a solve's evaluation
time and more; smaller ones stay with CasADi's virtual machine, with which their examples and cases were settled.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.dynamics.system import SystemDynamics
from robotraj.native.engines.base import Engine
from robotraj.native.engines.native import Native
from robotraj.problem.augmentation import Augmented
from robotraj.problem.constraints.integral import IntegralConstraint
from robotraj.solvers.base import Solver
from robotraj.solvers.fatrop import Fatrop
from robotraj.solvers.ipopt import Ipopt
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.schemes.onestep import OneStep

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.problem.problem import Problem


def solver_for(problem: Problem, mesh: Mesh | Sequence[Mesh]) -> Solver:
    """Give ``Fatrop()`` for collocated fixed-root robots and systems with many controls, ``Ipopt()`` for all else."""
    meshes = [mesh] if isinstance(mesh, Mesh) else list(mesh)
    plain = not any(isinstance(m, MovingMesh) or isinstance(s, OneStep) for m in meshes for s in m.given)
    return Fatrop() if plain and all(_suits_fatrop(phase) for phase in problem.phases) else Ipopt()


def engine_for(problem: Problem, solver: Solver) -> Engine:
    """Give ``Native()`` for robots with a free-flyer, and what the solver has by itself for all else."""
    flies = all(phase.robot is not None and phase.robot.root == "floating" for phase in problem.phases)
    return Native() if flies else solver.default_engine()


def _suits_fatrop(phase: Phase) -> bool:
    body, dae = phase.body, phase.dae
    # Some costs with variables of their own, absolute power above all, have corners and many optima.
    while isinstance(dae, Augmented) and dae.smooth:
        dae = dae.inner
    if dae is not body or body.invariants:
        return False
    # An integral reads the unknowns of every point, which all stages then carry: fatrop's time grows with the third
    # power of the number of intervals.
    if any(isinstance(c, IntegralConstraint) for c in phase.constraints):
        return False
    if isinstance(body, InverseRigidBody):
        return body.robot.root == "fixed" and body.design is None and body.robot.nv == body.robot.nq
    # A parameter, too, is carried through all stages and widens them.
    narrow = not phase.parameter_names
    return isinstance(body, SystemDynamics) and narrow and 2 * len(body.controls) >= len(body.states)
