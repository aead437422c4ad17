"""Find the mesh files a URDF names: package:// and file:// addresses, absolute and relative paths."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path


def search_folders(urdf: Path, package_dirs: Sequence[str | os.PathLike[str]] = ()) -> Iterator[Path]:
    """Yield the folders to look in: the caller's, the URDF's and those above it, then ROS's package paths."""
    for given in package_dirs:
        yield Path(given).expanduser()
    folder = urdf.resolve().parent
    yield folder
    yield from folder.parents
    for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep):
        if entry:
            yield Path(entry)
    for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if entry:
            yield Path(entry) / "share"


def find_mesh(address: str, urdf: Path, folders: Sequence[Path]) -> Path | None:
    """Resolve one mesh address to an existing file, or None.

    ``package://name/rest`` is ``folder/name/rest``; where the folder itself is the package (its own name, or
    its package.xml, is all that ``name`` stands for), ``folder/rest`` is taken too.
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
