"""Stairs: level treads, with risers smoothed so that Newton's method can cross them."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.variable import Scalar


@dataclass(frozen=True)
class Steps(Ground):
    """Level treads along world x: heights[i] between edges[i - 1] and edges[i].

    A riser is replaced by the ramp r(s) = 6 s^5 - 15 s^4 + 10 s^3, twice differentiable, over ``width`` beside its edge
    and on the lower tread's side: treads are exact up to their edges, and this ground never lies below the stair it
    stands for, so that what clears it clears the stair. A foot's point may not stand on a ramp: ``footing``.

    Parameters
    ----------
    edges : sequence of float
        Where the height changes, increasing, in world x [m].
    heights : sequence of float
        Of the treads [m]: one more than there are edges.
    width : float
        Of a ramp, along x [m].

    Raises
    ------
    InputError
        Lengths do not fit, a value is not finite, edges do not increase, or ramps overlap.
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
                f"rt.terrain.Steps has {len(edges)} edges and {len(heights)} heights; it needs one height more "
                f"than edges."
            )
        if not np.isfinite([*edges, *heights, self.width]).all() or not self.width > 0:
            raise InputError(f"{self!r}: edges, heights and a width above 0 are finite numbers in metres.")
        for (left, right), (a, b) in zip(zip(self.risers, self.risers[1:], strict=False), _pairs(edges), strict=True):
            if not (b > a and right[0] >= left[1]):
                raise InputError(
                    f"rt.terrain.Steps: the edges x = {a:g} m and {b:g} m do not leave room for ramps of "
                    f"{self.width:g} m; "
                    "edges must increase by more than the width."
                )

    @classmethod
    def stairs(cls, start: float, run: float, rise: float, count: int, width: float = 0.04) -> Steps:
        """Write stairs of ``count`` equal steps from level 0: the first edge at x = start, treads ``run`` deep [m]."""
        return cls([start + run * i for i in range(count)], [rise * i for i in range(count + 1)], width)

    @property
    def risers(self) -> tuple[tuple[float, float], ...]:
        """Interval of x [m] that each ramp covers, on the side of its lower tread."""
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
        """Ten pieces for each ramp."""
        return [float(x) for riser in self.risers for x in np.linspace(*riser, 11)], ()

    def footing(self, x: Scalar, y: Scalar, reach: tuple[Scalar, Scalar] = (0.0, 0.0)) -> list[Scalar]:
        """One row [m] per riser: ((x - c)^2 - b^2) / (2 b) >= 0, with c the middle of its ramp, b = width/2 + reach.

        So a sole lies on one tread, on either side of each ramp; beside it the row grows as the distance does.
        """
        half = 0.5 * self.width
        near = half + reach[0]
        return [((x - low - half) ** 2 - near * near) / (2.0 * near) for low, _ in self.risers]


def _pairs(values: Sequence[float]) -> list[tuple[float, float]]:
    return list(zip(values, values[1:], strict=False))
