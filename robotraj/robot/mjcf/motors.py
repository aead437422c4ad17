"""Motors of an MJCF file: the joints that they drive, and the forces that they have."""

from __future__ import annotations

import math
from collections.abc import Sequence
from xml.etree.ElementTree import Element

import numpy as np

from robotraj._util.values import dataclass
from robotraj.robot.coupling.mimics import Mimic
from robotraj.robot.loading.chain_names import Chains
from robotraj.robot.mjcf.defaults import Attributes
from robotraj.robot.urdf.numbers import numbers

Pair = tuple[float, float]
OTHERS = ("damper", "muscle")
"""Actuators that push to one side only, or against the motion."""


@dataclass(frozen=True)
class Motors:
    """The motors of a file.

    Attributes
    ----------
    driven : tuple of str or None
        Joints with a motor; None if the file has no actuator at all.
    efforts : mapping by joint
        Lower and upper limits of the motors [N m, N].
    findings : tuple of str
    """

    driven: tuple[str, ...] | None
    efforts: dict[str, Pair]
    findings: tuple[str, ...]


def motors_of(root: Element, joints: Sequence[str], chains: Chains, mimics: Sequence[Mimic]) -> Motors:
    """Return the motors of a file without default classes.

    Parameters
    ----------
    root : Element
    joints : sequence of str
        Of the model, each with one degree of freedom.
    chains : mapping of str to tuple of str
        Those in place of ball joints. Motors about three axes of a ball drive all, without a limit: the torques of its
        parts depend on its position.
    mimics : sequence of Mimic
        Joints that follow others. A follower's motor drives the leader.
    """
    stated = [joint.attrib for world in root.findall("worldbody") for joint in world.iter("joint")]
    whole = {own.get("name", ""): numbers(own.get("actuatorfrcrange", ""), 2) for own in stated}
    every = [(each.tag, each.attrib) for group in root.findall("actuator") for each in group]
    axes = {joint: [_axis(own) for _, own in every if own.get("joint") == joint] for joint in chains}
    turned = {joint for joint, own in axes.items() if own and np.linalg.matrix_rank(own) == 3}
    found: dict[str, list[Pair | None]] = {}
    unread = []
    for tag, own in every:
        joint = own.get("joint", "")
        if tag in OTHERS or not joint or (joint in chains and joint not in turned):
            unread.append(own.get("name", f"<{tag}>"))
        elif joint in joints:
            found.setdefault(joint, []).append(_effort(tag, own))
    for joint in turned:
        found |= {part: [None] for part in chains[joint]}
    for mimic in mimics:
        for pair in found.pop(mimic.follower, ()):
            found.setdefault(mimic.leader, []).append(pair and _scaled(pair, mimic.multiplier))
    ranges = {joint: _both(_sum(each), whole.get(joint)) for joint, each in found.items()}
    efforts = {joint: pair for joint, pair in ranges.items() if pair is not None}
    driven = tuple(joint for joint in joints if joint in found)
    findings = []
    if unread:
        findings.append(
            f"Actuators of the MJCF that are not read: {', '.join(unread)}. They act on no joint, or are no motors."
            + ("" if driven else " No joint has a motor: name those with one by actuated=[...].")
        )
    without = [joint for joint in driven if joint not in efforts]
    if without:
        findings.append(
            f"Motors without a limit of effort in the MJCF: {', '.join(map(repr, without))}. Set them with "
            "limits={'effort': {joint: largest}}."
        )
    return Motors(driven if every else None, efforts, tuple(findings))


def _axis(actuator: Attributes) -> list[float]:
    """Return the axis (3,) of a motor of a ball joint, times its gear."""
    gear = [float(word) for word in (actuator.get("gear") or "1").split()[:3]]
    return [*gear, 0.0, 0.0][:3]


def _both(first: Sequence[float] | None, second: Sequence[float] | None) -> Pair | None:
    """Return the values that lie in both ranges, of which either may be missing."""
    known = [each for each in (first, second) if each is not None and each[0] < each[1]]
    return (max(each[0] for each in known), min(each[1] for each in known)) if known else None


def _sum(ranges: Sequence[Pair | None]) -> Pair | None:
    """Return the range of the forces of several motors of a joint; None where one has no limit."""
    known = [each for each in ranges if each is not None]
    return (sum(each[0] for each in known), sum(each[1] for each in known)) if len(known) == len(ranges) else None


def _effort(tag: str, actuator: Attributes) -> Pair | None:
    """Return the range of force of an actuator: its ``forcerange``, or the ``ctrlrange`` of a motor, times its gear."""
    given = actuator.get("forcerange") or (actuator.get("ctrlrange") if tag == "motor" else None)
    ends, gear = numbers(given or "", 2), numbers((actuator.get("gear") or "1").split()[0], 1)
    if ends is None or gear is None or not math.isfinite(gear[0]):
        return None
    low, high = _scaled((ends[0], ends[1]), gear[0])
    return (low, high) if low < high else None


def _scaled(pair: Pair, factor: float) -> Pair:
    low, high = sorted(factor * end for end in pair)
    return low, high
