"""Configurations of a robot that stands: inverse kinematics to feet, centre of mass and an upright root."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.dynamics.holding import anchors
from robotraj.dynamics.rigid_body import InverseDynamics
from robotraj.problem.constraints.base import symbols_of
from robotraj.robot.root import QUATERNION
from robotraj.robot.tangent import rate_matrix

if TYPE_CHECKING:
    from robotraj.dynamics.contacts.base import BoundContact
    from robotraj.robot.robot import Robot

Array = NDArray[np.float64]

FOOT, MASS, TILT, JOINT = 100.0, 10.0, 3.0, 0.3
"""Weights of a metre's (radian's) error of feet, centre of mass, root and joints: each gives way to those before."""
STEPS = 60
CLOSE = 1e-10
REPEATS = 5
ROOT_FREEDOMS = {"fixed": 0, "planar": 3, "floating": 6}


@dataclass(frozen=True, eq=False)
class BalancedStance:
    """A robot and the contacts that its feet make, in numbers.

    Attributes
    ----------
    robot : Robot
    contacts : tuple of BoundContact
        All feet, on the ground or swinging.
    """

    robot: Robot
    contacts: tuple[BoundContact, ...]

    @cached_property
    def _names(self) -> list[str]:
        return [anchor.name for contact in self.contacts for anchor in contact.anchors]

    @cached_property
    def _places(self) -> ca.Function:
        point: Any = symbols_of(InverseDynamics().of(self.robot, None, self.contacts), self._names)
        rows = [row for contact in self.contacts for row in contact.position(point, anchors(contact, point.p))]
        y, p = ca.densify(ca.vertcat(*rows)), ca.vertcat(ca.SX(0, 1), *point.p.values())
        return ca.Function("places", [point.q, p], [y, ca.densify(ca.jacobian(y, point.q))])

    @cached_property
    def _evaluated_places(self) -> tuple[Array, Array, Array, Array, Any]:
        """Arrays that ``_places`` reads (q, anchors) and writes (rows, transposed Jacobian), and what runs it."""
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
        """What Pinocchio's algorithms write into."""
        return self.robot.model.createData()

    @cached_property
    def _efforts(self) -> ca.Function:
        """J' of all forces, (nv, forces): joint torques of the contacts' forces."""
        point: Any = symbols_of(InverseDynamics().of(self.robot, None, self.contacts), self._names)
        rows = ca.vertcat(*(row for contact in self.contacts for row in contact.velocity(point)))
        return ca.Function("efforts", [point.q], [ca.jacobian(rows, point.v).T])

    def jacobian(self, q: Array) -> Array:
        """Velocities of all contacts' rows per velocity of the robot, (m, nv)."""
        return np.array(self._efforts(q)).T

    def locate(self, q: Array) -> dict[str, float]:
        """Where all contacts stand in configuration q, by anchor."""
        return {name: value for contact in self.contacts for name, value in contact.locate(self.robot, q).items()}

    def columns(self, names: Sequence[str]) -> list[int]:
        """Places of the rows and forces of the contacts named, among those of all."""
        ends = np.cumsum([0, *(len(contact.holds) for contact in self.contacts)])
        return [
            j
            for contact, start, end in zip(self.contacts, ends[:-1], ends[1:], strict=True)
            if contact.name in names
            for j in range(start, end)
        ]

    def lifted(self, lifts: Mapping[str, float]) -> Array:
        """Rows (m,) that feet so high above the ground [m] have, where they would be zero on it."""
        heights = [
            lifts.get(contact.name, 0.0) if row.name.endswith(".z") else 0.0
            for contact in self.contacts
            for row in contact.holds
        ]
        return np.array(heights)

    def places(self, q: Array, feet: Mapping[str, float]) -> tuple[Array, Array]:
        """Rows (m,) of all contacts at anchors ``feet``, and their Jacobian (m, nv)."""
        at, anchored, rows, slope, (run, _) = self._evaluated_places
        at[:], anchored[:] = q, [feet[name] for name in self._names]
        run()
        return rows.copy(), slope.T @ rate_matrix(self.robot.model, q)

    def reach(
        self, near: Array, feet: Mapping[str, float], mass: Any, lifts: Mapping[str, float], posture: Array
    ) -> Array:
        """Find the configuration (nq,) nearest to ``near`` with feet, centre of mass and posture as asked for.

        Damped least squares on weighted errors, then Newton's method on the feet alone, which thus come first.
        Sources: Nakamura and Hanafusa, Journal of Dynamic Systems, Measurement, and Control 108 (1986).

        Parameters
        ----------
        near : ndarray (nq,)
        feet : mapping of str to float
            Anchors.
        mass : sequence of 3 float
            Centre of mass in the world [m]; NaN for what is left free.
        lifts : mapping of str to float
            Height of feet above the ground [m] by contact; zero where not named.
        posture : ndarray (nq,)
            What joints and root tend to.
        """
        robot, raised = self.robot, self.lifted(lifts)
        q, damping = self._inside(near), 1e-6
        error, slope = self._errors(q, feet, np.asarray(mass, dtype=float), raised, posture)
        for _ in range(STEPS):
            step = self._step(q, slope, error, damping)
            trial = self._inside(pin.integrate(robot.model, q, step))
            after, next_slope = self._errors(trial, feet, np.asarray(mass, dtype=float), raised, posture)
            gain = error @ error - after @ after
            if gain > 0:
                q, error, slope, damping = trial, after, next_slope, max(0.2 * damping, 1e-9)
                if gain < 1e-8 * (error @ error):
                    break
            else:
                damping *= 10.0
                if damping > 1e6:
                    break
        return self.settle(q, feet, raised)

    def settle(self, q: Array, feet: Mapping[str, float], raised: Array) -> Array:
        """Bring the feet to their places by the smallest change of a configuration, where that is possible."""
        rows, slope = self.places(q, feet)
        for _ in range(20):
            size = np.linalg.norm(rows - raised)
            if size < CLOSE:
                break
            trial = self._inside(pin.integrate(self.robot.model, q, self._step(q, slope, rows - raised, 1e-12)))
            after, next_slope = self.places(trial, feet)
            if np.linalg.norm(after - raised) >= size:
                break
            q, rows, slope = trial, after, next_slope
        return q

    def _step(self, q: Array, slope: Array, error: Array, damping: float) -> Array:
        """Levenberg and Marquardt's step, joints held that would leave their bounds."""
        lower, upper = self._bounds
        n = ROOT_FREEDOMS[self.robot.root]
        joints, pull = q[len(q) - len(lower) :], -(slope.T @ error)[n:]
        free = np.ones(self.robot.nv, dtype=bool)
        free[n:] = ~((joints <= lower + 1e-9) & (pull < 0) | (joints >= upper - 1e-9) & (pull > 0))
        held = slope * free
        return np.asarray(-np.linalg.solve(held.T @ held + damping * np.eye(held.shape[1]), held.T @ error))

    def _errors(self, q: Array, feet: Mapping[str, float], mass: Array, raised: Array, posture: Array) -> Any:
        robot, n = self.robot, ROOT_FREEDOMS[self.robot.root]
        rows, slope = self.places(q, feet)
        jacobian = pin.jacobianCenterOfMass(robot.model, self.data, q)
        known = np.isfinite(mass)
        away = pin.difference(robot.model, posture, q)
        weights = np.full(robot.nv, JOINT)
        weights[:n] = np.where(np.array(robot.units[:n]) == "rad", TILT, 0.0)
        kept = weights > 0
        error = np.concatenate(
            [FOOT * (rows - raised), MASS * (np.array(self.data.com[0]) - mass)[known], (weights * away)[kept]]
        )
        return error, np.vstack([FOOT * slope, MASS * jacobian[known], np.diag(weights)[kept]])

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        """Bounds of the joints."""
        n = ROOT_FREEDOMS[self.robot.root]
        return self.robot.limits.position_lower[n:], self.robot.limits.position_upper[n:]

    def _inside(self, q: Array) -> Array:
        lower, upper = self._bounds
        q = np.array(q)
        q[len(q) - len(lower) :] = np.clip(q[len(q) - len(lower) :], lower, upper)
        return q


