"""Convex hulls of points as obstacles."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.paths import input_path
from robotraj._util.values import dataclass
from robotraj.dynamics.obstacles.base import ORIGIN, UPRIGHT, FixedOrMoving, Obstacle
from robotraj.robot.collision.tessellation import hull_triangles
from robotraj.robot.meshes.reading import read_mesh_file

MOST_VERTICES = 200
"""Vertices of a hull above which its distance takes too long to evaluate."""


@dataclass(frozen=True)
class ConvexMesh(Obstacle):
    """The convex hull of points. Compose a body that is not convex of several hulls.

    Parameters
    ----------
    vertices : (n, 3) array
        Points in the shape's axes [m]; those inside the hull are dropped. ``ConvexMesh.from_file`` reads them.
    position, quaternion, frame, name
        See ``Obstacle``.

    Raises
    ------
    InputError
        Fewer than four points, points in one plane, or a hull of more than 200 vertices.
    """

    vertices: Array
    position: FixedOrMoving = ORIGIN
    quaternion: FixedOrMoving = UPRIGHT
    frame: str | None = None
    name: str = ""

    kind: ClassVar[str] = "convex mesh"

    def __post_init__(self) -> None:
        super().__post_init__()
        try:
            points = np.array(self.vertices, dtype=float)
        except (TypeError, ValueError):
            raise InputError(
                f"{self.label}: vertices are no numbers; give (n, 3) in metres. ConvexMesh.from_file reads a file."
            ) from None
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
            raise InputError(f"{self.label}: vertices have shape {points.shape}; give finite numbers (n, 3) in metres.")
        kept = points[_hull(points, self.label)]
        if len(kept) > MOST_VERTICES:
            raise InputError(
                f"{self.label}: its hull has {len(kept)} vertices, above {MOST_VERTICES}; simplify the mesh."
            )
        kept.setflags(write=False)
        object.__setattr__(self, "vertices", kept)

    @classmethod
    def from_file(
        cls,
        path: str | os.PathLike[str],
        scale: float | Sequence[float] = 1.0,
        position: FixedOrMoving = ORIGIN,
        quaternion: FixedOrMoving = UPRIGHT,
        frame: str | None = None,
        name: str = "",
    ) -> ConvexMesh:
        """Read the vertices of an STL, OBJ or COLLADA file, scaled along the axes.

        Raises
        ------
        InputError
            The file cannot be read.
        """
        file = input_path(path, "The mesh")
        vertices = read_mesh_file(file).vertices * np.asarray(scale, dtype=float)
        return cls(vertices, position, quaternion, frame, name or file.stem)

    @property
    def dimensions(self) -> tuple[float, ...]:
        """Empty; the vertices define the shape."""
        return ()

    @cached_property
    def triangles(self) -> Array:
        """Corners of the faces, counter-clockwise from outside, (f, 3, 3) [m]."""
        return hull_triangles(self.vertices)

    @cached_property
    def planes(self) -> Array:
        """Outward unit normals and offsets of the faces, normal . x <= offset inside, (f, 4)."""
        from scipy.spatial import ConvexHull

        found = np.unique(np.round(ConvexHull(self.vertices).equations, 12), axis=0)
        return np.column_stack([found[:, :3], -found[:, 3]])

    def distance(self, points: Array) -> Array:
        """Exact signed distance (m,) [m]; inside, the distance from the nearest face."""
        inside = (points @ self.planes[:, :3].T - self.planes[:, 3]).max(axis=1)
        out = np.flatnonzero(inside > 0.0)
        if out.size:
            squares = [_square_from_triangle(points[out], triangle) for triangle in self.triangles]
            inside[out] = np.sqrt(np.min(squares, axis=0))
        return np.asarray(inside)

    @property
    def reach(self) -> float:
        """Largest distance of a vertex from the origin [m]."""
        return float(np.linalg.norm(self.vertices, axis=1).max())


def _hull(points: Array, label: str) -> Array:
    """Return the indices of the vertices of the convex hull."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return np.sort(ConvexHull(points).vertices)
    except (QhullError, ValueError) as error:
        raise InputError(
            f"{label}: {len(points)} vertices span no volume; give four or more that do not lie in one plane."
        ) from error


def _square_from_triangle(points: Array, triangle: Array) -> Array:
    """Squared distances (m,) of points (m, 3) from a triangle."""
    a, b, c = triangle
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal)
    edges = [(a, b), (b, c), (c, a)]
    over = np.all([(points - p) @ np.cross(normal, q - p) >= 0.0 for p, q in edges], axis=0)
    squares = [_square_from_segment(points, p, q) for p, q in edges]
    return np.where(over, ((points - a) @ normal) ** 2, np.min(squares, axis=0))


def _square_from_segment(points: Array, start: Array, end: Array) -> Array:
    along = end - start
    share = np.clip((points - start) @ along / (along @ along), 0.0, 1.0)
    return np.asarray(((points - start - share[:, None] * along) ** 2).sum(axis=1))
