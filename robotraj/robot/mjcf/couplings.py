"""Joints of an MJCF file that follow another one: ``<equality><joint>`` with a straight line as its polynomial.

MuJoCo holds q1 - q1_0 = c0 + c1 (q2 - q2_0) + ..., with the references q_0 of the joints.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.etree.ElementTree import Element

import pinocchio as pin

from robotraj.robot.coupling.mimics import Mimic
from robotraj.robot.loading.planning_model import parents_of
from robotraj.robot.urdf.numbers import numbers

LINE = "0 1 0 0 0"
"""Coefficients of an equality that states none."""
REFERENCE = "qpos0"
"""Name of the configuration in which the file draws the robot."""


def active(root: Element) -> list[Element]:
    """Return the equalities of a file that hold."""
    every = (each for group in root.findall("equality") for each in group)
    return [each for each in every if each.get("active", "true") != "false"]


def couplings(equalities: Sequence[Element], model: pin.Model) -> tuple[tuple[Mimic, ...], bool]:
    """Return the couplings of joints with one degree of freedom, and whether there are equalities of other kinds."""
    found: dict[str, Mimic] = {}
    for mimic in filter(None, (_mimic(each, model) for each in equalities)):
        if mimic.follower not in found and not _leads_back(mimic, found):
            found[mimic.follower] = mimic
    return tuple(found.values()), len(found) < len(equalities)


def _mimic(equality: Element, model: pin.Model) -> Mimic | None:
    """Return the coupling of an equality; the joint that stands further out follows."""
    line = numbers(equality.get("polycoef", LINE), 5)
    pair = equality.get("joint1", ""), equality.get("joint2", "")
    single = all(model.existJointName(joint) and model.joints[model.getJointId(joint)].nv == 1 for joint in pair)
    if equality.tag != "joint" or line is None or any(line[2:]) or not line[1] or not single:
        return None
    (follower, leader), (offset, multiplier) = pair, line[:2]
    offset += _reference(model, follower) - multiplier * _reference(model, leader)
    if model.getJointId(follower) in _carriers(model, leader):
        return Mimic(leader, follower, 1.0 / multiplier, -offset / multiplier)
    return Mimic(follower, leader, multiplier, offset)


def _reference(model: pin.Model, joint: str) -> float:
    """Return the position of a joint in which the file draws it."""
    if REFERENCE not in model.referenceConfigurations:
        return 0.0
    return float(model.referenceConfigurations[REFERENCE][model.joints[model.getJointId(joint)].idx_q])


def _leads_back(mimic: Mimic, found: dict[str, Mimic]) -> bool:
    """Whether the leader of a coupling follows its follower."""
    joint = mimic.leader
    while joint in found:
        joint = found[joint].leader
    return joint == mimic.follower


def _carriers(model: pin.Model, joint: str) -> Iterator[int]:
    """Yield the joints that carry a joint."""
    parents = parents_of(model)
    k = parents[model.getJointId(joint)]
    while k:
        yield k
        k = parents[k]
