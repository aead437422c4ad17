"""Dynamics with variables that an objective or a constraint adds: rates, slacks, jerks, running integrals, a path.

An objective or a constraint may need further quantities, such as the time derivative of a torque or a slack for an
absolute value. It then wraps the dynamics of the phase in a larger DAE with the same solutions. Schemes and
transcription treat this DAE as any other:

    ControlRates        u becomes a state, its rate the control:   udot = r
    Slacks              further controls s, bounded by rows of the objective
    Accelerations       further states A = a of a robot, its jerks j the controls:   A' = j
    Jerks               further algebraic variables j = da/dt, where joints have no motor
    FrictionlessTorques further algebraic variables tau - F tanh(v / v_s), torques without dry friction
    RunningIntegral     a further state W from W = 0:   Wdot = l(x, z, u, p, t)
    PathRates           on a path q(s), a further state s'' and the control s''':   ds''/dt = s'''

Points of a wrapped phase keep their attributes, such as ``point.u`` and ``point.tau``. Added variables are in
``point.extra``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from typing import ClassVar

import casadi as ca

from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics, TimeOrders
from robotraj.dynamics.path_body import PathBody
from robotraj.dynamics.point import AnyPoint, Point
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.dynamics.variable import Variable
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.scalars import Scalar

FRICTIONLESS = "effort without dry friction"
"""Quantity of the variables ``frictionless.<joint>``."""


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
        """Time order of each variable; None where motions cannot be rescaled in time."""
        return None

    @property
    def _inner_orders(self) -> TimeOrders | None:
        inner = self.inner
        return inner.time_orders if isinstance(inner, Augmented | RigidBody) else None

    @property
    def start(self) -> Mapping[str, float]:
        """Values of added states that are fixed at the start of the phase."""
        return self.inner.start if isinstance(self.inner, Augmented) else {}

    @property
    def end(self) -> Mapping[str, float]:
        """Values of added states that are fixed at the end of the phase."""
        return self.inner.end if isinstance(self.inner, Augmented) else {}

    @property
    def copies(self) -> Mapping[str, str]:
        """Added states by name, with the algebraic variables that they equal; a guess contains the latter only."""
        return self.inner.copies if isinstance(self.inner, Augmented) else {}

    @abstractmethod
    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Return the inner Point of columns of symbols, with added variables in ``point.extra``."""

    def rates(self, point: AnyPoint) -> ca.SX:
        """Rates of the inner states."""
        return self.inner.rates(point)

    def residual(self, point: AnyPoint) -> ca.SX:
        """Evaluate the inner rows."""
        return self.inner.residual(point)

    def invariant(self, point: AnyPoint) -> ca.SX:
        """Evaluate the inner invariants."""
        return self.inner.invariant(point)

    def correction(self, point: AnyPoint, c: ca.SX) -> ca.SX:
        """Correct the inner states; added states keep their rates."""
        inner = self.inner.correction(point, c)
        return ca.vertcat(inner, ca.SX.zeros(len(self.states) - inner.numel()))


def body_of(dynamics: Dynamics) -> Dynamics:
    """Return the dynamics without the variables that objectives and constraints added."""
    while isinstance(dynamics, Augmented):
        dynamics = dynamics.inner
    return dynamics


def free_of(body: Dynamics) -> Dynamics:
    """Return the dynamics of a robot without its path, whose controls are the torques."""
    return body.free if isinstance(body, PathBody) else body


def inputs_of(dynamics: Dynamics, point: AnyPoint) -> ca.SX:
    """Return the column of a point's algebraic variables and controls, without those that were added."""
    body = body_of(dynamics)
    controls = (point.extra[v.name] if v.name in point.extra else point.u[v.name] for v in body.controls)
    return ca.vertcat(ca.SX(0, 1), *(point.z[v.name] for v in body.algebraic), *controls)


def with_fixed(dynamics: Dynamics, bounds: Bounds, which: str) -> Bounds:
    """Return bounds on the state at the ``which`` end, ``"start"`` or ``"end"``, with added states that are fixed."""
    if not isinstance(dynamics, Augmented):
        return bounds
    names = [s.name for s in dynamics.states]
    values = dynamics.start if which == "start" else dynamics.end
    for name, value in values.items():
        bounds.lower[names.index(name)] = bounds.upper[names.index(name)] = value
    return bounds


def has(dynamics: Dynamics, names: Sequence[str]) -> bool:
    """Whether variables of these names exist already, because another term or constraint added them."""
    known = {v.name for v in (*dynamics.states, *dynamics.algebraic, *dynamics.controls)}
    return set(names) <= known


@dataclass(frozen=True)
class Slacks(Augmented):
    """Further controls s, which only rows of the objective bound."""

    slacks: tuple[Variable, ...]

    @property
    def controls(self) -> tuple[Variable, ...]:
        """Inner controls, then the slacks."""
        return self.inner.controls + self.slacks

    @property
    def time_orders(self) -> TimeOrders | None:
        """0 for slacks; their rows define them."""
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
class FrictionlessTorques(Augmented):
    """The torques of joints without their dry friction, tau_j - F_j tanh(v_j / v_s), as further algebraic variables.

    Attributes
    ----------
    joints : tuple of str
        Joints with a motor.
    """

    joints: tuple[str, ...]
    smooth: ClassVar[bool] = True

    @property
    def _torques(self) -> tuple[Variable, ...]:
        return tuple(c for c in body_of(self.inner).controls if c.joint in self.joints)

    @cached_property
    def frictionless(self) -> tuple[Variable, ...]:
        """``frictionless.<joint>``."""
        return tuple(Variable(f"frictionless.{c.joint}", c.unit, FRICTIONLESS, c.joint) for c in self._torques)

    @property
    def algebraic(self) -> tuple[Variable, ...]:
        """Inner algebraic variables, then the torques without dry friction."""
        return (*self.inner.algebraic, *self.frictionless)

    @cached_property
    def residuals(self) -> tuple[Variable, ...]:
        """Inner rows, then the definitions of the torques without dry friction."""
        return (*self.inner.residuals, *self.frictionless)

    @property
    def time_orders(self) -> TimeOrders | None:
        """0 for torques."""
        known = self._inner_orders
        return known and known._replace(algebraic=known.algebraic + (0,) * len(self.frictionless))

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Put the torques without dry friction into ``point.extra``."""
        nz = len(self.inner.algebraic)
        point = self.inner.point(t, x, None if z is None else z[:nz, :], u, p, names)
        if z is not None:
            point.extra |= {v.name: z[nz + i] for i, v in enumerate(self.frictionless)}
        return point

    def residual(self, point: AnyPoint) -> ca.SX:
        """Inner rows, then tau - F tanh(v / v_s) less the variables."""
        body = body_of(self.inner)
        assert isinstance(body, RigidBody)
        friction, moved = body.dry_friction(point), body.robot.velocity_names
        rows = (
            point.u[c.name] - friction[moved.index(c.joint)] - point.extra[v.name]
            for c, v in zip(self._torques, self.frictionless, strict=True)
        )
        return ca.vertcat(self.inner.residual(point), *rows)


@dataclass(frozen=True)
class RunningIntegral(Augmented):
    """A further state that integrates a rate from 0 at the start of the phase."""

    integral: Variable
    rate: Callable[[AnyPoint], Scalar] = field(repr=False)

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

    def rates(self, point: AnyPoint) -> ca.SX:
        """Inner rates, then the integrand."""
        return ca.vertcat(self.inner.rates(point), self.rate(point))
