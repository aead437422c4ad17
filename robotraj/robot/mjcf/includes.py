"""Files that an MJCF file includes, in its place.

Source: the section *include* of MuJoCo's documentation of its XML format. Paths are relative to the folder of the main
file, and a file is included once. MuJoCo takes sections of one kind for one, in any order. Pinocchio does not, and
reads names before what they stand for.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

from robotraj._util.errors import InputError
from robotraj._util.system.regular_files import contents
from robotraj.robot.loading.packages import is_inside
from robotraj.robot.urdf.lenient import parsed
from robotraj.robot.urdf.xml import MAX_BYTES

MOST = 30
"""Largest number of files that are included."""
FIRST = ("compiler", "option", "size", "default", "asset", "worldbody")
"""Sections that others use, in their order."""
TOPS = ("mujoco", "mujocoinclude")
"""Top elements of files that can be included."""


def with_includes(root: Element, path: Path, folders: Sequence[Path] | None) -> None:
    """Put the elements of included files in place of each ``<include file="...">`` of a file.

    Parameters
    ----------
    root : Element
        The file, which is changed.
    path : Path
        Its place.
    folders : sequence of Path or None
        Folders whose files are read; None for all.

    Raises
    ------
    InputError
        A file lies elsewhere, is included twice, cannot be read, or is no MJCF; or there are too many.
    """
    _expand(root, path, folders, [path.resolve()])
    _in_order(root)


def _expand(element: Element, path: Path, folders: Sequence[Path] | None, known: list[Path]) -> None:
    """Expand the includes below an element."""
    children: list[Element] = []
    for child in element:
        if child.tag == "include":
            other = _read(child.get("file", ""), path, folders, known)
            _expand(other, path, folders, known)
            children += list(other)
        else:
            _expand(child, path, folders, known)
            children.append(child)
    element[:] = children


def _read(name: str, path: Path, folders: Sequence[Path] | None, known: list[Path]) -> Element:
    file = path.parent / name.replace("\\", "/")
    if not name:
        raise InputError(f'{str(path)!r} has an <include> without a file="...".')
    if folders is not None and not is_inside(file, folders):
        raise InputError(
            f"{str(path)!r} includes {str(file)!r}, which lies outside its folder; package_dirs= with that folder or "
            "trust_paths=True reads it."
        )
    place = Path(os.path.realpath(file))
    if place in known:
        raise InputError(f"{str(path)!r} includes {name!r} twice, or itself; MuJoCo refuses that, too.")
    if len(known) > MOST:
        raise InputError(f"{str(path)!r} includes more than {MOST} files.")
    known.append(place)
    try:
        found = parsed(contents(file, MAX_BYTES, "The included file"))
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"The included file {str(file)!r} is no well-formed XML: {error}.") from error
    if found.tag not in TOPS:
        raise InputError(f"The included file {str(file)!r} is no MJCF: its top element is <{found.tag}>.")
    return found


def _in_order(root: Element) -> None:
    """Make one section of all of one kind, and put first what others use; later attributes replace earlier ones."""
    first: dict[str, Element] = {}
    for section in list(root):
        known = first.setdefault(section.tag, section)
        if known is not section:
            known.attrib.update(section.attrib)
            known.extend(list(section))
            root.remove(section)
    root[:] = sorted(root, key=lambda section: FIRST.index(section.tag) if section.tag in FIRST else len(FIRST))