def upright(robot: Robot, q: Array) -> Array:
    """Give a configuration with the root's attitude level, heading along world x."""
    q = np.array(q)
    if robot.root == "floating":
        q[QUATERNION] = (0.0, 0.0, 0.0, 1.0)
    elif robot.root == "planar":
        q[2] = 0.0
    return q


def standing(stance: BalancedStance, height: float | None = None) -> Array:
    """Give the configuration (nq,) with all feet on the ground below, knees bent, the centre of mass over their middle.

    The feet stand where the neutral configuration has them. Where its legs are straight, joints at the end of their
    range bend inwards and the centre of mass sinks by a twentieth of its height, as far as the legs allow.

    Parameters
    ----------
    stance : BalancedStance
    height : float, optional
        Of the centre of mass above the feet [m].
    """
    robot = stance.robot
    q = upright(robot, robot.neutral)
    feet = stance.locate(q)
    n = ROOT_FREEDOMS[robot.root]
    model, data = robot.model, robot.model.createData()
    if n:
        # On the ground first: the root moves up or down with all feet.
        rows, _ = stance.places(q, feet)
        up = [j for j, row in enumerate(r for c in stance.contacts for r in c.holds) if row.name.endswith(".z")]
        q[1 if robot.root == "planar" else 2] -= float(np.mean(rows[up]))
    com = pin.centerOfMass(model, data, q)
    _, slope = stance.places(q, feet)
    up = [j for j, row in enumerate(r for c in stance.contacts for r in c.holds) if row.name.endswith(".z")]
    straight = bool(np.max(np.abs(slope[up][:, n:]), initial=0.0) < 1e-2 * abs(com[2]))
    lower, upper = stance._bounds
    start = np.array(q)
    middle = [
        np.mean([feet[a.name] for c in stance.contacts for a in c.anchors if a.name == f"{c.name}.{axis}"] or [0.0])
        for axis in "xy"
    ]
    ground = float(com[2] - height_above(stance, feet, com))
    target = height if height is not None else (0.95 if straight else 1.0) * (com[2] - ground)
    if straight:
        joints = start[len(start) - len(lower) :]
        joints += np.where(joints - lower < 0.05, 0.6, np.where(upper - joints < 0.05, -0.6, 0.0))
        start = stance._inside(start)
    found, mass = stance.reach(start, feet, [*middle, ground + target], {}, start if straight else q), ground + target
    for _ in range(REPEATS if height is not None else 0):
        # A height that is asked for comes before the posture: joints tend to where they have come.
        found = stance.reach(found, feet, [*middle, mass], {}, upright(robot, found))
    return found


def height_above(stance: BalancedStance, feet: Mapping[str, float], com: Array) -> float:
    """Height of the centre of mass above the middle of the feet [m]."""
    heights = []
    for contact in stance.contacts:
        ground = contact.contact.ground  # type: ignore[attr-defined]
        heights.append(float(ground.height(feet.get(f"{contact.name}.x", 0.0), feet.get(f"{contact.name}.y", 0.0))))
    return float(com[2] - np.mean(heights))
