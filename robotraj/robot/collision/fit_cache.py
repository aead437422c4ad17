"""A cache on disk of the spheres fitted to a shape, keyed by the shape's content."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.paths import cache_folder
from robotraj._util.system.cached_arrays import keep, packed_arrays, unpacked_arrays
from robotraj._util.system.regular_files import contents
from robotraj.robot.collision.enclosing_spheres import MOST, Fit, enclose

VERSION = 2
"""Version of the cached files; increment it when ``enclose`` changes, so that earlier files are not read."""
LARGEST = 10_000
"""Size of a cached file, above that of ``MOST`` spheres [bytes]."""


def fitted(triangles: Array) -> Fit:
    """Return the spheres of triangles (f, 3, 3) [m] from the cache; otherwise fit them and write them there."""
    content = np.ascontiguousarray(triangles).tobytes()
    path = folder() / f"{hashlib.sha256(content).hexdigest()[:40]}-{VERSION}.npz"
    known = _read(path)
    if known is not None and _is_complete(known, triangles):
        return known
    fit = enclose(triangles)
    keep(path, packed_arrays({name: np.asarray(value) for name, value in fit._asdict().items()}))
    return fit


def folder() -> Path:
    """Return the folder of the cache."""
    return cache_folder("spheres")


def _read(path: Path) -> Fit | None:
    try:
        stored = unpacked_arrays(contents(path, LARGEST))
        centres, radii = (np.array(stored[name], dtype=float) for name in ("centres", "radii"))
        return Fit(centres, radii, *(float(stored[name]) for name in Fit._fields[2:]))
    except (InputError, ValueError, TypeError, KeyError):
        return None


def _is_complete(fit: Fit, triangles: Array) -> bool:
    """Whether every corner lies in a sphere; a modified or truncated file fails this check."""
    if fit.centres.ndim != 2 or fit.centres.shape != (len(fit.radii), 3) or not 1 <= len(fit.radii) <= MOST:
        return False
    if not np.isfinite([fit.protrusion, fit.volume, fit.hull_volume]).all():
        return False
    corners = triangles.reshape(-1, 3)
    for centre, radius in zip(fit.centres, fit.radii, strict=True):
        corners = corners[np.linalg.norm(corners - centre, axis=1) > radius + 1e-9]
    return not len(corners)
