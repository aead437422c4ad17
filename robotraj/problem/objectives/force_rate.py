"""Integral of squared rates of contact forces, for smooth loading and unloading of feet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import casadi as ca

from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import positive
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import Point, RobotPoint
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Variable
from robotraj.problem.augmentation import Augmented, body_of, has
from robotraj.problem.constraints.base import BoundConstraint, Where, robot_of
from robotraj.problem.objectives.base import Integral
from robotraj.problem.objectives.weights import WeightsLike, weights_of
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class ForceRates(Augmented):
    """Contact forces become states and their rates r controls, fdot = r; points still have them in ``point.z``."""

    smooth: ClassVar[bool] = True

    @cached_property
    def _forces(self) -> tuple[Variable, ...]:
        body = body_of(self.inner)
        assert isinstance(body, RigidBody)
        return tuple(force for contact in body.contacts for force in contact.forces)

    @property
    def states(self) -> tuple[Variable, ...]:
        """Inner states, then the contact forces."""
        return (*self.inner.states, *self._forces)

    @cached_property
    def algebraic(self) -> tuple[Variable, ...]:
        """Inner algebraic variables without the contact forces."""
        return tuple(v for v in self.inner.algebraic if v not in self._forces)

    @cached_property
    def controls(self) -> tuple[Variable, ...]:
        """Inner controls, then the rates ``rate.force.<contact>.<axis>``."""
        return (*self.inner.controls, *self.rate_variables)

    @cached_property
    def rate_variables(self) -> tuple[Variable, ...]:
        """The rates."""
        return tuple(Variable(f"rate.{f.name}", f"{f.unit}/s", f"{f.quantity} rate", f.joint) for f in self._forces)

    def point(self, t: ca.SX, x: ca.SX, z: ca.SX | None, u: ca.SX | None, p: ca.SX, names: Sequence[str]) -> Point:
        """Return a point with the forces among the algebraic variables and their rates in ``point.extra``."""
        nx, nu = len(self.inner.states), len(self.inner.controls)
        inner = None
        if z is not None:
            known = {v.name: z[i] for i, v in enumerate(self.algebraic)}
            known |= {v.name: x[nx + i] for i, v in enumerate(self._forces)}
            inner = ca.vertcat(*(known[v.name] for v in self.inner.algebraic))
        point = self.inner.point(t, x[:nx, :], inner, None if u is None else u[:nu, :], p, names)
        if u is not None:
            point.extra |= {v.name: u[nu + i] for i, v in enumerate(self.rate_variables)}
        return point

    def rates(self, point: RobotPoint) -> ca.SX:
        """Inner rates, then r."""
        return ca.vertcat(self.inner.rates(point), *(point.extra[v.name] for v in self.rate_variables))


@dataclass(frozen=True)
class ForceRate(Integral):
    """Integral over the phase of sum_i w_i (d f_i / dt)^2 over all components of contact forces [N^2/s].

    The forces become states. So they are continuous within the phase and as smooth as the scheme's states. Their ends
    are free, since contacts may begin and end abruptly.

    Parameters
    ----------
    weights : None, number, sequence or mapping by contact
        One weight a contact, 1 by default.
    most : float, optional
        Greatest |d f_i / dt| at collocation points [N/s, N m/s].

    Raises
    ------
    InputError
        The phase has no contacts, a contact is unknown, or the bound is not positive.
    """

    weights: WeightsLike = None
    most: float | None = None

    def rate(self, point: RobotPoint) -> Scalar:
        """Weighted sum of squared rates."""
        names = [name for name in point.extra if name.startswith("rate.force.")]
        contacts = list(dict.fromkeys(_contact(name) for name in names))
        weights = dict(zip(contacts, weights_of(self.weights, contacts, "ForceRate"), strict=True))
        return sum((weights[_contact(n)] * point.extra[n] ** 2 for n in names if weights[_contact(n)]), ca.SX(0))

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check that contacts hold, the weights and the bound."""
        robot_of(body_of(dynamics), "ForceRate")
        contacts = [contact.name for contact in getattr(body_of(dynamics), "contacts", ())]
        if not contacts:
            raise InputError("ForceRate() needs contacts, but the phase holds none; give it contacts=[...].")
        weights_of(self.weights, contacts, "ForceRate")
        if self.most is not None:
            positive(self.most, "bound most= of ForceRate", "N/s")

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Make the forces states."""
        rates = ForceRates(dynamics)
        return dynamics if has(dynamics, [v.name for v in rates.rate_variables]) else rates

    def definitions(self, dynamics: Dynamics) -> tuple[BoundConstraint, ...]:
        """Return the bounds on the rates; none without ``most``."""
        if self.most is None:
            return ()
        rates = [v for v in dynamics.controls if v.name.startswith("rate.force.")]
        rows = tuple(Row("force rate", v.unit, -self.most, self.most, v.joint, v.name) for v in rates)
        return (BoundConstraint("force rate", rows, lambda p: [p.extra[v.name] for v in rates], Where.AT_NODES),)


def _contact(rate: str) -> str:
    """Name of the contact in ``rate.force.<contact>.<axis>``."""
    return rate.removeprefix("rate.force.").rsplit(".", 1)[0]
