"""Ball joints of URDFs, which PyBullet reads: chains of three hinges, as for a ball joint of a ``pin.Model``."""

from __future__ import annotations

from copy import deepcopy
from xml.etree.ElementTree import Element, SubElement

BALLS = ("spherical", "ball")
"""Types of a ball joint."""
CHAIN = (("yaw", "0 0 1"), ("pitch", "0 1 0"), ("roll", "1 0 0"))
"""Endings of the names of its hinges and their axes, each after the ones before."""


def chains_of_balls(root: Element) -> dict[str, tuple[str, ...]]:
    """Return the names of the hinges of every ball joint."""
    balls = [joint.get("name", "") for joint in root.findall("joint") if joint.get("type") in BALLS]
    return {name: tuple(f"{name}_{ending}" for ending, _ in CHAIN) for name in balls}


def without_balls(root: Element) -> Element:
    """Return a URDF whose ball joints are chains of hinges about z, y and x, with massless links between them.

    Each hinge has the effort and velocity limits of the ball joint. Its rates are not defined where the pitch is a
    quarter turn. The element itself is returned if it has no ball joint.
    """
    if not any(joint.get("type") in BALLS for joint in root.findall("joint")):
        return root
    copy = deepcopy(root)
    for ball in [joint for joint in copy.findall("joint") if joint.get("type") in BALLS]:
        name, parent, child = ball.get("name", ""), _link(ball, "parent"), _link(ball, "child")
        kept = [element for element in ball if element.tag in ("dynamics", "limit")]
        for element in kept:
            for side in ("lower", "upper"):
                element.attrib.pop(side, None)
        for ending, axis in CHAIN:
            last = ending == CHAIN[-1][0]
            hinge = SubElement(copy, "joint", name=f"{name}_{ending}", type="continuous")
            link = child if last else f"{name}_{ending}_link"
            if not last:
                SubElement(copy, "link", name=link)
            SubElement(hinge, "parent", link=parent)
            SubElement(hinge, "child", link=link)
            SubElement(hinge, "axis", xyz=axis)
            hinge.extend([*(ball.findall("origin") if ending == CHAIN[0][0] else ()), *deepcopy(kept)])
            parent = link
        copy.remove(ball)
    return copy


def _link(joint: Element, end: str) -> str:
    tag = joint.find(end)
    return "" if tag is None else tag.get("link", "")
