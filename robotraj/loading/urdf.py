"""Read a URDF file: its XML for what Pinocchio leaves out, and its model."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pinocchio as pin

from robotraj.errors import InputError

COUNTS = {"revolute", "continuous", "prismatic", "floating", "planar", "fixed"}


def read_xml(path: Path) -> ElementTree.Element:
    """Parse the file and check that it is a URDF.

    Raises
    ------
    InputError
        The file is missing, a folder, no XML, or XML of another kind (SDF, MJCF, xacro).
    """
    if not path.is_file():
        raise InputError(f"There is no URDF file {str(path)!r}; give the path of an existing file.")
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        raise InputError(f"{str(path)!r} is no well-formed XML: {error}.") from error
    if root.tag != "robot":
        raise InputError(f"{str(path)!r} is no URDF: its root is <{root.tag}>, not <robot>. Convert it to URDF first.")
    if path.suffix == ".xacro" or any("ros.org/wiki/xacro" in element.tag for element in root.iter()):
        raise InputError(f"{str(path)!r} is a xacro macro, not a URDF: expand it with the xacro command first.")
    _check_joint_types(path, root)
    return root


def _check_joint_types(path: Path, root: ElementTree.Element) -> None:
    for joint in root.findall("joint"):
        kind = joint.get("type")
        if kind not in COUNTS:
            raise InputError(
                f"{str(path)!r}: joint {joint.get('name')!r} has type {kind!r}; a URDF knows {', '.join(sorted(COUNTS))}."
            )


def read_model(path: Path) -> pin.Model:
    """Build Pinocchio's model of the URDF with its root link fixed, mimic joints independent.

    Raises
    ------
    InputError
        Pinocchio cannot read it; its own message is passed on.
    """
    try:
        return pin.buildModelFromUrdf(str(path))
    except (ValueError, RuntimeError) as error:
        raise InputError(f"Pinocchio cannot read the URDF {str(path)!r}: {error}") from error
