"""Curves of a tool's pose: lines, arcs and blends, with two derivatives.

A pose near a reference rotation R is (p, w) with the rotation R exp(w). On lines and arcs w is linear in the way s,
with R at either end of the move. A blend around the corner of two moves is a polynomial in (p, w) about the corner's R.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass

STRAIGHT = 1e-6
"""Least sine of the angle at the middle point of an arc."""
TERMS = 30
"""Number of terms of the series of the angular velocity; the last is below 1e-16 for |w| up to pi."""


class ToolCurve(Protocol):
    """A curve of poses over s in [0, length]."""

    def rotation(self, last: bool) -> Array:
        """Return the reference rotation (3, 3), of the start or of the end."""

    def state(self, s: float, last: bool) -> Array:
        """Return (p, w) about that rotation, with first and second derivatives, (3, 6)."""


@dataclass(frozen=True, eq=False)
class ToolMove:
    """A line, or an arc about a centre, with a rotation about one axis in proportion to the way.

    Attributes
    ----------
    first, last : pinocchio.SE3
    centre : ndarray (3,) or None
        Of an arc [m].
    turn : ndarray (3,)
        Axis of the arc times its angle [rad].
    """

    first: pin.SE3
    last: pin.SE3
    centre: Array | None
    turn: Array

    @property
    def length(self) -> float:
        """Length of the way of the tool [m], or its angle [rad] where it only turns."""
        if self.centre is not None:
            return float(np.linalg.norm(self.turn) * np.linalg.norm(self.first.translation - self.centre))
        moved = float(np.linalg.norm(self.last.translation - self.first.translation))
        return moved if moved > 0.0 else float(np.linalg.norm(self.turned))

    @property
    def turned(self) -> Array:
        """Rotation vector from the first to the last orientation (3,) [rad]."""
        return np.asarray(pin.log3(self.first.rotation.T @ self.last.rotation))

    def rotation(self, last: bool) -> Array:
        """Return the rotation of an end (3, 3)."""
        return np.asarray((self.last if last else self.first).rotation)

    def state(self, s: float, last: bool) -> Array:
        """Return (p, w) and two derivatives, (3, 6)."""
        length = self.length
        found = np.zeros((3, 6))
        found[0, 3:] = (s / length - last) * self.turned
        found[1, 3:] = self.turned / length
        start = self.first.translation
        if self.centre is None:
            way = self.last.translation - start
            found[0, :3], found[1, :3] = start + s / length * way, way / length
        else:
            rate = self.turn / length
            arm = pin.exp3(rate * s) @ (start - self.centre)
            speed = np.cross(rate, arm)
            found[:, :3] = self.centre + arm, speed, np.cross(rate, speed)
        return found


@dataclass(frozen=True, eq=False)
class ToolBlend:
    """A polynomial in (p, w) about a corner's rotation.

    Attributes
    ----------
    corner : ndarray (3, 3)
    curve : PiecewisePolynomial
        One piece over [0, length].
    """

    corner: Array
    curve: PiecewisePolynomial

    def rotation(self, last: bool) -> Array:
        """Return the corner's rotation (3, 3)."""
        return self.corner

    def state(self, s: float, last: bool) -> Array:
        """Return (p, w) and two derivatives, (3, 6)."""
        slope = self.curve.derivative()
        return np.array([self.curve(s), slope(s), slope.derivative()(s)])


def line(first: pin.SE3, last: pin.SE3) -> ToolMove:
    """Return the straight line between two poses."""
    return ToolMove(first, last, None, np.zeros(3))


def arc(first: pin.SE3, through: Array, last: pin.SE3, what: str) -> ToolMove:
    """Return the arc between two poses through a point.

    Raises
    ------
    InputError
        The three points lie on a line.
    """
    a, b = through - first.translation, last.translation - through
    normal = np.cross(a, b)
    size = float(np.linalg.norm(normal))
    if not size > STRAIGHT * np.linalg.norm(a) * np.linalg.norm(b):
        raise InputError(
            f"{what}: start, middle {np.round(through, 6).tolist()} and end of the arc lie on one line. Give a point "
            "beside it, or use MoveL."
        )
    normal /= size
    # The centre c has equal distances from the three points: 2 a'(c - p0) = a'a, 2 b'(c - p1) = b'b, n'(c - p0) = 0.
    rows, right = np.array([a, b, normal]), np.array([a @ a / 2, b @ b / 2 + b @ a, 0.0])
    centre = first.translation + np.linalg.solve(rows, right)
    start, end = first.translation - centre, last.translation - centre
    angle = float(np.arctan2(normal @ np.cross(start, end), start @ end)) % (2.0 * np.pi)
    return ToolMove(first, last, centre, angle * normal)


def twist_rates(rotation: Array, state: Array) -> tuple[pin.SE3, Array, Array]:
    """Return the pose of (p, w) about a rotation, and the twist and its rate in world axes (6,) [m, rad per s].

    The body's angular velocity is J(w) w' with J(w) = sum_k (-W)^k / (k + 1)! and W = [w]x.
    """
    w, rate, second = state[:, 3:]
    cross, moving = pin.skew(w), pin.skew(rate)
    term, change = np.eye(3), np.zeros((3, 3))
    total, slope = term.copy(), change.copy()
    for k in range(1, TERMS):
        change = -(change @ cross + term @ moving) / (k + 1)
        term = -(term @ cross) / (k + 1)
        total, slope = total + term, slope + change
    turned = rotation @ pin.exp3(w)
    velocity, acceleration = turned @ (total @ rate), turned @ (total @ second + slope @ rate)
    return (
        pin.SE3(turned, state[0, :3]),
        np.concatenate([state[1, :3], velocity]),
        np.concatenate([state[2, :3], acceleration]),
    )
