"""The base class of grounds: a height over two world axes, z = h(x, y) by default, with its normal and tangents."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj.dynamics.variable import Scalar

PLANS = ((1, 2), (2, 0), (0, 1))
"""The two world axes (u, v) over which a surface is a height along world x, y or z; u, v and that axis are
right-handed."""


class Ground(OneLine, ABC):
    """A height field. A new ground is one frozen dataclass with ``surface``, written in CasADi's functions.

    Contacts, clearance and replays all use that one expression. Methods take CasADi symbols, CasADi
    numbers, floats or NumPy arrays (x and y broadcast), and return values of the same kind.

    The height is along world z, and the robot is above it. A wall or a ceiling has another ``axis`` or ``side``; then
    the arguments x and y of the methods are the coordinates along the two world axes of ``plan``.

    Attributes
    ----------
    axis : int
        World axis of the height: 0, 1 or 2.
    side : float
        1 where the free side is that of greater coordinates along ``axis``, -1 for the other side.
    even : bool
        Whether the surface is a plane, so that it penetrates a sole at its corners first.
    """

    axis: int = 2
    side: float = 1.0
    even: bool = False

    @property
    def plan(self) -> tuple[int, int]:
        """The two world axes over which the height is given."""
        return PLANS[self.axis]

    @property
    def below(self) -> bool:
        """Whether the surface lies below the robot, which can stand on it."""
        return self.axis == 2 and self.side > 0.0

    @abstractmethod
    def surface(self, x: ca.SX, y: ca.SX) -> ca.SX:
        """Height h(x, y) [m] of symbols x and y [m], twice differentiable wherever a foot may be placed."""

    def footing(self, x: Scalar, y: Scalar, reach: tuple[Scalar, Scalar] = (0.0, 0.0)) -> list[Scalar]:
        """Return rows [m] that are not negative at allowed footholds (x, y) [m]; none if every place is allowed.

        Parameters
        ----------
        x, y : scalar
            Middle of the sole [m].
        reach : pair of scalars
            Half the extent of the sole along world x and y [m]; 0 for a point.
        """
        return []

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Height of the ground [m] at world position (x, y) [m]; symbolic where x and y are."""
        return self.plane(x, y)[0]

    def at(self, x: Scalar, y: Scalar) -> list[Scalar]:
        """Point (3) on the ground [m] in world axes: [x, y, h(x, y)] where the height is along z."""
        return self._in_world(x, y, self.height(x, y))

    def gap(self, place: Sequence[Scalar], radius: float = 0.0) -> Scalar:
        """Distance [m] of a place (3) from the surface along ``axis``, z - h(x, y); negative inside the ground.

        The lowest point of a ball of radius r lies r sqrt(1 + h_x^2 + h_y^2) below its centre.
        """
        first, second = self.plan
        if radius == 0.0:
            return self.side * (place[self.axis] - self.height(place[first], place[second]))
        height, slope_x, slope_y = self.plane(place[first], place[second])
        return self.side * (place[self.axis] - height) - radius * (1.0 + slope_x * slope_x + slope_y * slope_y) ** 0.5

    def normal_at(self, place: Sequence[Scalar]) -> list[Scalar]:
        """Return the unit normal (3) at the point of the surface that a place (3) [m] has along ``axis``."""
        first, second = self.plan
        return self.normal(place[first], place[second])

    def plane(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar, Scalar]:
        """Tangent plane at (x, y): height h [m] and slopes h_x, h_y, from one evaluation."""
        if any(isinstance(value, ca.SX | ca.MX | ca.DM) for value in (x, y)):
            return tuple(self._sampler(x, y))
        xs, ys = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        if not xs.shape:
            return tuple(float(value) for value in self._sampler(float(xs), float(ys)))  # type: ignore[return-value]
        values = self._sampler.map(xs.size)(xs.reshape(1, -1), ys.reshape(1, -1))
        return tuple(np.array(value).reshape(xs.shape) for value in values)  # type: ignore[return-value]

    def normal(self, x: Scalar, y: Scalar) -> list[Scalar]:
        """Return the unit normal (3) towards the free side, (-h_x, -h_y, 1) / sqrt(1 + h_x^2 + h_y^2) upwards."""
        _, slope_x, slope_y = self.plane(x, y)
        scale = self.side * (1.0 + slope_x * slope_x + slope_y * slope_y) ** -0.5
        return self._in_world(-slope_x * scale, -slope_y * scale, scale)

    def axes(self, x: Scalar, y: Scalar) -> tuple[list[Scalar], list[Scalar], list[Scalar]]:
        """Tangents t1, t2 and normal n: unit vectors, right-handed (t1 x t2 = n), as lists of 3.

        t1 = (1, 0, h_x) / sqrt(1 + h_x^2) points along the first axis of ``plan``, world x; t2 = n x t1.
        """
        _, slope_x, slope_y = self.plane(x, y)
        steep = 1.0 + slope_x * slope_x
        along = steep**-0.5
        up = self.side * (steep + slope_y * slope_y) ** -0.5
        first = self._in_world(along, 0.0 * slope_x, slope_x * along)
        second = self._in_world(-slope_x * slope_y * along * up, steep * along * up, slope_y * along * up)
        return first, second, self._in_world(-slope_x * up, -slope_y * up, up)

    def _in_world(self, x: Scalar, y: Scalar, height: Scalar) -> list[Scalar]:
        """Return components along the axes of ``plan`` and along ``axis`` as a list in world axes."""
        place: list[Scalar] = [0.0, 0.0, 0.0]
        for axis, value in zip((*self.plan, self.axis), (x, y, height), strict=True):
            place[axis] = value
        return place

    def bends(self) -> tuple[Sequence[float], Sequence[float]]:
        """World x and y [m] that a drawing must sample, such as the edges of steps."""
        return (), ()

    def noses(self) -> tuple[Sequence[float], Sequence[float]]:
        """World x and y [m] of straight ridges, which a sole may touch between its corners; none by default.

        Clearances of soles and shapes apply at these ridges. On ground without any they apply at evenly spaced places.
        """
        return (), ()

    def grid(self, xlim: tuple[float, float], ylim: tuple[float, float], n: int) -> tuple[Array, Array, Array]:
        """Sample a patch for drawing.

        Returns
        -------
        x, y : (k,), (m,) arrays
            n even steps over the limits [m], and the ``bends`` between them.
        heights : (k, m) array
            ``heights[i, j]`` = h(x[i], y[j]) [m].
        """
        x, y = (
            np.unique([*np.linspace(*limits, n), *(b for b in bends if limits[0] < b < limits[1])])
            for limits, bends in zip((xlim, ylim), self.bends(), strict=True)
        )
        return x, y, np.asarray(self.height(x[:, None], y[None, :]))

    @cached_property
    def _sampler(self) -> ca.Function:
        """(x, y) -> (h, h_x, h_y)."""
        x, y = ca.SX.sym("x"), ca.SX.sym("y")
        height = ca.densify(ca.SX(self.surface(x, y)))
        slopes = (ca.densify(ca.jacobian(height, s)) for s in (x, y))
        return ca.Function("ground", [x, y], [height, *slopes])
