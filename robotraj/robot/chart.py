"""Coordinates in which configurations are interpolated, also those of a robot with a floating root.

The quaternion of a floating root cannot be interpolated entry by entry. The chart represents it by the rotation vector
from a base quaternion, so that y = (position, rotation vector, joints) has nv entries. Along a straight line in y the
root's origin and the joints move on straight lines. The root rotates about one axis at constant rate (slerp). Without
a floating root y = q.

Source: Sola, Deray and Atchuthan, A micro Lie theory for state estimation in robotics (2018), section IV.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.robot.root import QUATERNION
from robotraj.robot.tangent import PLACE, REST, TURN, conjugate, floats, product, rotated

SMALL = 1e-6
"""Angles [rad] below are treated as zero."""
STEP = 1e-5
"""Step of the central difference along the motion, for the rate of a Jacobian."""
PITCH = np.array([0.0, 1.0, 0.0])
"""Axis of a full turn from a quaternion to its negative, which do not determine one: that of a somersault."""


@dataclass(frozen=True, eq=False)
class Chart:
    """Coordinates of configurations around one of them.

    Attributes
    ----------
    base : (4,) array or None
        Base quaternion; None without a floating root.
    """

    base: Array | None

    @classmethod
    def around(cls, model: pin.Model, q: Array) -> Chart:
        """Return the chart whose base is configuration q (nq,)."""
        return cls(np.array(q[QUATERNION]) if floats(model) else None)

    def coordinates(self, keys: Array) -> Array:
        """Return the coordinates (m, nv) of consecutive configurations (m, nq).

        A quaternion and its negative differ by a full turn. Of the rotation vectors of a quaternion the one nearest to
        the previous configuration's is chosen, so that a sequence can represent several turns.
        """
        if self.base is None:
            return np.array(keys, dtype=float)
        turns, before = [], np.zeros(3)
        for quaternion in product(conjugate(self.base), keys[:, QUATERNION]):
            before = _turn(quaternion, before)
            turns.append(before)
        return np.hstack([keys[:, PLACE], np.array(turns), keys[:, QUATERNION.stop :]])

    def positions(self, y: Array) -> Array:
        """Return the configurations (m, nq) at coordinates (m, nv)."""
        if self.base is None:
            return y
        return np.hstack([y[:, PLACE], product(self.base, _exponential(y[:, TURN])), y[:, REST]])

    def velocities(self, y: Array, rate: Array) -> Array:
        """Return v (m, nv) of a motion with rates y' (m, nv) at y; the root's velocities are in its own axes."""
        if self.base is None:
            return rate
        back = conjugate(self.positions(y)[:, QUATERNION])
        omega = np.einsum("mij,mj->mi", _right(y[:, TURN]), rate[:, TURN])
        return np.hstack([rotated(back, rate[:, PLACE]), omega, rate[:, REST]])

    def accelerations(self, y: Array, rate: Array, second: Array) -> Array:
        """Return a (m, nv), the rates of v, of a motion with y' and y'' (m, nv) at y."""
        if self.base is None:
            return second
        v, straight = self.velocities(y, rate), self.velocities(y, second)
        place = straight[:, PLACE] - np.cross(v[:, TURN], v[:, PLACE])
        ahead, behind = (_right(y[:, TURN] + sign * STEP * rate[:, TURN]) for sign in (1.0, -1.0))
        bend = np.einsum("mij,mj->mi", (ahead - behind) / (2.0 * STEP), rate[:, TURN])
        return np.hstack([place, straight[:, TURN] + bend, straight[:, REST]])

    def slopes(self, y: Array, v: Array) -> Array:
        """Return the rates y' (nv,) at y of velocities v (nv,), in the least-squares sense after a full turn."""
        if self.base is None:
            return v
        quaternion = self.positions(y[None])[0, QUATERNION]
        turn = np.linalg.lstsq(_right(y[None, TURN])[0], v[TURN], rcond=1e-6)[0]
        return np.concatenate([rotated(quaternion, v[PLACE]), turn, v[REST]])


def coordinate_difference(model: pin.Model, first: Array, last: Array) -> Array:
    """Return the difference (nv,) of the coordinates of two configurations (nq,)."""
    start, end = Chart.around(model, first).coordinates(np.array([first, last]))
    return np.asarray(end - start)


def _turn(quaternion: Array, before: Array) -> Array:
    """Return the rotation vector [rad] of a signed quaternion nearest to ``before``; candidates are 4 pi apart."""
    size = np.linalg.norm(quaternion[:3])
    angle = 2.0 * np.arctan2(size, quaternion[3])
    if size > SMALL:
        axis = quaternion[:3] / size
    else:
        length = np.linalg.norm(before)
        axis = before / length if length > SMALL else PITCH
        if quaternion[3] > 0:
            angle = 0.0
    lifts = np.round((before @ axis - angle) / (4.0 * np.pi))
    return np.asarray((angle + 4.0 * np.pi * lifts) * axis)


def _exponential(turn: Array) -> Array:
    """Quaternions (m, 4) of rotation vectors (m, 3)."""
    half = 0.5 * np.linalg.norm(turn, axis=1, keepdims=True)
    return np.hstack([0.5 * np.sinc(half / np.pi) * turn, np.cos(half)])


def _right(turn: Array) -> Array:
    """Right Jacobians (m, 3, 3): the angular velocity in the body is J(turn) turn'."""
    angle = np.linalg.norm(turn, axis=1)
    small = angle < 1e-3
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 0.5 - angle**2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    second = np.where(small, 1.0 / 6.0 - angle**2 / 120.0, (safe - np.sin(safe)) / safe**3)
    cross = np.zeros((len(turn), 3, 3))
    x, y, z = turn.T
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross -= np.swapaxes(cross, 1, 2)
    return np.asarray(np.eye(3) - first[:, None, None] * cross + second[:, None, None] * (cross @ cross))
