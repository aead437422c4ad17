"""Torques of a motion against dry friction of full size, as Coulomb's law has it.

Equations of motion smooth the friction of a joint, F tanh(v / v_s). Below v_s a motion then needs less torque than
Coulomb's F sign(v), and a least time was up to some percent below any that its motors allow. Limits of torques between
the points are therefore imposed on

    tau + F (tanh(v / v_0) - tanh(v / v_s)),    v_0 = ``STILL`` v_s,

and on tau itself, which is the larger one where friction helps to stop. A joint below v_0 rests. Its friction takes any
value between -F and F, and its limits are those of the smooth law.

The smooth law is kept where an integral is minimised: joints that stick to save effort creep slowly in such plans.
"""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.problem.objectives.base import Integral
from robotraj.problem.phase import Phase
from robotraj.transcription.driven_motion import DrivenInputs
from robotraj.transcription.extract import PhaseTrajectory

STILL = 1e-3
"""Speed below which a joint rests, relative to the speed of the smooth friction."""


@dataclass(frozen=True, eq=False)
class FullFriction(OneLine):
    """Inputs along an exact motion whose torques overcome dry friction of full size."""

    inputs: DrivenInputs

    @property
    def trajectory(self) -> PhaseTrajectory:
        """The trajectory of the phase."""
        return self.inputs.trajectory

    def at(self, t: Array, interval: int | Indices | None = None) -> tuple[Array, Array]:
        """Evaluate at times."""
        z, u = self.inputs.at(t, interval)
        return z, self._with_friction(self.trajectory.x(t, interval), u)

    def inside(self, tau: Array) -> tuple[Array, Array]:
        """Evaluate every interval at the same places."""
        z, u = self.inputs.inside(tau)
        return z, self._with_friction(self.trajectory.x.inside(tau), u)

    def _with_friction(self, x: Array, u: Array) -> Array:
        """Add what the smooth law lacks to the torques, which are the first columns of u."""
        robot = self.inputs.phase.robot
        assert robot is not None
        joints = [robot.velocity_names.index(joint) for joint in robot.actuated]
        speeds = x[..., robot.nq : robot.nq + robot.nv][..., joints] / robot.friction_speed
        u = np.array(u)
        u[..., : len(joints)] += robot.friction[joints] * (np.tanh(speeds / STILL) - np.tanh(speeds))
        return u


def has_full_friction(phase: Phase) -> bool:
    """Whether limits of torques are imposed against full friction: an arm with dry friction minimises no integral."""
    body, robot, objective = phase.body, phase.robot, phase.objective
    if robot is None or not isinstance(body, InverseRigidBody) or body.softening or body.contacts:
        return False
    integrates = objective is not None and any(isinstance(term, Integral) for _, term in objective.terms)
    driven = robot.root == "fixed" and robot.nu == robot.nv and phase.path is None
    return driven and not integrates and bool(np.any(robot.friction))


def by_law_of_friction(inputs: DrivenInputs) -> tuple[DrivenInputs | FullFriction, ...]:
    """Return the inputs of an exact motion by the smooth law and, where its limits hold too, against full friction."""
    return (inputs, FullFriction(inputs)) if has_full_friction(inputs.phase) else (inputs,)
