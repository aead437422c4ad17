"""Numbers of an MJCF file, before Pinocchio's reader puts memory that it never wrote in the place of what is none."""

from __future__ import annotations

import math
from xml.etree.ElementTree import Element

from robotraj._util.errors import InputError
from robotraj.robot.mjcf.defaults import ACTUATORS
from robotraj.robot.urdf.xml import MAX_TEXT

ELEMENTS = ("body", "frame", "joint", "freejoint", "geom", "inertial", "mesh", "site", *ACTUATORS)
NUMBERS = (
    *("pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "axis", "size", "fromto", "scale", "refpos", "refquat"),
    *("mass", "density", "diaginertia", "fullinertia", "armature", "damping", "frictionloss"),
    *("range", "ref", "springref", "stiffness", "gear", "forcerange", "ctrlrange", "vertex"),
)
"""Attributes of these elements that hold numbers."""
LARGEST = 1e12
"""Largest number: squares and products of larger ones have no use and may overflow."""
NOT_NEGATIVE = ("mass", "density", "diaginertia", "armature", "damping", "frictionloss", "stiffness")


def check_numbers(file: str, root: Element) -> None:
    """Refuse what is no number where one belongs, impossible numbers, and endless texts.

    Raises
    ------
    InputError
        Names the element, the attribute and the text.
    """
    for element in root.iter():
        for key, text in element.attrib.items():
            where = f"{file}: {key}={text[:60]!r} of <{element.tag[:40]}> {element.get('name', '')[:60]!r}"
            if len(text) > MAX_TEXT and element.tag in ELEMENTS and element.tag != "mesh":
                raise InputError(f"{where} has {len(text)} characters; at most {MAX_TEXT} are read.")
            if element.tag not in ELEMENTS or key not in NUMBERS:
                continue
            numbers = [_number(word) for word in text.split()]
            if not all(abs(number) <= LARGEST for number in numbers):
                raise InputError(f"{where} is not finite numbers up to {LARGEST:g}; correct the file.")
            if key in NOT_NEGATIVE and any(number < 0.0 for number in numbers):
                raise InputError(f"{where} is negative; correct the file.")
            if key == "axis" and not math.hypot(*numbers) > 0.0:
                raise InputError(f"{where} is no direction; give three numbers, such as '0 0 1'.")


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return math.nan
