"""A piece of triangulated surface in one colour, stored compactly in a page."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from robotraj._util.printing import OneLine
from robotraj._util.system.cached_arrays import packed_arrays, unpacked_arrays
from robotraj._util.values import dataclass

Color = tuple[float, float, float, float]
CREASE = np.radians(40.0)
"""Angle between faces [rad] above which their edge is sharp, so that they have their own normals."""


@dataclass(frozen=True)
class Part(OneLine):
    """Triangles in one colour.

    Attributes
    ----------
    vertices : (n, 3) float32
        Positions [m] in the frame of the mesh file or shape.
    faces : (m, 3) uint16 or uint32
        Vertex indices, counter-clockwise seen from outside.
    color : tuple of 4 floats, optional
        Red, green, blue, opacity in [0, 1]; None where the file names no material.
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.integer]
    color: Color | None = None


def weld(vertices: NDArray[np.floating], faces: NDArray[np.integer], color: Color | None = None) -> Part | None:
    """Merge equal vertices, split them again along creases, and round positions so that they compress.

    Positions are rounded to a power of two near 1e-5 of the largest extent, far below a pixel. A float32 then has
    many zero bits, which gzip compresses. Faces without area are dropped.

    Returns
    -------
    Part or None
        None if no face has an area.
    """
    if len(faces) == 0:
        return None
    used = np.asarray(vertices, dtype=float)[np.asarray(faces, dtype=np.int64).ravel()]
    extent = float(np.ptp(used, axis=0).max())
    if not extent > 0.0:
        return None
    step = 2.0 ** np.floor(np.log2(extent * 1e-5))
    grid, corner = np.unique(np.rint(used / step).astype(np.int64), axis=0, return_inverse=True)
    triangles = corner.reshape(-1, 3)
    positions = grid * step
    edges = positions[triangles[:, [1, 2]]] - positions[triangles[:, [0]]]
    normals = np.cross(edges[:, 0], edges[:, 1])
    area = np.linalg.norm(normals, axis=1)
    keep = area > 0.0
    if not keep.any():
        return None
    triangles, normals = triangles[keep], normals[keep] / area[keep, None]
    labels = _smooth_corners(triangles, normals, len(grid))
    _, first, index = np.unique(labels, return_index=True, return_inverse=True)
    kind = np.uint16 if len(first) <= np.iinfo(np.uint16).max else np.uint32
    return Part(positions[triangles.ravel()[first]].astype(np.float32), index.reshape(-1, 3).astype(kind), color)


def _smooth_corners(triangles: NDArray[np.integer], normals: NDArray[np.floating], count: int) -> NDArray[np.integer]:
    """Label the 3 m face corners so that two share a label when a smooth surface joins them at one vertex."""
    corners = np.arange(triangles.size).reshape(-1, 3)
    start, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    flat = triangles.ravel()
    low, high = np.minimum(flat[start], flat[end]), np.maximum(flat[start], flat[end])
    key = low.astype(np.int64) * count + high
    order = np.argsort(key, kind="stable")
    same = key[order][1:] == key[order][:-1]
    one, two = order[:-1][same], order[1:][same]
    smooth = np.einsum("ij,ij->i", normals[one // 3], normals[two // 3]) > np.cos(CREASE)
    one, two = one[smooth], two[smooth]
    crossed = flat[start[one]] != flat[start[two]]
    ends = (np.where(crossed, end[two], start[two]), np.where(crossed, start[two], end[two]))
    rows, columns = np.concatenate([start[one], end[one]]), np.concatenate(ends)
    graph = coo_array((np.ones(len(rows), dtype=bool), (rows, columns)), shape=(flat.size, flat.size))
    labels: NDArray[np.integer] = connected_components(graph, directed=False)[1]
    return labels


def merge_by_color(
    pieces: Iterable[tuple[NDArray[np.floating], NDArray[np.integer], Color | None]],
) -> tuple[Part, ...]:
    """Join pieces (vertices, faces, colour) that share a colour, and weld each group."""
    groups: dict[Color | None, list[tuple[NDArray[np.floating], NDArray[np.integer]]]] = {}
    for vertices, faces, color in pieces:
        groups.setdefault(color, []).append((np.asarray(vertices), np.asarray(faces)))
    parts = []
    for color, members in groups.items():
        offsets = np.cumsum([0, *(len(vertices) for vertices, _ in members)])
        faces = np.concatenate([f + o for (_, f), o in zip(members, offsets, strict=False)])
        part = weld(np.concatenate([vertices for vertices, _ in members]), faces, color)
        if part is not None:
            parts.append(part)
    return tuple(parts)


def packed(parts: Iterable[Part], alone: bool) -> bytes:
    """Return parts as the bytes of an npz file; ``alone`` states that they follow from one file."""
    arrays: dict[str, NDArray[np.generic]] = {"alone": np.array(alone)}
    for i, part in enumerate(parts):
        arrays |= {f"vertices{i}": part.vertices, f"faces{i}": part.faces, f"color{i}": np.array(part.color or ())}
    return packed_arrays(arrays)


def unpacked(data: bytes) -> tuple[tuple[Part, ...], bool]:
    """Read what ``packed`` wrote.

    Raises
    ------
    ValueError
        The bytes are damaged, or a number is not finite.
    """
    arrays = unpacked_arrays(data)
    try:
        parts = tuple(
            _checked(arrays[f"vertices{i}"], arrays[f"faces{i}"], arrays[f"color{i}"]) for i in range(len(arrays) // 3)
        )
        return parts, bool(arrays["alone"])
    except KeyError as error:
        raise ValueError(f"damaged: there is no {error}") from error


def _checked(vertices: NDArray[Any], faces: NDArray[Any], color: NDArray[Any]) -> Part:
    right = vertices.dtype == np.float32 and faces.dtype in (np.uint16, np.uint32) and color.shape in ((0,), (4,))
    if not right or vertices.shape[1:] != (3,) or faces.shape[1:] != (3,) or not faces.size:
        raise ValueError("damaged: a part has other arrays")
    if not np.isfinite(vertices).all() or faces.max() >= len(vertices):
        raise ValueError("a vertex is not finite, or does not exist")
    shade: Color | None = tuple(float(c) for c in color) if color.size else None  # type: ignore[assignment]
    return Part(vertices, faces, shade)
