"""A robot as a DAE: by inverse dynamics (RNEA, the default) or by forward dynamics (ABA).

Both forms represent one equation of motion, M(q) a + h(q, v) = B tau - d(v) + J(q)' f. d is the damping and friction of
the joints (``motors_and_friction``). f are the forces of the contacts. The inverse form makes the accelerations and the
contact forces algebraic variables. The rates (v, a) are then linear, and RNEA is the only nonlinear block of a point.
Contacts add their accelerations to the rows of g, and their positions and velocities to the invariants.
Source: Featherstone, Rigid Body Dynamics Algorithms (2008), chapters 5, 7 and 8.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contact_expressions import contact_terms_of, correct, hold, pinned
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.dae import TimeOrders
from robotraj.dynamics.motors_and_friction import dry_friction, joint_forces
from robotraj.dynamics.point import RobotPoint, symbolic_model
from robotraj.dynamics.variable import Column, Named, Variable

if TYPE_CHECKING:
    from robotraj.dynamics.design.binding import Design
    from robotraj.dynamics.design.model import DesignedModel
    from robotraj.robot.robot import Robot
    from robotraj.symbolic import SymbolicModel

LONGEST_STRETCH = 0.5
"""Bound on the change of a quaternion's length in one correction; a change of sign needs 2."""

RATE_UNITS = {"rad": ("rad/s", "rad/s^2", "N m"), "m": ("m/s", "m/s^2", "N")}


@dataclass(frozen=True)
class RigidBody(OneLine):
    """Base class of all forms: states (q, v), controls tau of the actuated joints.

    Attributes
    ----------
    robot : Robot
    design : Design or None
        Physical quantities of the robot that are parameters.
    contacts : tuple of BoundContact
        Contacts that hold throughout the phase.
    softening : float
        0 for the robot's own friction; see ``motors_and_friction``.
    averaging : float
        Half the time over which the inverse form averages soft friction [s].
    """

    robot: Robot
    design: Design | None = None
    contacts: tuple[BoundContact, ...] = ()
    softening: float = 0.0
    averaging: float = 0.0

    @cached_property
    def states(self) -> tuple[Variable, ...]:
        """Positions, then velocities: ``q.<position>``, ``v.<velocity>``."""
        places = zip(self.robot.position_names, self.robot.position_units, strict=True)
        positions = tuple(Variable(f"q.{name}", unit, "position", name) for name, unit in places)
        return positions + self._joints("v", "velocity", lambda unit: RATE_UNITS[unit][0])

    @cached_property
    def controls(self) -> tuple[Variable, ...]:
        """Torques of the actuated joints: ``tau.<joint>``."""
        every = self._joints("tau", "effort", lambda unit: RATE_UNITS[unit][2])
        return tuple(variable for variable in every if variable.joint in self.robot.actuated)

    @cached_property
    def invariants(self) -> tuple[Variable, ...]:
        """The free-flyer's unit quaternion, then places, then velocities of the contacts."""
        quaternion = [Variable("unit quaternion", "", "unit quaternion", "root")] if self._has_quaternion else []
        places = [row for contact in self.contacts for row in contact.holds]
        rates = [
            Variable(f"rate.{row.name}", f"{row.unit}/s" if row.unit else "1/s", "contact velocity", row.joint)
            for row in places
        ]
        return (*quaternion, *places, *rates)

    @property
    def time_orders(self) -> TimeOrders | None:
        """Time order of each variable; None where motions cannot be rescaled in time."""
        return None

    @property
    def position_count(self) -> int:
        """How many states are positions; they come first."""
        return self.robot.nq

    @property
    def _has_quaternion(self) -> bool:
        return self.robot.root == "floating"

    def _joints(self, prefix: str, quantity: str, unit_of: Callable[[str], str]) -> tuple[Variable, ...]:
        pairs = zip(self.robot.velocity_names, self.robot.units, strict=True)
        return tuple(Variable(f"{prefix}.{joint}", unit_of(unit), quantity, joint) for joint, unit in pairs)

    @cached_property
    def _names(self) -> dict[str, list[str]]:
        return {
            "state": [s.name for s in self.states],
            "algebraic variable": [s.name for s in (*self._accelerations, *self._forces)],
            "control": [s.name for s in self.controls],
        }

    @cached_property
    def _accelerations(self) -> tuple[Variable, ...]:
        return self._joints("a", "acceleration", lambda unit: RATE_UNITS[unit][1])

    @cached_property
    def _forces(self) -> tuple[Variable, ...]:
        return tuple(force for contact in self.contacts for force in contact.forces)

    def _numbers(self, p: ca.SX, names: Sequence[str]) -> tuple[SymbolicModel | DesignedModel, Column]:
        """Pinocchio's algorithms and the damping, with the parameters of the design."""
        if self.design is None:
            return symbolic_model(self.robot), self.robot.damping
        bodies = self.design.bodies(Named("parameter", names, p))
        return self.design.model(bodies), bodies.damping

    def _point(
        self,
        t: ca.SX,
        x: ca.SX,
        a: ca.SX,
        forces: ca.SX,
        u: ca.SX | None,
        p: ca.SX,
        names: Sequence[str],
        symbolic: SymbolicModel | DesignedModel,
        damping: Column,
    ) -> RobotPoint:
        nq = self.robot.nq
        kinds = self._names
        z = None if a is None else ca.vertcat(a, forces)
        point = RobotPoint(
            t,
            Named("state", kinds["state"], x),
            Named("algebraic variable", kinds["algebraic variable"] if a is not None else [], z),
            Named("control", kinds["control"] if u is not None else [], u),
            Named("parameter", names, p),
            self.robot,
            x[:nq],
            x[nq:],
            a,
            u,
            symbolic,
            damping,
        )
        if a is not None and self.contacts:
            ends = np.cumsum([len(contact.forces) for contact in self.contacts])[:-1].tolist()
            parts = ca.vertsplit(forces, [0, *ends, forces.numel()])
            vectors = [c.vector(ca.vertsplit(part)) for c, part in zip(self.contacts, parts, strict=True)]
            point.forces = Named("contact", [c.name for c in self.contacts], vectors)
        return point

    def rates(self, point: RobotPoint) -> ca.SX:
        """State rates (qdot, a), nq + nv: qdot = v, and half the product of a quaternion with (omega, 0)."""
        moved = symbolic_model(self.robot).configuration_rate(point.q, point.v) if self._has_quaternion else point.v
        return ca.vertcat(moved, point.a)

    def invariant(self, point: RobotPoint) -> ca.SX:
        """|quaternion|^2 - 1, then the contacts' places and velocities."""
        quaternion = [ca.sumsqr(point.q[3:7]) - 1.0] if self._has_quaternion else []
        return ca.vertcat(ca.SX(0, 1), *quaternion, *hold(self.contacts, point))

    def correction(self, point: RobotPoint, c: ca.SX) -> ca.SX:
        """Return W c: along the quaternion, and along the directions of ``contact_expressions.correct`` for contacts.

        The quaternion changes by s(c) times itself, s(c) = c / sqrt(1 + (c / L)^2), with L = ``LONGEST_STRETCH``. Since
        |s| < L < 1, no correction changes a quaternion's sign, which would count as a full turn.
        """
        first = int(self._has_quaternion)
        if point.contact_terms and not pinned(self.robot, self.contacts):
            corrected = sum((each.corrected for each in point.contact_terms.values()), ca.SX.zeros(len(self.states)))
        else:
            count = (c.numel() - first) // 2
            places, rates = c[first : first + count], c[first + count :]
            corrected = self.along(point, *(correct(self.contacts, point, part) for part in (places, rates)))
        if self._has_quaternion:
            corrected[3:7] += point.q[3:7] * c[0] / ca.sqrt(1.0 + (c[0] / LONGEST_STRETCH) ** 2)
        return corrected

    def dry_friction(self, point: RobotPoint) -> ca.SX:
        """Evaluate the dry friction of the joints, (nv,) [N m, N]."""
        return dry_friction(self.robot, point.v, self.softening, self._change(point))

    def _change(self, point: RobotPoint) -> ca.SX | None:
        """Return the change of the speeds within the time over which soft friction is averaged; None without it."""
        return self.averaging * point.a if self.averaging else None

    def along(self, point: RobotPoint, moved: ca.SX, sped: ca.SX) -> ca.SX:
        """Rates (nq + nv,) of a state whose q changes along one tangent vector (nv,) and whose v along another."""
        if self._has_quaternion:
            moved = symbolic_model(self.robot).configuration_rate(point.q, moved)
        return ca.vertcat(moved, sped)


