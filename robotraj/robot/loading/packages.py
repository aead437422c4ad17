"""Find the mesh files a URDF names: package:// and file:// addresses, absolute and relative paths.

Files are read from three places: the folders that the caller names, the folder of the URDF, and its package. A package
is the folder with ``package.xml``, or the one above ``urdf/``, ``robots/`` or ``models/``, as ROS lays it out.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import unquote

MANIFESTS = ("package.xml", "manifest.xml")
"""Files that mark the folder of a package."""
INNER = ("urdf", "urdfs", "robot", "robots", "model", "models", "xacro", "mjcf", "mujoco")
"""Folders of a package that hold descriptions of robots."""
ENDING = "_description"
"""End of the name of a package of descriptions."""
DEPTH = 5
"""Number of folders above a URDF in which its package is looked for."""


def package_of(urdf: Path) -> Path:
    """Return the package of a URDF; its own folder if it has none.

    Home, temporary and top folders are no packages: files of others lie in them.
    """
    folder = urdf.resolve().parent
    above = [folder, *folder.parents][:DEPTH]
    marked = [place for place in above if any(os.path.isfile(place / name) for name in MANIFESTS)]
    within = next((i for i, place in enumerate(above) if place.name.lower() in INNER), None)
    if within is not None:
        while within + 1 < len(above) and above[within + 1].name.lower() in INNER:
            within += 1
        marked += [above[within].parent]
    marked += [place for place in above if place.name.lower().endswith(ENDING)]
    temporary = (os.environ.get("TMPDIR", "/tmp"), "/tmp", "/var/tmp")
    shared = {Path.home().resolve(), Path(folder.anchor), *(Path(place).resolve() for place in temporary)}
    return next((place for place in marked if place not in shared), folder)


def search_folders(urdf: Path, package_dirs: Sequence[str | os.PathLike[str]] = (), trust: bool = False) -> list[Path]:
    """Return the folders to search: the caller's, the URDF's and its package.

    Where paths are trusted, the folders above the URDF's and ROS's package paths follow.
    """
    folder = urdf.resolve().parent
    own = [*(Path(given) for given in package_dirs), folder, package_of(urdf)]
    if not trust:
        return list(dict.fromkeys(own))
    ros = [Path(entry) for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if entry]
    ament = [Path(entry) / "share" for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
    return list(dict.fromkeys([*own, *folder.parents, *ros, *ament]))


def is_inside(path: Path, folders: Sequence[Path]) -> bool:
    """Whether a file, its symbolic links followed, lies in one of the folders."""
    place = Path(os.path.realpath(path))  # a loop of links is no error here, but where it is read
    return any(place.is_relative_to(folder.resolve()) for folder in folders)


def find_mesh(address: str, urdf: Path, folders: Sequence[Path]) -> Path | None:
    """Return the existing file of a mesh address, or None.

    ``package://name/rest`` is ``folder/name/rest``. It is ``folder/rest`` where the folder itself is the package.
    ``file://rest`` without a leading slash is a relative path. ``%20`` is a blank where no name has it as written, and
    case differs where a single name fits: files that Windows and macOS find.
    """
    return next((path for _, _, path in _existing(address, urdf, folders)), None)


def base_of(address: str, urdf: Path, folders: Sequence[Path]) -> Path | None:
    """Return the folder that ``package_dirs=`` must name for a mesh address, if the file exists in ``folders``."""
    for folder, rest, path in _existing(address, urdf, folders):
        plain = not os.path.isabs(rest) and ".." not in Path(rest).parts
        return folder.resolve() if plain else path.resolve().parent
    return None


def _existing(address: str, urdf: Path, folders: Sequence[Path]) -> Iterator[tuple[Path, str, Path]]:
    """Yield the candidates of an address that exist, with their files; those that need no other spelling first."""
    candidates = _candidates(address, urdf, folders)
    yield from ((folder, rest, folder / rest) for folder, rest in candidates if os.path.isfile(folder / rest))
    for folder, rest in candidates:
        path = _respelled(folder, unquote(rest))
        if path is not None:
            yield folder, rest, path


def _respelled(folder: Path, rest: str) -> Path | None:
    """Return the file of a relative path, whatever the case of its names, if one name fits each."""
    path = folder
    for part in Path(rest).parts:
        if not os.path.exists(path / part):
            try:
                alike = [name for name in os.listdir(path) if name.casefold() == part.casefold()]
            except OSError:
                return None
            if len(alike) != 1:
                return None
            part = alike[0]
        path /= part
    return path if os.path.isfile(path) else None


def _candidates(address: str, urdf: Path, folders: Sequence[Path]) -> list[tuple[Path, str]]:
    """Return folders and paths from there that an address may mean, the first one that exists being meant."""
    scheme, separator, rest = address.replace("\\", "/").partition("://")
    if not separator:
        scheme, rest = "", address.replace("\\", "/")
    own = urdf.resolve().parent
    if scheme in ("", "file") and os.path.isabs(rest):
        return [(Path(rest).parent, rest)]
    found = [(folder, rest) for folder in folders]
    if scheme in ("package", "model"):
        inner = rest.partition("/")[2]
        return found + [(folder, inner) for folder in folders if inner]
    return [(own, rest), *found]
