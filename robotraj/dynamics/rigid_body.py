"""A robot as a DAE: by inverse dynamics (RNEA, the default) or by forward dynamics (ABA).

Both forms carry the same physics, M(q) a + h(q, v) = B tau - d(v), with d the joint damping and smoothed Coulomb
friction of the URDF. The inverse form makes the accelerations algebraic variables, so that the rates (v, a) are
linear and RNEA is the only nonlinear block of a point (3.5 times fewer operations than ABA for a ur5).
Source: Featherstone, Rigid Body Dynamics Algorithms (2008), chapters 5 and 7.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.variable import Named, Variable

if TYPE_CHECKING:
    from robotraj.design import Design
    from robotraj.robot import Robot

RATE_UNITS = {"rad": ("rad/s", "rad/s^2", "N m"), "m": ("m/s", "m/s^2", "N")}


@dataclass(frozen=True)
class RigidBody:
    """What both forms share: states (q, v), controls tau of the actuated joints.

    Attributes
    ----------
    robot : Robot
    design : Design or None
        Which parameters are numbers of the robot.
    """

    robot: Robot
    design: Design | None = None

    @cached_property
    def states(self) -> tuple[Variable, ...]:
        """Positions, then velocities: ``q.<joint>``, ``v.<joint>``."""
        positions = self._joints("q", "position", lambda unit: unit)
        return positions + self._joints("v", "velocity", lambda unit: RATE_UNITS[unit][0])

    @cached_property
    def controls(self) -> tuple[Variable, ...]:
        """Torques of the actuated joints: ``tau.<joint>``."""
        every = self._joints("tau", "effort", lambda unit: RATE_UNITS[unit][2])
        return tuple(variable for variable in every if variable.joint in self.robot.actuated)

    def _joints(self, prefix: str, quantity: str, unit_of: Any) -> tuple[Variable, ...]:
        pairs = zip(self.robot.joint_names, self.robot.units, strict=True)
        return tuple(Variable(f"{prefix}.{joint}", unit_of(unit), quantity, joint) for joint, unit in pairs)

    @cached_property
    def _names(self) -> dict[str, list[str]]:
        return {
            "state": [s.name for s in self.states],
            "algebraic variable": [s.name for s in self._accelerations],
            "control": [s.name for s in self.controls],
        }

    @cached_property
    def _accelerations(self) -> tuple[Variable, ...]:
        return self._joints("a", "acceleration", lambda unit: RATE_UNITS[unit][1])

    def _numbers(self, p: ca.SX, names: Sequence[str]) -> tuple[Any, Any]:
        """Pinocchio's algorithms and the damping, with the parameters of the design put in."""
        if self.design is None:
            return self.robot.symbolic, self.robot.damping
        bodies = self.design.bodies(Named("parameter", names, p))
        return self.design.model(bodies), bodies.damping

    def _applied(self, v: ca.SX, tau: ca.SX, damping: Any) -> ca.SX:
        """Generalised force B tau - d(v) of the motors, the damping and the friction, (nv,)."""
        robot = self.robot
        force = ca.mtimes(ca.DM(robot.actuation), tau)
        force -= damping * v
        # Frictionless joints keep no tanh in the graph.
        rough = np.flatnonzero(robot.friction).tolist()
        for i in rough:
            force[i] -= robot.friction[i] * ca.tanh(v[i] / robot.friction_speed)
        return force

    def _point(
        self,
        t: ca.SX,
        x: ca.SX,
        a: Any,
        u: ca.SX | None,
        p: ca.SX,
        names: Sequence[str],
        symbolic: Any,
        damping: Any,
    ) -> RobotPoint:
        nv = self.robot.nv
        kinds = self._names
        return RobotPoint(
            t,
            Named("state", kinds["state"], x),
            Named("algebraic variable", kinds["algebraic variable"] if a is not None else [], a),
            Named("control", kinds["control"] if u is not None else [], u),
            Named("parameter", names, p),
            self.robot,
            x[:nv],
            x[nv:],
            a,
            u,
            symbolic,
            damping,
        )

    def rates(self, point: RobotPoint) -> ca.SX:
        """State rates (v, a), 2 nv."""
        return ca.vertcat(point.v, point.a)


@dataclass(frozen=True)
class InverseRigidBody(RigidBody):
    """x = (q, v), z = a, u = tau; g = RNEA(q, v, a) - (B tau - d(v))."""

    @property
    def algebraic(self) -> tuple[Variable, ...]:
        """Accelerations ``a.<joint>``."""
        return self._accelerations

    @cached_property
    def residuals(self) -> tuple[Variable, ...]:
        """One torque balance per joint."""
        return self._joints("dynamics", "torque balance", lambda unit: RATE_UNITS[unit][2])

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> RobotPoint:
        """Wrap columns of symbols as a RobotPoint."""
        return self._point(t, x, z, u, p, names, *self._numbers(p, names))

    def residual(self, point: RobotPoint) -> ca.SX:
        """Torque balance RNEA(q, v, a) - B tau + d(v), (nv,) [N m, N]."""
        no_force = ca.SX(6, self.robot.model.njoints)
        torque = point.symbolic.inverse_dynamics(point.q, point.v, point.a, no_force)
        return torque - self._applied(point.v, point.tau, point.damping)


@dataclass(frozen=True)
class ForwardRigidBody(RigidBody):
    """x = (q, v), u = tau; f = (v, ABA(q, v, B tau - d(v)))."""

    algebraic: tuple[Variable, ...] = ()
    residuals: tuple[Variable, ...] = ()

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> RobotPoint:
        """Wrap columns of symbols as a RobotPoint whose acceleration is ABA's."""
        robot = self.robot
        a = None
        symbolic, damping = self._numbers(p, names)
        if u is not None:
            no_force = ca.SX(6, robot.model.njoints)
            v = x[robot.nv :]
            a = symbolic.forward_dynamics(x[: robot.nv], v, self._applied(v, u, damping), no_force)
        return self._point(t, x, a, u, p, names, symbolic, damping)

    def residual(self, point: RobotPoint) -> ca.SX:
        """No algebraic rows."""
        return ca.SX(0, 1)


@dataclass(frozen=True)
class InverseDynamics:
    """Choose RNEA with the accelerations as unknowns: fewer operations, the default."""

    def of(self, robot: Robot, design: Design | None = None) -> InverseRigidBody:
        """Bind to a robot."""
        return InverseRigidBody(robot, design)


@dataclass(frozen=True)
class ForwardDynamics:
    """Choose ABA: no algebraic unknowns, a denser and larger derivative."""

    def of(self, robot: Robot, design: Design | None = None) -> ForwardRigidBody:
        """Bind to a robot."""
        return ForwardRigidBody(robot, design)
