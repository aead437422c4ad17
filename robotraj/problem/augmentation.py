"""Dynamics with the variables that an objective adds: rates, slacks, jerks, running integrals.

An objective may need further quantities: the time derivative of a torque, a slack for an absolute value.
It then wraps the dynamics of the phase in a larger DAE of the same physics, which schemes and transcription
treat as any other:

    ControlRates        u becomes a state, its rate the control:   udot = r
    Slacks              further controls s, bounded by rows of the objective
    Jerks               further algebraic variables j = da/dt of a robot
    RunningIntegral     a further state W from W = 0:   Wdot = l(x, z, u, p, t)

Points of a wrapped phase keep their attributes, such as ``point.u`` and ``point.tau``. Added variables are in
``point.extra``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from typing import Any, ClassVar

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics, TimeOrders
from robotraj.dynamics.point import Point
from robotraj.dynamics.rigid_body import InverseDynamics, RigidBody
from robotraj.dynamics.variable import Variable
from robotraj.problem.scalars import Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class Augmented(OneLine, ABC):
    """Dynamics around other dynamics; new variables come after the inner ones.

    Attributes
    ----------
    smooth : bool
        Whether costs on the added variables are smooth, so that the structure of the optima does not change.
    """

    inner: Dynamics
    smooth: ClassVar[bool] = False

    @property
    def states(self) -> tuple[Variable, ...]:
        """The inner states."""
        return self.inner.states

    @property
    def algebraic(self) -> tuple[Variable, ...]:
        """The inner algebraic variables."""
        return self.inner.algebraic

    @property
    def controls(self) -> tuple[Variable, ...]:
        """The inner controls."""
        return self.inner.controls

    @property
    def residuals(self) -> tuple[Variable, ...]:
        """The inner rows."""
        return self.inner.residuals

    @property
    def invariants(self) -> tuple[Variable, ...]:
        """The inner invariants."""
        return self.inner.invariants

    @property
    def time_orders(self) -> TimeOrders | None:
        """How often each variable is divided by time; None where that is not known."""
        return None

    @property
    def _inner_orders(self) -> TimeOrders | None:
        inner = self.inner
        return inner.time_orders if isinstance(inner, Augmented | RigidBody) else None

    @property
    def start(self) -> Mapping[str, float]:
        """Values of added states that are fixed at the start of the phase."""
        return self.inner.start if isinstance(self.inner, Augmented) else {}

    @abstractmethod
    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Return the inner Point of columns of symbols, with added variables in ``point.extra``."""

    def rates(self, point: Any) -> ca.SX:
        """Rates of the inner states."""
        return self.inner.rates(point)

    def residual(self, point: Any) -> ca.SX:
        """Evaluate the inner rows."""
        return self.inner.residual(point)

    def invariant(self, point: Any) -> ca.SX:
        """Evaluate the inner invariants."""
        return self.inner.invariant(point)

    def correction(self, point: Any, c: ca.SX) -> ca.SX:
        """Correct the inner states; added states keep their rates."""
        inner = self.inner.correction(point, c)
        return ca.vertcat(inner, ca.SX.zeros(len(self.states) - inner.numel()))


def body_of(dynamics: Dynamics) -> Dynamics:
    """Return the dynamics without anything that objectives added."""
    while isinstance(dynamics, Augmented):
        dynamics = dynamics.inner
    return dynamics


def has(dynamics: Dynamics, names: Sequence[str]) -> bool:
    """Whether another term of the objective added variables of these names already."""
    known = {v.name for v in (*dynamics.states, *dynamics.algebraic, *dynamics.controls)}
    return set(names) <= known


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
        """Count one division by time more for a rate than for its variable."""
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

    def rates(self, point: Any) -> ca.SX:
        """Inner rates, then r."""
        return ca.vertcat(self.inner.rates(point), *(point.extra[v.name] for v in self.controls[: len(self._moved)]))


