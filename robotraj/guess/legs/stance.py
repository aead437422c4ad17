"""Inverse kinematics of a robot on its feet: footholds, centre of mass and an upright root."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import cast

import casadi as ca
import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.dynamics.contact_expressions import anchors
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.mobility import AXES
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.rigid_body_forms import InverseDynamics
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import as_ground
from robotraj.guess.reaching.descent import descended
from robotraj.problem.constraints.base import symbols_of
from robotraj.robot.robot import Robot
from robotraj.robot.root import ROOTS
from robotraj.robot.size.reach import reach
from robotraj.robot.tangent import rate_matrix

Errors = Callable[[Array], tuple[Array, Array]]
"""Errors (m,) of rows in a configuration (nq,), and their slopes (m, nv)."""

FOOT, MASS, TILT, JOINT = 100.0, 10.0, 3.0, 0.3
"""Weights of the errors of feet, centre of mass, root attitude and joints, in order of priority.

Angles are in rad. Lengths are divided by the reach of the robot, so that robots of all sizes stand alike.
"""
SHORT = 0.05
"""Length relative to the reach of the robot that is short: half a sole, the lowest pendulum, a joint near a bound."""


def root_freedoms(robot: Robot) -> int:
    """Return the number of velocities of a robot's root."""
    return len(ROOTS[robot.root].velocities)


