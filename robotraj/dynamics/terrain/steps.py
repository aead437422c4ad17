"""Stairs: level treads joined by smooth ramps, for solvers that need second derivatives."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.variable import Scalar

NOSE = (0.0, 0.15, 0.3)
"""Places of a ramp at which clearances of soles apply, as fractions of its width behind the edge."""


@dataclass(frozen=True)
class Steps(Ground):
    """Level treads along world x: heights[i] between edges[i - 1] and edges[i].

    The twice differentiable ramp r(s) = 6 s^5 - 15 s^4 + 10 s^3 replaces a riser. It has the length ``width`` and lies
    on the lower tread's side of the edge. The upper tread is exact up to its edge. The ground is nowhere below the
    stair, so a motion that clears the ground clears the stair. Footholds on a ramp violate the rows of ``footing``.

    Parameters
    ----------
    edges : sequence of float
        World x of the risers, increasing [m].
    heights : sequence of float
        Heights of the treads [m], one more than edges.
    width : float
        Length of a ramp along x [m].

    Raises
    ------
    InputError
        The numbers of edges and heights do not match, a value is not finite, edges do not increase, or ramps overlap.
    """

    edges: Sequence[float]
    heights: Sequence[float]
    width: float = 0.04

    def __post_init__(self) -> None:
        edges, heights = (tuple(float(v) for v in np.ravel(getattr(self, name))) for name in ("edges", "heights"))
        object.__setattr__(self, "edges", edges)
        object.__setattr__(self, "heights", heights)
        if len(heights) != len(edges) + 1:
            raise InputError(
                f"rt.terrain.Steps has {len(edges)} edges and {len(heights)} heights; give one height more than edges."
            )
        if not np.isfinite([*edges, *heights, self.width]).all() or not self.width > 0:
            raise InputError(f"{self!r}: give finite edges and heights and a positive width, in metres.")
        for (left, right), (a, b) in zip(zip(self.risers, self.risers[1:], strict=False), _pairs(edges), strict=True):
            if not (b > a and right[0] >= left[1]):
                raise InputError(
                    f"rt.terrain.Steps: the edges x = {a:g} m and {b:g} m are too close for ramps of "
                    f"{self.width:g} m; "
                    "increase edges by more than the width."
                )

    @classmethod
    def stairs(cls, start: float, run: float, rise: float, count: int, width: float = 0.04) -> Steps:
        """Return ``count`` equal steps from height 0, the first edge at x = start, treads of depth ``run`` [m]."""
        return cls([start + run * i for i in range(count)], [rise * i for i in range(count + 1)], width)

    @property
    def risers(self) -> tuple[tuple[float, float], ...]:
        """Interval of x [m] of each ramp, on the side of the lower tread."""
        rises = [b >= a for a, b in _pairs(self.heights)]
        return tuple(
            (e - self.width, e) if up else (e, e + self.width) for e, up in zip(self.edges, rises, strict=True)
        )

    @property
    def treads(self) -> tuple[tuple[float, float, float], ...]:
        """Each level tread as (from x, to x, height) [m]; the first and the last are infinite."""
        starts, ends = [-np.inf, *(high for _, high in self.risers)], [*(low for low, _ in self.risers), np.inf]
        return tuple(zip(starts, ends, self.heights, strict=True))

    def surface(self, x: ca.SX, y: ca.SX) -> ca.SX:
        """Height [m]."""
        height = ca.SX(self.heights[0])
        for (low, _), (below, above) in zip(self.risers, _pairs(self.heights), strict=True):
            s = ca.fmin(ca.fmax((x - low) / self.width, 0.0), 1.0)
            height += (above - below) * s**3 * (10.0 + s * (6.0 * s - 15.0))
        return height

    def bends(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return eleven places along each ramp."""
        return [float(x) for riser in self.risers for x in np.linspace(*riser, 11)], ()

    def noses(self) -> tuple[Sequence[float], Sequence[float]]:
        """Return places on the upper part of each ramp, where it is convex, up to its edge."""
        rises = zip(self.risers, _pairs(self.heights), strict=True)
        return [
            high - part * self.width if above >= below else low + part * self.width
            for (low, high), (below, above) in rises
            for part in NOSE
        ], ()

    def footing(self, x: Scalar, y: Scalar, reach: tuple[Scalar, Scalar] = (0.0, 0.0)) -> list[Scalar]:
        """One row [m] per riser: ((x - c)^2 - b^2) / (2 b) >= 0, with c the middle of its ramp, b = width/2 + reach.

        The rows are satisfied by a sole that lies on one tread. Their slope is 1 at the ends of a ramp.
        """
        half = 0.5 * self.width
        near = half + reach[0]
        return [((x - low - half) ** 2 - near * near) / (2.0 * near) for low, _ in self.risers]


def _pairs(values: Sequence[float]) -> list[tuple[float, float]]:
    return list(zip(values, values[1:], strict=False))
