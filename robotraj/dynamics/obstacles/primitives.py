"""Obstacles as plain arrays, the form that the compiled module reads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.dynamics.obstacles.convex_mesh import ConvexMesh

KINDS = ("sphere", "box", "cylinder", "capsule", "half space", "convex mesh")
"""Kinds of shapes by their number."""
WIDTH = 4
"""Numbers of ``Obstacle.dimensions`` that every shape has room for."""


@dataclass(frozen=True, eq=False)
class Primitives(OneLine):
    """Shapes at one time.

    Attributes
    ----------
    kinds : ndarray of int (n,)
        Index in ``KINDS``.
    positions : ndarray (n, 3)
        Centres in the world, or in the frame that carries the shape [m].
    rotations : ndarray (n, 3, 3)
        From the shape's axes.
    dimensions : ndarray (n, 4)
        ``Obstacle.dimensions``, filled with zeros: radius | half sides | radius, half length | normal, offset.
    frames : tuple of str or None
        Frame that carries each shape, None for the world.
    triangles : tuple of ndarray (f, 3, 3)
        Faces of each shape; (0, 3, 3) where it is no convex mesh.
    labels : tuple of str
        Names for reports; equal kinds without a name are numbered.
    """

    kinds: NDArray[np.int_]
    positions: Array
    rotations: Array
    dimensions: Array
    frames: tuple[str | None, ...]
    triangles: tuple[Array, ...]
    labels: tuple[str, ...]


def primitives_of(obstacles: Sequence[Obstacle], t: float = 0.0) -> Primitives:
    """Return the arrays of obstacles where they are at a time t [s]."""
    poses = [obstacle.pose(t) for obstacle in obstacles]
    dimensions = np.zeros((len(obstacles), WIDTH))
    for row, obstacle in zip(dimensions, obstacles, strict=True):
        row[: len(obstacle.dimensions)] = obstacle.dimensions
    return Primitives(
        np.array([KINDS.index(obstacle.kind) for obstacle in obstacles], dtype=int),
        np.array([position for position, _ in poses]).reshape(-1, 3),
        np.array([rotation for _, rotation in poses]).reshape(-1, 3, 3),
        dimensions,
        tuple(obstacle.frame for obstacle in obstacles),
        tuple(o.triangles if isinstance(o, ConvexMesh) else np.zeros((0, 3, 3)) for o in obstacles),
        labels_of(obstacles),
    )


def labels_of(obstacles: Sequence[Obstacle]) -> tuple[str, ...]:
    """Return the names of obstacles; those that share a label are numbered from 1."""
    given = [obstacle.label for obstacle in obstacles]
    seen: dict[str, int] = {}
    labels = []
    for label in given:
        seen[label] = seen.get(label, 0) + 1
        labels.append(f"{label} {seen[label]}" if given.count(label) > 1 else label)
    return tuple(labels)