@dataclass(frozen=True, eq=False)
class BalancedStance:
    """Numerical functions of a robot and of the contacts of its feet.

    Attributes
    ----------
    robot : Robot
    contacts : tuple of BoundContact
        Contacts of all feet, standing or swinging, and other contacts, such as a hand that holds a rail.
    """

    robot: Robot
    contacts: tuple[BoundContact, ...]

    @cached_property
    def feet(self) -> tuple[BoundContact, ...]:
        """Return the contacts with a ground below the robot; hands on walls are others."""
        return tuple(contact for contact in self.contacts if contact.stands)

    @cached_property
    def upward(self) -> list[int]:
        """Return the indices of the rows for the heights of the feet among those of all contacts."""
        names = {contact.name for contact in self.feet}
        rows = [(contact.name, row.name) for contact in self.contacts for row in contact.holds]
        return [j for j, (contact, row) in enumerate(rows) if contact in names and row.endswith(".z")]

    @cached_property
    def _names(self) -> list[str]:
        return [anchor.name for contact in self.contacts for anchor in contact.anchors]

    @cached_property
    def _places(self) -> ca.Function:
        point = cast(RobotPoint, symbols_of(InverseDynamics().of(self.robot, None, self.contacts), self._names))
        rows = [row for contact in self.contacts for row in contact.position(point, anchors(contact, point.p))]
        y, p = ca.densify(ca.vertcat(*rows)), ca.vertcat(ca.SX(0, 1), *point.p.values())
        return ca.Function("places", [point.q, p], [y, ca.densify(ca.jacobian(y, point.q))])

    @cached_property
    def _evaluated_places(self) -> tuple[Array, Array, Array, Array, tuple[Callable[[], None], object]]:
        """Return input arrays (q, anchors), output arrays (rows, transposed Jacobian) and evaluator of ``_places``."""
        buffer, run = self._places.buffer()
        q, p = np.zeros(self.robot.nq), np.zeros(len(self._names))
        rows = np.zeros(self._places.numel_out(0))
        slope = np.zeros((self.robot.nq, len(rows)))
        for i, given in enumerate((q, p)):
            if given.size:
                buffer.set_arg(i, given.data)
        for i, result in enumerate((rows, slope)):
            buffer.set_res(i, result.data)
        return q, p, rows, slope, (run, buffer)

    @cached_property
    def data(self) -> pin.Data:
        """Return the workspace of Pinocchio's algorithms."""
        return self.robot.model.createData()

    @cached_property
    def size(self) -> float:
        """Return the length to which errors are compared: the reach of the robot [m]."""
        return reach(self.robot.model) or 1.0

    def scales(self, units: Sequence[str]) -> Array:
        """Return the size for every unit of length and 1 for every other one."""
        return np.where(np.array(units, dtype=str) == "m", self.size, 1.0)

    @cached_property
    def _efforts(self) -> ca.Function:
        """Return the function from q to J' (nv, forces), which maps contact forces to joint torques."""
        point = cast(RobotPoint, symbols_of(InverseDynamics().of(self.robot, None, self.contacts), self._names))
        rows = ca.vertcat(*(row for contact in self.contacts for row in contact.velocity(point)))
        return ca.Function("efforts", [point.q], [ca.jacobian(rows, point.v).T])

    def jacobian(self, q: Array) -> Array:
        """Return the Jacobian of the rows of all contacts with respect to v, (m, nv)."""
        return np.array(self._efforts(q)).T

    def locate(self, q: Array) -> dict[str, float]:
        """Return the anchors of all contacts in configuration q, by name."""
        return {name: value for contact in self.contacts for name, value in contact.locate(self.robot, q).items()}

    def columns(self, names: Sequence[str]) -> list[int]:
        """Return the indices of the rows and forces of the named contacts among those of all."""
        ends = np.cumsum([0, *(len(contact.holds) for contact in self.contacts)])
        return [
            j
            for contact, start, end in zip(self.contacts, ends[:-1], ends[1:], strict=True)
            if contact.name in names
            for j in range(start, end)
        ]

    def lifted(self, lifts: Mapping[str, float]) -> Array:
        """Return the rows (m,) of feet at the given heights above the ground [m]; on the ground they are zero."""
        heights = []
        for contact in self.contacts:
            ground = as_ground(contact.contact.ground or Flat())
            away = ground.side * lifts.get(contact.name, 0.0)
            heights += [away if row.name.endswith(f".{AXES[ground.axis]}") else 0.0 for row in contact.holds]
        return np.array(heights)

    def places(self, q: Array, feet: Mapping[str, float]) -> tuple[Array, Array]:
        """Return the rows (m,) of all contacts at anchors ``feet``, and their Jacobian (m, nv)."""
        at, anchored, rows, slope, (run, _) = self._evaluated_places
        at[:], anchored[:] = q, [feet[name] for name in self._names]
        run()
        return rows.copy(), slope.T @ rate_matrix(self.robot.model, q)

    def reach(
        self,
        near: Array,
        feet: Mapping[str, float],
        com: ArrayLike,
        lifts: Mapping[str, float],
        posture: Array,
        further: Errors | None = None,
    ) -> Array:
        """Return a configuration (nq,) near ``near`` with given feet, centre of mass and posture.

        Damped least squares (``guess.reaching.descent``) minimise weighted errors, and then those of the feet alone.

        Parameters
        ----------
        near : ndarray (nq,)
        feet : mapping of str to float
            Anchors by name [m, rad].
        com : sequence of 3 float
            Centre of mass in the world [m]; NaN leaves a coordinate free.
        lifts : mapping of str to float
            Height of feet above the ground [m] by contact; others are 0.
        posture : ndarray (nq,)
            Reference of joints and root.
        further : callable, optional
            Further rows, as important as the feet, with lengths relative to ``size``.
        """
        raised, com = self.lifted(lifts), np.asarray(com, dtype=float)

        def errors(q: Array) -> tuple[Array, Array]:
            return self._errors(q, feet, com, raised, posture, further)

        return self.settle(self._descended(near, errors), feet, raised)

    def settle(self, q: Array, feet: Mapping[str, float], raised: Array) -> Array:
        """Move the feet to their anchors by steps of nearly the least norm."""

        def errors(q: Array) -> tuple[Array, Array]:
            rows, slope = self.places(q, feet)
            return rows - raised, slope

        return self._descended(q, errors)

    def _descended(self, q: Array, errors: Errors) -> Array:
        """Return the configuration (nq,) of least errors near one, within the bounds of the joints."""

        def missed(each: Array) -> tuple[Array, Array]:
            error, slope = errors(each[0])
            return -error[None], slope[None]

        lower, upper = self.bounds
        root = np.full(self.robot.nq - len(lower), np.inf)
        bounds = np.concatenate([-root, lower]), np.concatenate([root, upper])
        return np.asarray(descended(missed, q[None], bounds, model=self.robot.model)[0][0])

    def _errors(
        self,
        q: Array,
        feet: Mapping[str, float],
        com: Array,
        raised: Array,
        posture: Array,
        further: Errors | None,
    ) -> tuple[Array, Array]:
        robot, n = self.robot, root_freedoms(self.robot)
        rows, slope = self.places(q, feet)
        jacobian = pin.jacobianCenterOfMass(robot.model, self.data, q)
        known = np.isfinite(com)
        away = pin.difference(robot.model, posture, q)
        weights = JOINT / self.scales(robot.units)
        weights[:n] = np.where(np.array(robot.units[:n]) == "rad", TILT, 0.0)
        kept = weights > 0
        foot = FOOT / self.scales([row.unit for contact in self.contacts for row in contact.holds])
        mass = MASS / self.size
        error = np.concatenate(
            [foot * (rows - raised), mass * (np.array(self.data.com[0]) - com)[known], (weights * away)[kept]]
        )
        slopes = [foot[:, None] * slope, mass * jacobian[known], np.diag(weights)[kept]]
        if further is None:
            return error, np.vstack(slopes)
        missed, slope = further(q)
        return np.concatenate([error, FOOT * missed]), np.vstack([*slopes, FOOT * slope])

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the joints, without those of the root [rad, m]."""
        n = root_freedoms(self.robot)
        return self.robot.limits.position_lower[n:], self.robot.limits.position_upper[n:]

    def inside(self, q: Array) -> Array:
        """Return the configuration with every joint clipped to its bounds."""
        lower, upper = self.bounds
        q = np.array(q)
        q[len(q) - len(lower) :] = np.clip(q[len(q) - len(lower) :], lower, upper)
        return q
