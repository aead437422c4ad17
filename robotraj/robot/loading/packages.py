"""Find the mesh files a URDF names: package:// and file:// addresses, absolute and relative paths."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path


def search_folders(urdf: Path, package_dirs: Sequence[str | os.PathLike[str]] = (), trust: bool = False) -> list[Path]:
    """Return the folders to search: the caller's and the URDF's.

    Where paths are trusted, the folders above the URDF's and ROS's package paths follow.
    """
    folder = urdf.resolve().parent
    own = [*(Path(given).expanduser() for given in package_dirs), folder]
    if not trust:
        return own
    ros = [Path(entry) for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if entry]
    ament = [Path(entry) / "share" for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
    return [*own, *folder.parents, *ros, *ament]


def is_inside(path: Path, folders: Sequence[Path]) -> bool:
    """Whether a file, its symbolic links followed, lies in one of the folders."""
    place = path.resolve()
    return any(place.is_relative_to(folder.resolve()) for folder in folders)


def find_mesh(address: str, urdf: Path, folders: Sequence[Path]) -> Path | None:
    """Return the existing file of a mesh address, or None.

    ``package://name/rest`` is ``folder/name/rest``. It is ``folder/rest`` where the folder itself is the package.
    """
    scheme, separator, rest = address.partition("://")
    if not separator:
        scheme, rest = "", address
    if scheme == "file" or (not scheme and os.path.isabs(rest)):
        path = Path(rest)
        return path if path.is_file() else None
    candidates = [folder / rest for folder in folders]
    if scheme in ("package", "model"):
        inner = rest.partition("/")[2]
        candidates += [folder / inner for folder in folders if inner]
    else:
        candidates.insert(0, urdf.resolve().parent / rest)
    return next((path for path in candidates if path.is_file()), None)
