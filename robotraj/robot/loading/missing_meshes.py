"""Mesh files that a URDF names and that are not read, told once, by folder, with the call that finds them."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from xml.etree.ElementTree import Element

from robotraj.robot.loading.packages import base_of, find_mesh, is_inside, search_folders

SHOWN = 4
"""Largest number of folders that a sentence names."""


def missing_meshes(root: Element, urdf: Path, package_dirs: Sequence[str | os.PathLike[str]], trust: bool) -> str:
    """Return a sentence on the meshes of visual and collision shapes that are not read; empty if all files exist.

    Parameters
    ----------
    root : Element
        The URDF.
    urdf : Path
    package_dirs : sequence of paths
    trust : bool
        Whether meshes outside the package are read.
    """
    meshes = (root.findall(f"link/{kind}/geometry/mesh") for kind in ("visual", "collision"))
    addresses = dict.fromkeys(mesh.get("filename", "") for every in meshes for mesh in every)
    folders, everywhere = (search_folders(urdf, package_dirs, far) for far in (trust, True))
    missing: Counter[str] = Counter()
    bases: dict[Path | None, str] = {}
    for address in addresses:
        found = find_mesh(address, urdf, folders)
        if found is None or not (trust or is_inside(found, folders)):
            missing[_folder(address)] += 1
            bases.setdefault(base_of(address, urdf, everywhere), address)
    if not missing:
        return ""
    listed = ", ".join(f"{count} in {folder}" for folder, count in missing.most_common(SHOWN))
    more = f" and {len(missing) - SHOWN} more folders" if len(missing) > SHOWN else ""
    known = [str(base) for base in bases if base is not None]
    if None in bases:
        name = bases[None].partition("://")[2].partition("/")[0] if "package://" in bases[None] else ""
        place = f"the folder that contains {name!r}" if name else "their folder"
        cure = f"Name {place} with rt.load(..., package_dirs=...)."
    else:
        paths = repr(known[0]) if len(known) == 1 else repr(known)
        cure = (
            f"They lie outside the URDF's package: rt.load(..., package_dirs={paths}) or trust_paths=True reads them."
        )
    first = next(iter(bases.values()))
    return f"{missing.total()} of {len(addresses)} mesh files are not read: {listed}{more}, the first {first!r}. {cure}"


def _folder(address: str) -> str:
    """Return the folder of an address as it is written."""
    scheme, separator, rest = address.partition("://")
    if separator:
        return f"{scheme}{separator}{PurePosixPath(rest).parent}"
    folder = str(PurePosixPath(address).parent)
    return "the URDF's folder" if folder == "." else folder
