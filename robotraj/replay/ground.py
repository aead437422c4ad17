"""The ground that a replay shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robotraj.replay.part import Part, weld

CELLS = 48
"""A ground that is not level is drawn with so many cells a side."""


@dataclass(frozen=True)
class Ground:
    """A level [m] for the grid, and a surface where a constraint's ground is not level."""

    level: float
    surface: Part | None = None


def ground_of(solution: Any, low: NDArray[Any], high: NDArray[Any]) -> Ground:
    """Find the ground of the first constraint that has one; else z = 0, or below the robot if it dips deeper.

    Parameters
    ----------
    solution : Solution
    low, high : (3,)
        Box [m] around the robot over its motion.
    """
    size = float(np.linalg.norm(high - low))
    for result in solution.phases:
        for constraint in result.phase.constraints:
            # A constraint held at one end alone wraps the one that has the ground.
            ground = getattr(getattr(constraint, "constraint", constraint), "ground", None)
            if ground is not None:
                return _drawn(getattr(ground, "height", ground), low, high, size)
    return Ground(0.0 if low[2] > -0.02 * size else float(low[2] - 0.03 * size))


def _drawn(height: Any, low: NDArray[Any], high: NDArray[Any], size: float) -> Ground:
    """Sample a height function h(x, y) [m] around the robot."""
    reach = 0.4 * size
    xs = np.linspace(low[0] - reach, high[0] + reach, CELLS + 1)
    ys = np.linspace(low[1] - reach, high[1] + reach, CELLS + 1)
    z = np.array([[float(height(float(x), float(y))) for y in ys] for x in xs])
    if np.ptp(z) < 1e-9:
        return Ground(float(z[0, 0]))
    x, y = np.meshgrid(xs, ys, indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    corner = (np.arange(CELLS)[:, None] * (CELLS + 1) + np.arange(CELLS)).ravel()
    one = np.column_stack([corner, corner + CELLS + 1, corner + CELLS + 2])
    two = np.column_stack([corner, corner + CELLS + 2, corner + 1])
    return Ground(float(z.min()), weld(vertices, np.concatenate([one, two])))
