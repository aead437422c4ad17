"""The ground that a replay shows."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.function import as_ground
from robotraj.replay_page.scene.part import Part, weld
from robotraj.solution.cycles.gait_cycles import GaitCycles
from robotraj.solution.planned import Planned

SAMPLES = 49
"""Number of samples along each side of a ground that is not level; its edges are added."""


@dataclass(frozen=True)
class GroundView(OneLine):
    """A level [m] for the grid, and a surface where the ground is not level."""

    level: float
    surface: Part | None = None


def ground_of(solution: Planned | GaitCycles, low: NDArray[np.float64], high: NDArray[np.float64]) -> GroundView:
    """Return the ground of the robot's contacts, else of a clearance constraint, over the extent of the motion.

    Without either it is z = 0, or a level below the robot if it moves lower.

    Parameters
    ----------
    solution : Solution
    low, high : (3,)
        Box [m] around the robot over its motion.
    """
    size = float(np.linalg.norm(high - low))
    ground = next(_grounds(solution), None)
    if ground is not None:
        return _drawn(ground, low, high, 0.4 * size)
    return GroundView(0.0 if low[2] > -0.02 * size else float(low[2] - 0.03 * size))


def _grounds(solution: Planned | GaitCycles) -> Iterator[Ground]:
    phases = [result.phase for result in solution.phases]
    for holders in ([c for p in phases for c in p.contacts], [c for p in phases for c in p.constraints]):
        for holder in holders:
            # A constraint held at one end alone wraps the one that has the ground.
            ground = getattr(getattr(holder, "constraint", holder), "ground", None)
            if isinstance(ground, Ground) or callable(ground):
                yield as_ground(ground)


def _drawn(ground: Ground, low: NDArray[np.float64], high: NDArray[np.float64], reach: float) -> GroundView:
    """Sample the ground around the robot; it has holes where its height is not defined."""
    xlim, ylim = ((float(low[i] - reach), float(high[i] + reach)) for i in (0, 1))
    xs, ys, z = ground.grid(xlim, ylim, SAMPLES)
    known = np.isfinite(z)
    level = float(z[known].min()) if known.any() else 0.0
    if not known.any() or (known.all() and np.ptp(z) < 1e-9):
        return GroundView(level)
    x, y = np.meshgrid(xs, ys, indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.where(known, z, level).ravel()])
    width = len(ys)
    corner = (np.arange(len(xs) - 1)[:, None] * width + np.arange(width - 1)).ravel()
    one = np.column_stack([corner, corner + width, corner + width + 1])
    two = np.column_stack([corner, corner + width + 1, corner + 1])
    faces = np.concatenate([one, two])
    return GroundView(level, weld(vertices, faces[known.ravel()[faces].all(axis=1)]))
