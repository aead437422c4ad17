"""Read a URDF file: its XML for what Pinocchio leaves out, and its model."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree import ElementTree

import pinocchio as pin

from robotraj._util.errors import InputError, unknown_name

JOINT_TYPES = {"revolute", "continuous", "prismatic", "floating", "planar", "fixed"}
MOVING = {"revolute", "continuous", "prismatic"}
"""Those along or about one axis."""
NUMBERS = ("limit", "dynamics", "mimic")
"""Tags of a joint whose attributes are numbers (but for the leader's name)."""


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
    _check_joints(path, root)
    _check_links(path, root)
    return root


def _check_joints(path: Path, root: ElementTree.Element) -> None:
    """Report errors in joints that urdfdom would only print to the console."""
    links = [link.get("name", "") for link in root.findall("link")]
    for joint in root.findall("joint"):
        name, kind = joint.get("name"), joint.get("type")
        if kind not in JOINT_TYPES:
            raise InputError(
                f"{str(path)!r}: joint {name!r} has type {kind!r}; a URDF knows {', '.join(sorted(JOINT_TYPES))}."
            )
        for end in ("parent", "child"):
            tag = joint.find(end)
            link = None if tag is None else tag.get("link")
            if link not in links:
                raise unknown_name("link", link, links, f"It is the {end} of joint {name!r} in {str(path)!r}.")
        limit = joint.find("limit")
        if limit is None and kind in ("revolute", "prismatic"):
            raise InputError(
                f"{str(path)!r}: the {kind} joint {name!r} has no <limit>; a URDF asks for its effort and velocity."
            )
        axis = joint.find("axis")
        if axis is not None and kind in MOVING and not _is_direction(axis.get("xyz", "")):
            raise InputError(
                f"{str(path)!r}: joint {name!r} has the axis {axis.get('xyz')!r}; give three numbers, not all zero."
            )
        for field in NUMBERS:
            element = joint.find(field)
            for key, text in {} if element is None else element.attrib.items():
                if key != "joint" and not _is_number(text):
                    raise InputError(f"{str(path)!r}: joint {name!r} has <{field} {key}={text!r}>, which is no number.")


def _check_links(path: Path, root: ElementTree.Element) -> None:
    """Report links with an impossible mass and links without a parent."""
    for link in root.findall("link"):
        mass = link.find("inertial/mass")
        text = "0" if mass is None else mass.get("value", "")
        if not _is_number(text) or not 0 <= float(text) < math.inf:
            raise InputError(
                f"{str(path)!r}: link {link.get('name')!r} has the mass {text!r}; give kilograms, 0 or more."
            )
    held = {tag.get("link") for tag in root.findall("joint/child")}
    free = [name for link in root.findall("link") if (name := link.get("name")) not in held]
    if len(free) > 1:
        raise InputError(
            f"{str(path)!r}: the links {', '.join(map(repr, free))} are no joint's child; a URDF has one such root. "
            "Join the others to it by fixed joints."
        )


def _is_direction(text: str) -> bool:
    parts = text.split()
    return len(parts) == 3 and all(map(_is_number, parts)) and any(float(part) != 0 for part in parts)


def _is_number(text: str) -> bool:
    try:
        return not math.isnan(float(text))
    except ValueError:
        return False


def read_model(path: Path) -> pin.Model:
    """Build Pinocchio's model of the URDF with its root link fixed, mimic joints independent.

    Raises
    ------
    InputError
        Pinocchio cannot read it; the URDF parser prints the reason on the console.
    """
    try:
        return pin.buildModelFromUrdf(str(path))
    except (ValueError, RuntimeError) as error:
        raise InputError(
            f"Pinocchio cannot read the URDF {str(path)!r}: {error} The URDF parser printed why above."
        ) from error
