"""The ground and the walls that a replay shows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

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
    """A level [m] for the grid, a surface where the ground is not level, and the walls that contacts touch."""

    level: float
    surface: Part | None = None
    walls: tuple[Part, ...] = ()


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
    every = list(dict.fromkeys(_grounds(solution)))
    walls = (_patch(wall, low, high, 0.2 * size)[0] for wall in every if not wall.below)
    view = GroundView(0.0 if low[2] > -0.02 * size else float(low[2] - 0.03 * size))
    ground = next((each for each in every if each.below), None)
    if ground is not None:
        patch, heights = _patch(ground, low, high, 0.4 * size)
        known = heights[np.isfinite(heights)]
        level = float(known.min()) if known.size else 0.0
        uneven = known.size and (known.size < heights.size or np.ptp(known) >= 1e-9)
        view = GroundView(level, patch if uneven else None)
    return replace(view, walls=tuple(wall for wall in walls if wall is not None))


def _grounds(solution: Planned | GaitCycles) -> Iterator[Ground]:
    phases = [result.phase for result in solution.phases]
    for holders in ([c for p in phases for c in p.contacts], [c for p in phases for c in p.constraints]):
        for holder in holders:
            # A constraint held at one end alone wraps the one that has the ground.
            ground = getattr(getattr(holder, "constraint", holder), "ground", None)
            if isinstance(ground, Ground) or callable(ground):
                yield as_ground(ground)


def _patch(
    ground: Ground, low: NDArray[np.float64], high: NDArray[np.float64], reach: float
) -> tuple[Part | None, NDArray[np.float64]]:
    """Return the part of a ground around the robot, with holes where its height is not defined, and its heights."""
    first, second = ground.plan
    # A wall ends at the robot's lowest place, which is the ground.
    limits = [(float(low[i] - (reach if i < 2 else 0.0)), float(high[i] + reach)) for i in (first, second)]
    us, vs, heights = ground.grid(limits[0], limits[1], SAMPLES)
    known = np.isfinite(heights)
    u, v = np.meshgrid(us, vs, indexing="ij")
    vertices = np.empty((u.size, 3))
    vertices[:, first], vertices[:, second] = u.ravel(), v.ravel()
    vertices[:, ground.axis] = np.where(known, heights, 0.0).ravel()
    width = len(vs)
    corner = (np.arange(len(us) - 1)[:, None] * width + np.arange(width - 1)).ravel()
    one = np.column_stack([corner, corner + width, corner + width + 1])
    two = np.column_stack([corner, corner + width + 1, corner + 1])
    faces = np.concatenate([one, two])
    if ground.side < 0.0:
        faces = faces[:, ::-1]
    return weld(vertices, faces[known.ravel()[faces].all(axis=1)]), heights
