"""Springs of the joints of an MJCF file: ``stiffness`` and ``springref``."""

from __future__ import annotations

import math
from collections.abc import Iterable
from xml.etree.ElementTree import Element

from robotraj.robot.mjcf.defaults import Attributes
from robotraj.robot.urdf.numbers import numbers


def joint_springs(
    root: Element, joints: Iterable[Attributes], names: Iterable[str]
) -> tuple[dict[str, tuple[float, float]], tuple[str, ...]]:
    """Return stiffness and position without torque by joint [N m/rad, rad; N/m, m], and the springs that are not read.

    Springs of ball joints, several stiffnesses at one joint, and springs that are given by their natural frequency or
    beside another reference than zero are not read.

    Parameters
    ----------
    root : Element
    joints : iterable of attributes
        Of every joint of the file.
    names : iterable of str
        The joints of the model.
    """
    compiler, known = root.find("compiler"), set(names)
    degrees = compiler is None or compiler.get("angle", "degree") == "degree"
    found: dict[str, tuple[float, float]] = {}
    unread = []
    for joint in joints:
        name, kind = joint.get("name", ""), joint.get("type", "hinge")
        stiffness, rest = numbers(joint.get("stiffness", "0"), 1), numbers(joint.get("springref", "0"), 1)
        if "springdamper" not in joint and stiffness is not None and not stiffness[0] > 0.0:
            continue
        plain = kind in ("hinge", "slide") and "springdamper" not in joint and name in known
        zero = numbers(joint.get("ref", "0"), 1)
        if not plain or stiffness is None or rest is None or zero is None or zero[0] != 0.0:
            unread.append(name or "a joint without a name")
            continue
        found[name] = (stiffness[0], math.radians(rest[0]) if degrees and kind == "hinge" else rest[0])
    return found, tuple(unread)
