"""Numbers and names of an MJCF file: Pinocchio's reader puts memory that it never wrote in the place of no number."""

from __future__ import annotations

import math
from collections import Counter
from xml.etree.ElementTree import Element

from robotraj._util.errors import InputError
from robotraj.robot.mjcf.defaults import ACTUATORS, placed
from robotraj.robot.urdf.xml import MAX_TEXT

ELEMENTS = ("body", "frame", "joint", "freejoint", "geom", "inertial", "mesh", "site", *ACTUATORS)
LEAST = {
    **dict.fromkeys(("pos", "euler", "zaxis", "axis", "scale", "refpos", "diaginertia"), 3),
    **dict.fromkeys(("quat", "axisangle", "refquat"), 4),
    **dict.fromkeys(("xyaxes", "fromto", "fullinertia"), 6),
    **dict.fromkeys(("range", "forcerange", "ctrlrange"), 2),
    **dict.fromkeys(("size", "mass", "density", "armature", "damping", "frictionloss", "ref", "springref"), 1),
    **dict.fromkeys(("stiffness", "gear", "vertex"), 1),
}
"""Attributes of these elements that hold numbers, and the least count of them that is read."""
SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}
"""Least count of sizes of a shape; where ``fromto`` gives its ends, one."""
LARGEST = 1e12
"""Largest number: squares and products of larger ones have no use and may overflow."""
MOST_ATTRIBUTES = 60
"""Largest number of attributes of an element: those of a class are copied to all its elements."""
WORLD = "universe"
NOT_NEGATIVE = ("size", "mass", "density", "diaginertia", "armature", "damping", "frictionloss", "stiffness")


def check_numbers(file: str, root: Element) -> None:
    """Refuse what is no number where one belongs, too few and impossible numbers, and endless texts.

    Raises
    ------
    InputError
        Names the element, the attribute and the text.
    """
    for element in root.iter():
        if len(element.attrib) > MOST_ATTRIBUTES:
            raise InputError(
                f"{file}: a <{element.tag[:40]}> has {len(element.attrib)} attributes; {MOST_ATTRIBUTES} are read."
            )
        for key, text in element.attrib.items():
            where = f"{file}: {key}={text[:60]!r} of <{element.tag[:40]}> {element.get('name', '')[:60]!r}"
            if len(text) > MAX_TEXT and element.tag in ELEMENTS and element.tag != "mesh":
                raise InputError(f"{where} has {len(text)} characters; at most {MAX_TEXT} are read.")
            if element.tag not in ELEMENTS or key not in LEAST:
                continue
            numbers = [_number(word) for word in text.split()]
            if len(numbers) < LEAST[key]:
                raise InputError(f"{where} has {len(numbers)} numbers; give {LEAST[key]}.")
            if not all(abs(number) <= LARGEST for number in numbers):
                raise InputError(f"{where} is not finite numbers up to {LARGEST:g}; correct the file.")
            if key in NOT_NEGATIVE and any(number < 0.0 for number in numbers):
                raise InputError(f"{where} is negative; correct the file.")
            if key == "axis" and not math.hypot(*numbers) > 0.0:
                raise InputError(f"{where} is no direction; give three numbers, such as '0 0 1'.")
    for geom in placed(root, "geom"):
        kind, sizes = geom.get("type", "sphere"), len(geom.get("size", "").split())
        least = SIZES.get(kind, 0) if "mesh" not in geom else 0
        if sizes < (min(least, 1) if "fromto" in geom else least):
            raise InputError(
                f"{file}: size={geom.get('size', '')[:60]!r} of a {kind} has {sizes} numbers; give {least}."
            )


def check_names(file: str, root: Element) -> None:
    """Refuse bodies and joints that share a name, which MuJoCo refuses too, or have one of Pinocchio's own.

    Its reader ends the process on some of them.

    Raises
    ------
    InputError
        Names the first pair.
    """
    for tag in ("body", "joint"):
        every = (element.get("name") for world in root.findall("worldbody") for element in world.iter(tag))
        for name, count in Counter(filter(None, every)).items():
            if name == WORLD:
                raise InputError(f"{file}: a <{tag}> is named {WORLD!r}, Pinocchio's name of the world; rename it.")
            if count > 1:
                raise InputError(f"{file}: {count} elements <{tag}> are named {name[:60]!r}; give each its own name.")


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return math.nan
