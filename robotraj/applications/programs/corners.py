"""Corners of a program that are blended within a radius."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.values import dataclass
from robotraj.applications.programs.tool_curves import ToolBlend, ToolMove
from robotraj.applications.programs.tool_joints import SITES, ToolJoints, hermite

BISECTIONS = 50
"""Number of bisections of the way that a blend replaces."""
SHORTER = 0.9
"""Factor by which this way is shortened while the blend leaves the ball."""
ROUNDING = 1e-9
"""Excess of the radius that is rounding, relative to it."""


@dataclass(frozen=True, eq=False)
class JointMove:
    """A straight line of the joints over s in [0, length].

    Attributes
    ----------
    first, last : ndarray (nq,)
        [rad, m].
    length : float
        Length of the line times the reach of the robot [m].
    """

    first: Array
    last: Array
    length: float

    def state(self, s: float) -> Array:
        """Return q and its two derivatives (3, nq)."""
        way = self.last - self.first
        return np.array([self.first + s / self.length * way, way / self.length, np.zeros_like(way)])


@dataclass(frozen=True, eq=False)
class ProgramPart:
    """A move with its configurations at both ends.

    Attributes
    ----------
    number : int
        Its place in the program.
    what : str
        Its name in messages.
    move : JointMove or ToolMove
    joints : ToolJoints
        The branch of inverse kinematics that a tool's move follows.
    ends : tuple of ndarray (nq,)
        At its start and at its end, without blends.
    radius : float
        Of the blend at its end [m].
    """

    number: int
    what: str
    move: JointMove | ToolMove
    joints: ToolJoints
    ends: tuple[Array, Array]
    radius: float

    @property
    def length(self) -> float:
        """Length of the interval of s."""
        return self.move.length

    def state(self, s: float) -> Array:
        """Return q and its two derivatives (3, nq)."""
        if isinstance(self.move, JointMove):
            return self.move.state(s)
        nearest = self.ends[0 if s < 0.5 * self.length else 1]
        return self.joints.at(self.move, s, False, nearest, self.what)

    def position(self, s: float) -> Array:
        """Return the position of the tool (3,) [m]."""
        if isinstance(self.move, ToolMove):
            return np.asarray(self.move.state(s, False)[0, :3])
        return np.asarray(self.joints.pose(self.move.state(s)[0]).translation)


Blend: TypeAlias = "ToolBlend | PiecewisePolynomial"
"""A blend in poses of the tool, or in joints."""


def blend(before: ProgramPart, after: ProgramPart) -> tuple[float, Blend]:
    """Return the way c that a blend replaces on both sides of a corner, and the blend over [0, 2 c].

    c is the largest with both of its ends in the ball of ``before.radius`` around the corner. The blend is the
    polynomial of degree 5 that has the positions and two derivatives of both moves there. Between two moves of the tool
    it is one of the pose, otherwise of the joints. Between straight lines it is in the triangle of its ends and the
    corner, and so in the ball. Other blends are shortened until they are.
    """
    corner = after.position(0.0)

    def far(c: float) -> float:
        return max(
            float(np.linalg.norm(part.position(s) - corner)) for part, s in ((before, before.length - c), (after, c))
        )

    within = before.radius * (1.0 + ROUNDING)
    low, high = 0.0, min(before.length, after.length)
    if far(high) <= within:
        low = high
    else:
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if far(middle) <= before.radius else (low, middle)
    while True:
        curve, positions = _between(before, after, low)
        if np.linalg.norm(positions - corner, axis=1).max() <= within:
            return low, curve
        low *= SHORTER


def _between(before: ProgramPart, after: ProgramPart, c: float) -> tuple[Blend, Array]:
    """Return a blend and positions of the tool along it (m, 3)."""
    first, last = before.move, after.move
    breaks, places = np.array([0.0, 2.0 * c]), np.linspace(0.0, 2.0 * c, 33)
    if isinstance(first, ToolMove) and isinstance(last, ToolMove):
        values = hermite(first.state(before.length - c, True), last.state(c, False), 2.0 * c)
        curve = PiecewisePolynomial(breaks, [SITES], [values])
        return ToolBlend(first.rotation(True), curve), curve(places)[:, :3]
    joints = PiecewisePolynomial(breaks, [SITES], [hermite(before.state(before.length - c), after.state(c), 2.0 * c)])
    return joints, np.array([before.joints.pose(q).translation for q in joints(places)])
