"""Elements of an MJCF file that Pinocchio's reader drops without a word, or refuses for a part that does not matter."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree.ElementTree import Element

from robotraj._util.errors import InputError

FRAMED = ("body", "joint", "freejoint", "geom", "inertial")
"""Elements that it drops where they stand inside a <frame>."""
ADDING = ("attach", "replicate", "composite", "flexcomp")
"""Elements of the world that add bodies."""


def check_bodies(file: str, root: Element) -> None:
    """Refuse files without bodies, and those that have some where they are dropped.

    Raises
    ------
    InputError
        Names the elements, and how to write the file without them.
    """
    worlds = root.findall("worldbody")
    inside = {each.tag for frame in root.iter("frame") for each in frame.iter() if each.tag in FRAMED}
    adding = {f"<{each.tag}>" for world in worlds for each in world.iter() if each.tag in ADDING}
    written = "a file that MuJoCo's mj_saveLastXML writes has"
    if inside:
        raise InputError(
            f"{file} has elements inside <frame>, which Pinocchio does not read: {', '.join(sorted(inside))}. "
            f"Give them the frame's pose in its place; {written} no frames."
        )
    if adding:
        raise InputError(
            f"{file} adds bodies by {', '.join(sorted(adding))}, which Pinocchio does not read; {written} the bodies "
            "in their place."
        )
    if not any(world.findall("body") for world in worlds):
        raise InputError(
            f"{file} has no <body> in its <worldbody>: nothing moves. If it is a part, load a file that includes it."
        )


def without_height_fields(root: Element) -> tuple[str, ...]:
    """Remove height fields, which make Pinocchio's reader refuse the whole file, and return their names."""
    names = [each.get("name") or each.get("file") or "" for assets in root.findall("asset") for each in _fields(assets)]
    for holder in list(root.iter()):
        for each in list(_fields(holder)):
            holder.remove(each)
    return tuple(names)


def _fields(holder: Element) -> Iterator[Element]:
    return (each for each in holder if each.tag == "hfield" or each.get("hfield"))
