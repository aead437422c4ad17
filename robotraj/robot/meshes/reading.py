"""Read mesh files: by content from a cache on disk, otherwise in a process under limits.

Pinocchio's reader is a large parser of many formats. A damaged file of 900 bytes can make it crash or take gigabytes.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterable
from pathlib import Path

from robotraj._util.errors import InputError
from robotraj._util.paths import cache_folder
from robotraj._util.system.cached_arrays import keep
from robotraj._util.system.limited import LimitedProcess, NoAnswer
from robotraj._util.system.regular_files import contents
from robotraj.robot.meshes.arrays import MOST_TRIANGLES, MeshArrays

SUFFIXES = (".stl", ".obj", ".dae", ".ply", ".glb")
"""Formats that are read. Each is one file; the materials of OBJ are left out."""
LARGEST = 128 * 10**6
"""Largest size of a file [bytes]."""
SECONDS, PER_BYTE = 3.0, 1e-7
"""Processor time for a file [s], and for each of its bytes."""
VERSION = 1
"""Version of the cached files."""


def read_meshes(paths: Iterable[Path]) -> dict[Path, MeshArrays | str]:
    """Return the arrays of mesh files, or the reason why a file is not read."""
    found: dict[Path, MeshArrays | str] = {}
    with LimitedProcess("robotraj.robot.meshes") as process:
        for path in dict.fromkeys(paths):
            try:
                found[path] = _read(path.suffix.lower(), contents(path, LARGEST, "the file"), process)
            except (InputError, NoAnswer, ValueError) as error:
                found[path] = str(error).rstrip(".")
    return found


def read_mesh_file(path: Path) -> MeshArrays:
    """Return the arrays of one mesh file.

    Raises
    ------
    InputError
        It is not read.
    """
    found = read_meshes([path])[path]
    if isinstance(found, str):
        raise InputError(f"The mesh {str(path)!r} cannot be read: {found}. Export it again as STL, OBJ or COLLADA.")
    return found


def folder() -> Path:
    """Return the folder of the cache."""
    return cache_folder("meshes")


def _read(suffix: str, data: bytes, process: LimitedProcess) -> MeshArrays:
    if suffix not in SUFFIXES:
        raise ValueError(f"the format {suffix or 'without a suffix'} is none of {', '.join(SUFFIXES)}")
    digest = hashlib.sha256(suffix.encode() + b"\n" + data).hexdigest()
    if digest in _REFUSED:
        raise ValueError(_REFUSED[digest])
    kept = folder() / f"{digest[:40]}-{VERSION}.npz"
    try:
        # An entry that is damaged is read from the mesh again.
        return MeshArrays.unpacked(contents(kept, 100 * MOST_TRIANGLES))
    except (InputError, ValueError):
        pass
    try:
        _check_count(suffix, data)
        made = MeshArrays.unpacked(process.ask(suffix.encode() + b"\n" + data, SECONDS + PER_BYTE * len(data)))
    except (NoAnswer, ValueError) as error:
        _REFUSED[digest] = str(error)
        raise
    keep(kept, made.packed())
    return made


def _check_count(suffix: str, data: bytes) -> None:
    """Compare the number of triangles of a binary STL with its size."""
    if suffix == ".stl" and len(data) >= 84 and not data.startswith(b"solid"):
        (count,) = struct.unpack_from("<I", data, 80)
        if 84 + 50 * count > len(data):
            raise ValueError(f"it announces {count} triangles, and ends before them")


_REFUSED: dict[str, str] = {}
"""Reasons by digest, so that a process asks once about a file."""