@dataclass(frozen=True)
class InverseRigidBody(RigidBody):
    """x = (q, v), z = (a, f), u = tau; g = (RNEA(q, v, a) - (B tau - d(v) + J' f), accelerations of the contacts)."""

    @cached_property
    def algebraic(self) -> tuple[Variable, ...]:
        """Accelerations ``a.<velocity>``, then contact forces ``force.<contact>.<axis>``."""
        return self._accelerations + self._forces

    @property
    def time_orders(self) -> TimeOrders | None:
        """0 for positions, 1 for velocities, 2 for accelerations; None with invariants or where nq != nv."""
        n, states = self.robot.nv, self.states
        if self.invariants or len(states) != 2 * n:
            return None
        return TimeOrders((0,) * n + (1,) * n, (2,) * n + (0,) * len(self._forces), (0,) * len(self.controls))

    @cached_property
    def residuals(self) -> tuple[Variable, ...]:
        """One torque balance per velocity, then one acceleration per held row."""
        balances = self._joints("dynamics", "torque balance", lambda unit: RATE_UNITS[unit][2])
        held = tuple(
            Variable(
                f"acceleration.{row.name}",
                f"{row.unit}/s^2" if row.unit else "1/s^2",
                "contact acceleration",
                row.joint,
            )
            for contact in self.contacts
            for row in contact.holds
        )
        return balances + held

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> RobotPoint:
        """Wrap columns of symbols as a RobotPoint."""
        nv = self.robot.nv
        a, forces = (None, None) if z is None else (z[:nv, 0], z[nv:, 0])
        return self._point(t, x, a, forces, u, p, names, *self._numbers(p, names))

    def residual(self, point: RobotPoint) -> ca.SX:
        """Torque balance RNEA(q, v, a) - B tau + d(v) - J' f, (nv,) [N m, N], then contact accelerations."""
        forces = joint_forces(
            self.robot, point.q, point.v, point.tau, point.damping, self.softening, self._change(point)
        )
        balance = point.inverse_dynamics - forces
        terms = [contact_terms_of(contact, point) for contact in self.contacts]
        for each in terms:
            balance += each.reaction
        return ca.vertcat(balance, *(row for each in terms for row in each.accelerations))


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
            v = x[robot.nq :]
            force = joint_forces(robot, x[: robot.nq], v, u, damping, self.softening)
            a = symbolic.forward_dynamics(x[: robot.nq], v, force, no_force)
        return self._point(t, x, a, ca.SX(0, 1), u, p, names, symbolic, damping)

    def residual(self, point: RobotPoint) -> ca.SX:
        """No algebraic rows."""
        return ca.SX(0, 1)
