"""Rates as variables: controls or accelerations become states, and their rates controls or algebraic variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics, TimeOrders
from robotraj.dynamics.path_body import ACCELERATION as PATH_ACCELERATION
from robotraj.dynamics.path_body import PathBody, PathPoint
from robotraj.dynamics.point import AnyPoint, Point, symbolic_model
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.dynamics.rigid_body_forms import InverseDynamics
from robotraj.dynamics.variable import Variable
from robotraj.problem.augmentation import Augmented, body_of, has
from robotraj.robot.robot import Robot

ACCELERATION = "acceleration."
"""Prefix of the states that are accelerations."""


def with_control_rates(dynamics: Dynamics) -> Dynamics:
    """Make the controls states, unless they are states already."""
    body = body_of(dynamics)
    if has(dynamics, [f"rate.{c.name}" for c in body.controls]):
        return dynamics
    return PathRates(dynamics) if isinstance(body, PathBody) else ControlRates(dynamics)


def with_jerks(dynamics: Dynamics) -> Dynamics:
    """Add the jerks of a robot, unless they exist already; where joints have no motor, its torques become states."""
    robot = _robot(dynamics)
    if isinstance(body_of(dynamics), PathBody):
        return with_control_rates(dynamics)
    if has(dynamics, [f"jerk.{joint}" for joint in robot.velocity_names]):
        return dynamics
    if robot.root == "fixed" and robot.nq == robot.nv == robot.nu and not body_of(dynamics).invariants:
        return Accelerations(dynamics)
    return Jerks(with_control_rates(dynamics))


@dataclass(frozen=True)
class ControlRates(Augmented):
    """The body's controls become states and their rates r the controls, udot = r."""

    smooth: ClassVar[bool] = True

    @cached_property
    def _moved(self) -> tuple[Variable, ...]:
        return body_of(self.inner).controls

    @property
    def states(self) -> tuple[Variable, ...]:
        """Inner states, then the body's controls."""
        return (*self.inner.states, *self._moved)

    @cached_property
    def controls(self) -> tuple[Variable, ...]:
        """Rates ``rate.<control>``, then further inner controls."""
        rates = tuple(
            Variable(f"rate.{c.name}", f"{c.unit}/s" if c.unit else "", f"{c.quantity} rate", c.joint)
            for c in self._moved
        )
        return rates + self.inner.controls[len(rates) :]

    @property
    def time_orders(self) -> TimeOrders | None:
        """One more for a rate than for its variable."""
        known = self._inner_orders
        if known is None:
            return None
        moved, others = known.controls[: len(self._moved)], known.controls[len(self._moved) :]
        return TimeOrders(known.states + moved, known.algebraic, tuple(k + 1 for k in moved) + others)

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Return the states that were controls as controls."""
        nx, nu = len(self.inner.states), len(self._moved)
        inner = None if u is None else ca.vertcat(x[nx:, :], u[nu:, :])
        point = self.inner.point(t, x[:nx, :], z, inner, p, names)
        if u is not None:
            point.extra |= {v.name: u[i] for i, v in enumerate(self.controls[:nu])}
        return point

    def rates(self, point: AnyPoint) -> ca.SX:
        """Inner rates, then r."""
        return ca.vertcat(self.inner.rates(point), *(point.extra[v.name] for v in self.controls[: len(self._moved)]))


@dataclass(frozen=True)
class PathRates(ControlRates):
    """On a path s'' becomes a state and s''' the control, of which jerks and rates of torques are functions.

    s'' is 0 at an end at which s' is: the robot rests there.
    """

    @property
    def start(self) -> Mapping[str, float]:
        """The acceleration that is given, and none at a start at rest."""
        body = body_of(self.inner)
        assert isinstance(body, PathBody)
        given = body.start_acceleration
        own = self._resting(last=False) if given is None else {PATH_ACCELERATION: given}
        return {**super().start, **own}

    @property
    def end(self) -> Mapping[str, float]:
        """No acceleration at an end at rest."""
        return {**super().end, **self._resting(last=True)}

    def _resting(self, last: bool) -> Mapping[str, float]:
        body = body_of(self.inner)
        assert isinstance(body, PathBody)
        speed = body.ends(last)[1][1]
        return {PATH_ACCELERATION: 0.0} if speed == 0.0 else {}

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Put s'', the jerks and the rates of the torques into ``point.extra``."""
        point, body = super().point(t, x, z, u, p, names), body_of(self.inner)
        point.extra[PATH_ACCELERATION] = x[len(self.inner.states)]
        if u is not None:
            assert isinstance(body, PathBody) and isinstance(point, PathPoint)
            jerks, rates = body.jerk(point, u[0]), body.torque_rate(point, u[0])
            moved = body.robot.velocity_names
            point.extra |= {f"{kind}.{joint}": jerks[i] for i, joint in enumerate(moved) for kind in ("jerk", "rate.a")}
            point.extra |= {f"rate.tau.{joint}": rates[i] for i, joint in enumerate(body.robot.actuated)}
        return point


@dataclass(frozen=True)
class Accelerations(Augmented):
    """Accelerations of a robot with a motor at every joint become states A and its jerks j controls, A' = j, a = A.

    Torques remain controls, so dry friction in them need not be approximated by a polynomial.
    """

    smooth: ClassVar[bool] = True

    @cached_property
    def accelerations(self) -> tuple[Variable, ...]:
        """``acceleration.<joint>``."""
        return tuple(
            Variable(f"{ACCELERATION}{joint}", f"{unit}/s^2", "acceleration", joint) for joint, unit in _joints(self)
        )

    @cached_property
    def jerks(self) -> tuple[Variable, ...]:
        """``jerk.<joint>``."""
        return _jerks(self)

    @property
    def states(self) -> tuple[Variable, ...]:
        """Inner states, then the accelerations."""
        return (*self.inner.states, *self.accelerations)

    @property
    def copies(self) -> Mapping[str, str]:
        """The states A."""
        known = {v.name for v in self.inner.algebraic}
        pairs = {v.name: f"a.{v.joint}" for v in self.accelerations}
        return {**super().copies, **{state: a for state, a in pairs.items() if a in known}}

    @property
    def controls(self) -> tuple[Variable, ...]:
        """Inner controls, then the jerks."""
        return (*self.inner.controls, *self.jerks)

    @cached_property
    def residuals(self) -> tuple[Variable, ...]:
        """Inner rows, then the differences a - A."""
        rows = tuple(Variable(f"continuous.{v.name}", v.unit, v.quantity, v.joint) for v in self.accelerations)
        return (*self.inner.residuals, *rows)

    @property
    def time_orders(self) -> TimeOrders | None:
        """2 for accelerations, 3 for jerks."""
        known, count = self._inner_orders, len(self.jerks)
        return known and TimeOrders(known.states + (2,) * count, known.algebraic, known.controls + (3,) * count)

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Put the states A and the jerks into ``point.extra``."""
        nx, nu = len(self.inner.states), len(self.inner.controls)
        point = self.inner.point(t, x[:nx, :], z, None if u is None else u[:nu, :], p, names)
        point.extra |= {v.name: x[nx + i] for i, v in enumerate(self.accelerations)}
        if u is not None:
            point.extra |= {v.name: u[nu + i] for i, v in enumerate(self.jerks)}
        return point

    def rates(self, point: AnyPoint) -> ca.SX:
        """Inner rates, then j."""
        return ca.vertcat(self.inner.rates(point), *(point.extra[v.name] for v in self.jerks))

    def residual(self, point: AnyPoint) -> ca.SX:
        """Inner rows, then a - A."""
        planned = ca.vertcat(*(point.extra[v.name] for v in self.accelerations))
        return ca.vertcat(self.inner.residual(point), point.a - planned)


@dataclass(frozen=True)
class Jerks(Augmented):
    """Jerks j = da/dt of a robot as algebraic variables, from the time derivative of the torque balance.

    0 = d/dt [RNEA(q, v, a) + d(v) - B tau] along (v, a, j, taudot), linear in j with the mass matrix in
    front.
    """

    smooth: ClassVar[bool] = True

    @cached_property
    def jerks(self) -> tuple[Variable, ...]:
        """``jerk.<joint>``."""
        return _jerks(self)

    @property
    def algebraic(self) -> tuple[Variable, ...]:
        """Inner algebraic variables, then the jerks."""
        return (*self.inner.algebraic, *self.jerks)

    @cached_property
    def residuals(self) -> tuple[Variable, ...]:
        """Inner rows, then the rate of each torque balance."""
        rows = InverseDynamics().of(_robot(self.inner)).residuals
        return (
            *self.inner.residuals,
            *(Variable(f"rate.{r.name}", f"{r.unit}/s", f"{r.quantity} rate", r.joint) for r in rows),
        )

    @property
    def time_orders(self) -> TimeOrders | None:
        """3 for jerks."""
        known = self._inner_orders
        return known and known._replace(algebraic=known.algebraic + (3,) * len(self.jerks))

    def _balance_rate(self, names: Sequence[str]) -> ca.Function:
        robot = _robot(self.inner)
        inner = body_of(self.inner)
        assert isinstance(inner, RigidBody)
        body = InverseDynamics(inner.softening, inner.averaging).of(robot, inner.design)
        q = ca.SX.sym("q", robot.nq)
        v, a, j = (ca.SX.sym(name, robot.nv) for name in "vaj")
        tau, rate = ca.SX.sym("tau", robot.nu), ca.SX.sym("rate", robot.nu)
        p = ca.SX.sym("p", len(names))
        point = body.point(ca.SX(0), ca.vertcat(q, v), a, tau, p, names)
        moved = v if robot.nq == robot.nv else symbolic_model(robot).configuration_rate(q, v)
        along = ca.jtimes(body.residual(point), ca.vertcat(q, v, a, tau), ca.vertcat(moved, a, j, rate))
        return ca.Function("balance_rate", [q, v, a, tau, j, rate, p], [along])

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Put the jerks into ``point.extra``."""
        nz = len(self.inner.algebraic)
        point = self.inner.point(t, x, None if z is None else z[:nz, :], u, p, names)
        if z is not None:
            point.extra |= {v.name: z[nz + i] for i, v in enumerate(self.jerks)}
        return point

    def residual(self, point: AnyPoint) -> ca.SX:
        """Inner rows, then the rates of the torque balances."""
        robot = _robot(self.inner)
        jerk = ca.vertcat(*(point.extra[v.name] for v in self.jerks))
        rate = ca.vertcat(*(point.extra[f"rate.tau.{joint}"] for joint in robot.actuated))
        p = ca.vertcat(ca.SX(0, 1), *point.p.values())
        row = self._balance_rate(list(point.p))(point.q, point.v, point.a, point.tau, jerk, rate, p)
        return ca.vertcat(self.inner.residual(point), row)


def _joints(dynamics: Dynamics) -> list[tuple[str, str]]:
    """Names and units of the velocities."""
    robot = _robot(dynamics)
    return list(zip(robot.velocity_names, robot.units, strict=True))


def _jerks(dynamics: Dynamics) -> tuple[Variable, ...]:
    return tuple(Variable(f"jerk.{joint}", f"{unit}/s^3", "jerk", joint) for joint, unit in _joints(dynamics))


def _robot(dynamics: Dynamics) -> Robot:
    body = body_of(dynamics)
    if not isinstance(body, RigidBody):
        raise InputError(
            "Jerks need a robot, but the phase moves a System; integrate a rate of yours with rt.Lagrange."
        )
    return body.robot
