"""Fewer triangles of a large mesh, by clusters of its vertices.

Vertices in one cell of a cubic grid become their mean, and triangles that lose a corner are removed. No vertex moves by
more than the diagonal of a cell. Source: Rossignac and Borrel, Multi-resolution 3D approximations for rendering complex
scenes (1993).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array

MOST = 200_000
"""Largest number of triangles of a mesh that is not simplified, above that of any robot of the catalogue."""
CELLS = 512
"""Cells of the first grid along the longest side of the mesh."""
COARSER = 1.25
"""Least growth of the cells from one grid to the next."""

Faces = NDArray[np.integer]


def simplified(vertices: Array, faces: Faces, most: int = MOST) -> tuple[Array, Faces]:
    """Return a mesh of at most ``most`` triangles; a smaller one is returned unchanged.

    Parameters
    ----------
    vertices : ndarray (n, 3)
        [m].
    faces : ndarray of int (m, 3)
    most : int
        1 or more.
    """
    if len(faces) <= most:
        return vertices, faces
    low, size = vertices.min(axis=0), float(np.ptp(vertices, axis=0).max())
    cell = size / CELLS
    while True:
        corners, triangles = _clustered(vertices, faces, low, cell)
        if len(triangles) <= most or cell > size:
            return corners, triangles
        # Cells on a surface hold triangles in proportion to their area.
        cell *= max(COARSER, float(np.sqrt(len(triangles) / most)))


def _clustered(vertices: Array, faces: Faces, low: Array, cell: float) -> tuple[Array, Faces]:
    places = np.floor((vertices - low) / cell).astype(np.int64)
    wide = int(places.max()) + 1
    keys = (places[:, 0] * wide + places[:, 1]) * wide + places[:, 2]
    _, owner, count = np.unique(keys, return_inverse=True, return_counts=True)
    means = np.stack([np.bincount(owner, vertices[:, axis]) / count for axis in range(3)], axis=1)
    found = owner[faces]
    whole = (found[:, 0] != found[:, 1]) & (found[:, 1] != found[:, 2]) & (found[:, 2] != found[:, 0])
    # Triangles of a cell that fall together are kept once; the order of corners gives the side.
    first = found[whole]
    turned = np.take_along_axis(first, (first.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    return means, np.unique(turned, axis=0)
