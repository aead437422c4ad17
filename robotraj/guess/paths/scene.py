"""A robot among obstacles at rest for geometric planners: configurations, distances and straight motions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass

if TYPE_CHECKING:
    from robotraj.guess.paths.moving_scene import MovingScene
    from robotraj.native._native import SphereTree


RESOLUTION = 1e-3
"""Distance beyond the margin [m] below which a motion counts as blocked; at most half of that at the ends."""


@dataclass(frozen=True, eq=False)
class PathScene:
    """A robot on a fixed base among obstacles at rest.

    Attributes
    ----------
    tree : SphereTree
        The robot's spheres and the obstacles, compiled.
    lower, upper : ndarray (nq,)
        Bounds of the positions; infinite ones of joints without limits.
    speeds : ndarray (nq,)
        Largest speeds of the joints, by which motions of different joints are compared.
    margin : float
        Distance to keep [m].
    moving : MovingScene or None
        Moving obstacles, which ``tree`` does not contain.
    """

    tree: SphereTree
    lower: Array
    upper: Array
    speeds: Array
    margin: float
    moving: MovingScene | None = None

    def clearance(self, *configurations: Array) -> float:
        """Return the least distance [m] in some configurations (nq,), less the margin; negative in a collision."""
        return float(np.min(self.tree.clearances(np.concatenate(configurations)))) - self.margin

    def resolution(self, start: Array, end: Array) -> float:
        """Return the least distance beyond the margin of a motion between two configurations [m]."""
        return float(min(RESOLUTION, 0.5 * max(self.clearance(start, end), 0.0)))

    def is_free(self, first: Array, last: Array) -> bool:
        """Whether the straight motion between two configurations (nq,) keeps the margin, proved without sampling."""
        return self.tree.motion_free(first, last, self.margin, self.resolution(first, last))
