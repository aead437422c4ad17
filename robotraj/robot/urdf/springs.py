"""Springs of a URDF, which Gazebo reads: torque -k (q - rest) at a joint.

They stand in ``<gazebo reference="joint"><springStiffness>`` and ``<springReference>``. Some exporters write those of
SDF into ``<dynamics>`` of the URDF. Source: the specification of SDFormat, ``joint/axis/dynamics``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from xml.etree.ElementTree import Element

SPRING = ("spring_stiffness", "spring_reference")
"""Attributes of ``<dynamics>``: stiffness [N m/rad, N/m] and position without torque [rad, m]."""
GAZEBO = ("springStiffness", "springReference")
"""Elements of ``<gazebo>`` with the same numbers."""


def spring_faults(root: Element) -> list[str]:
    """Return the numbers of Gazebo's springs that cannot be read, in words."""
    return [
        f"the spring of joint {name!r} has <{tag}> {text!r}, which is no finite number"
        for name, tag, text in _texts(root)
        if _number(text) is None
    ]


def stated_springs(root: Element) -> dict[str, tuple[float, float]]:
    """Return stiffness and rest by joint; those of ``<gazebo>`` replace others. The numbers have been checked."""
    found: dict[str, dict[str, float]] = {}
    for joint in root.findall("joint"):
        dynamics = joint.find("dynamics")
        for own, tag in zip(SPRING, GAZEBO, strict=True):
            text = None if dynamics is None else dynamics.get(own)
            if text is not None:
                found.setdefault(joint.get("name", ""), {})[tag] = float(text)
    for name, tag, text in _texts(root):
        found.setdefault(name, {})[tag] = float(text)
    stiffness, rest = GAZEBO
    return {name: (values[stiffness], values.get(rest, 0.0)) for name, values in found.items() if values.get(stiffness)}


def _texts(root: Element) -> Iterator[tuple[str, str, str]]:
    """Yield joint, element and text of Gazebo's springs."""
    joints = {joint.get("name", "") for joint in root.findall("joint")}
    for gazebo in root.findall("gazebo"):
        name = gazebo.get("reference", "")
        for tag in GAZEBO if name in joints else ():
            text = gazebo.findtext(tag)
            if text is not None:
                yield name, tag, text.strip()


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in text else None
