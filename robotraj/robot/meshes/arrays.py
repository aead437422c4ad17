"""Vertices and triangles of a mesh, and coal's model of them."""

from __future__ import annotations

import coal
import numpy as np
import numpy.typing as npt

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.system.cached_arrays import packed_arrays, unpacked_arrays
from robotraj._util.values import dataclass
from robotraj.robot.meshes.convex_hull import convex_hull

MOST_TRIANGLES = 1_000_000
FARTHEST = 1e6
"""Largest coordinate of a vertex, in the unit of the file."""


@dataclass(frozen=True, eq=False)
class MeshArrays(OneLine):
    """A mesh as plain arrays.

    Parameters
    ----------
    vertices : ndarray (n, 3)
        In the unit of the file.
    triangles : ndarray of int32 (m, 3)
        Numbers of the corners.

    Raises
    ------
    ValueError
        There is no triangle or there are too many, a number is not finite or very large, or a corner does not exist.
    """

    vertices: Array
    triangles: npt.NDArray[np.int32]

    def __post_init__(self) -> None:
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3 or self.vertices.dtype != np.float64:
            raise ValueError("it has no vertices")
        if self.triangles.ndim != 2 or self.triangles.shape[1] != 3 or self.triangles.dtype != np.int32:
            raise ValueError("it has no triangles")
        if not 1 <= len(self.triangles) <= MOST_TRIANGLES:
            raise ValueError(f"it has {len(self.triangles)} triangles; 1 to {MOST_TRIANGLES} are read")
        if not np.isfinite(self.vertices).all():
            raise ValueError("a vertex is not finite")
        if np.abs(self.vertices).max() > FARTHEST:
            raise ValueError(f"a vertex has a coordinate above {FARTHEST:g}")
        if self.triangles.min() < 0 or self.triangles.max() >= len(self.vertices):
            raise ValueError("a triangle has a corner that does not exist")

    def packed(self) -> bytes:
        """Return both arrays as the bytes of an npz file."""
        return packed_arrays({"vertices": self.vertices, "triangles": self.triangles})

    @classmethod
    def unpacked(cls, data: bytes) -> MeshArrays:
        """Read what ``packed`` wrote.

        Raises
        ------
        ValueError
            The bytes are damaged.
        """
        stored = unpacked_arrays(data)
        if not {"vertices", "triangles"} <= stored.keys():
            raise ValueError("damaged: it has other arrays")
        return cls(stored["vertices"], stored["triangles"])  # type: ignore[arg-type]

    def shape(self, scale: Array) -> coal.BVHModelOBBRSS:
        """Return coal's model of the mesh, scaled along the axes, as its own loader builds it."""
        model = coal.BVHModelOBBRSS()
        model.beginModel(len(self.triangles), len(self.vertices))
        model.addVertices(self.vertices * scale)
        model.addTriangles(self.triangles.astype(np.int64))
        model.endModel()
        model.computeLocalAABB()
        return model

    def hull(self, scale: Array) -> coal.CollisionGeometry:
        """Return the convex hull of the scaled mesh."""
        return convex_hull(self.vertices * scale, "Qt")


def distinct(points: Array) -> tuple[npt.NDArray[np.int_], npt.NDArray[np.int_]]:
    """Return which of points (n, 3) are the first of equal ones (m,), in the order of their values.

    The second array (n,) is the place of each point among them.
    """
    order, place = np.lexsort(points.T[::-1]), np.zeros(len(points), dtype=int)
    if not len(points):
        return order, place
    differs = np.append(True, np.any(np.diff(points[order], axis=0) != 0.0, axis=1))
    place[order] = np.cumsum(differs) - 1
    return order[differs], place