@dataclass(frozen=True)
class Slacks(Augmented):
    """Further controls, free until rows of the objective bound them."""

    slacks: tuple[Variable, ...]

    @property
    def controls(self) -> tuple[Variable, ...]:
        """Inner controls, then the slacks."""
        return self.inner.controls + self.slacks

    @property
    def time_orders(self) -> TimeOrders | None:
        """Count no division by time for slacks; their rows define them."""
        known = self._inner_orders
        return known and known._replace(controls=known.controls + (0,) * len(self.slacks))

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Put the slacks into ``point.extra``."""
        nu = len(self.inner.controls)
        point = self.inner.point(t, x, z, None if u is None else u[:nu, :], p, names)
        if u is not None:
            point.extra |= {v.name: u[nu + i] for i, v in enumerate(self.slacks)}
        return point


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
        robot = _robot(self.inner)
        pairs = zip(robot.velocity_names, robot.units, strict=True)
        return tuple(Variable(f"jerk.{joint}", f"{unit}/s^3", "jerk", joint) for joint, unit in pairs)

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
        body = InverseDynamics().of(robot, inner.design if isinstance(inner, RigidBody) else None)
        q = ca.SX.sym("q", robot.nq)
        v, a, j = (ca.SX.sym(name, robot.nv) for name in "vaj")
        tau, rate = ca.SX.sym("tau", robot.nu), ca.SX.sym("rate", robot.nu)
        p = ca.SX.sym("p", len(names))
        point = body.point(ca.SX(0), ca.vertcat(q, v), a, tau, p, names)
        moved = v if robot.nq == robot.nv else robot.symbolic.configuration_rate(q, v)
        along = ca.jtimes(body.residual(point), ca.vertcat(q, v, a, tau), ca.vertcat(moved, a, j, rate))
        return ca.Function("balance_rate", [q, v, a, tau, j, rate, p], [along])

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Put the jerks into ``point.extra``."""
        nz = len(self.inner.algebraic)
        point = self.inner.point(t, x, None if z is None else z[:nz, :], u, p, names)
        if z is not None:
            point.extra |= {v.name: z[nz + i] for i, v in enumerate(self.jerks)}
        return point

    def residual(self, point: Any) -> ca.SX:
        """Inner rows, then the rates of the torque balances."""
        robot = _robot(self.inner)
        jerk = ca.vertcat(*(point.extra[v.name] for v in self.jerks))
        rate = ca.vertcat(*(point.extra[f"rate.tau.{joint}"] for joint in robot.actuated))
        p = ca.vertcat(ca.SX(0, 1), *point.p.values())
        row = self._balance_rate(list(point.p))(point.q, point.v, point.a, point.tau, jerk, rate, p)
        return ca.vertcat(self.inner.residual(point), row)


@dataclass(frozen=True)
class RunningIntegral(Augmented):
    """A further state that integrates a rate from 0 at the start of the phase."""

    integral: Variable
    rate: Callable[[Any], Scalar] = field(repr=False)

    @property
    def states(self) -> tuple[Variable, ...]:
        """Inner states, then the integral."""
        return (*self.inner.states, self.integral)

    @property
    def start(self) -> Mapping[str, float]:
        """The integral starts at 0."""
        return {**super().start, self.integral.name: 0.0}

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Put the integral into ``point.extra``, at the ends of the phase as well."""
        nx = len(self.inner.states)
        point = self.inner.point(t, x[:nx, :], z, u, p, names)
        point.extra |= {self.integral.name: x[nx]}
        return point

    def rates(self, point: Any) -> ca.SX:
        """Inner rates, then the integrand."""
        return ca.vertcat(self.inner.rates(point), self.rate(point))


def _robot(dynamics: Dynamics) -> Robot:
    body = body_of(dynamics)
    if not isinstance(body, RigidBody):
        raise InputError(
            "Jerk() needs a robot, but the phase moves a System; integrate a rate of yours with rt.Lagrange."
        )
    return body.robot
