"""Read a URDF file: its XML, with the elements that Pinocchio ignores, and its model."""

from __future__ import annotations

import os
from collections.abc import Sequence
from copy import deepcopy
from pathlib import Path
from xml.etree import ElementTree

import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj._util.system.regular_files import contents, near_files
from robotraj.robot.macros.expansion import expanded
from robotraj.robot.urdf.lenient import parsed, without_definitions

MAX_BYTES = 10_000_000
"""Size of the largest file that is read: fifty times that of a humanoid's URDF."""

MAX_TEXT = 4_000
"""Length of the longest attribute: the longest path of a file."""

UNLIMITED = "1e30"
"""Number that stands for no limit."""
INFINITE = {f"{sign}{text}": f"{sign.strip('+')}{UNLIMITED}" for sign in ("", "+", "-") for text in ("inf", "infinity")}
"""How no limit is written; the parser behind Pinocchio takes no infinity."""
ENDLESS = {"effort": "+", "velocity": "+", "lower": "+-", "upper": "+-"}
"""Limits that may be infinite, with their signs."""

MAX_ATTRIBUTES = 100
"""Largest number of attributes of an element; an <inertia> has six. The parser compares each with all others."""


def read_xml(path: Path, kind: str = "URDF", folders: Sequence[Path] = (), trust: bool = False) -> ElementTree.Element:
    """Return the root element of a URDF or SRDF file, whose contents are not checked.

    Blanks around the texts of attributes are removed. Macros of xacro are expanded.

    Parameters
    ----------
    path : Path
    kind : str
        For messages.
    folders : sequence of Path
        Folders whose files macros may include.
    trust : bool
        Whether they may include any other.

    Raises
    ------
    InputError
        The file is missing, too large, no XML, XML of another kind (SDF, MJCF), or has too long or too many
        attributes. Macros cannot be expanded.
    """
    if not os.path.isfile(path):
        raise InputError(f"There is no {kind} file {str(path)!r}.{near_files(path) or ' Give the path of a file.'}")
    data = contents(path, MAX_BYTES, f"The {kind} file")
    root = _parsed(data, path)
    source = path.suffix == ".xacro" or root.find("link") is None
    if without_definitions(root, source):
        root = _parsed(expanded(path, folders, trust, MAX_BYTES), path)
    for element in root.iter():
        attributes = element.attrib
        if len(attributes) > MAX_ATTRIBUTES:
            raise InputError(
                f"{str(path)!r}: <{element.tag[:80]}> has {len(attributes)} attributes; at most {MAX_ATTRIBUTES} can "
                "be read."
            )
        for key, text in attributes.items():
            if len(text) > MAX_TEXT:
                raise InputError(
                    f"{str(path)!r}: the attribute {key[:80]!r} of <{element.tag[:80]}> has {len(text)} characters; at "
                    f"most {MAX_TEXT} can be read."
                )
            # The parser behind Pinocchio replaces a number that a blank follows by 0, or refuses the file.
            attributes[key] = text.strip()
            number = INFINITE.get(text.strip().lower()) if element.tag == "limit" else None
            if number is not None and ("-" if number.startswith("-") else "+") in ENDLESS.get(key, ""):
                attributes[key] = number
    if root.tag != "robot":
        raise InputError(
            f"{str(path)!r} is no {kind}: its root is <{root.tag}>, not <robot>. Convert it to {kind} first."
        )
    root.attrib.setdefault("name", path.stem)  # Pinocchio alone needs one
    return root


def _parsed(data: bytes, path: Path) -> ElementTree.Element:
    try:
        return parsed(data)
    except ValueError as error:
        saved = path.suffix.lower() == ".npz"
        advice = "A saved solution is read by rt.load_solution(path)." if saved else "Correct the file."
        raise InputError(f"{str(path)!r} is no well-formed XML: {error}. {advice}") from error


def read_model(root: ElementTree.Element, path: Path) -> pin.Model:
    """Build Pinocchio's model of a URDF with its root link fixed, mimic joints independent; ``path`` is for messages.

    Raises
    ------
    InputError
        Pinocchio cannot read it; the URDF parser prints the reason on the console.
    """
    bare = deepcopy(root)  # the parser prints what it finds wrong with shapes, which are read elsewhere
    for link in bare.findall("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    try:
        return pin.buildModelFromXML(ElementTree.tostring(bare, encoding="unicode"))
    except (ValueError, RuntimeError) as error:
        raise InputError(
            f"Pinocchio cannot read the URDF {str(path)!r}: {error} The URDF parser printed why above."
        ) from error
