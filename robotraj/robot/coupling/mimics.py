"""Couplings of joints: follower = multiplier * leader + offset, from ``<mimic>`` tags and from models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from xml.etree.ElementTree import Element

import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass

SAME = 1e-9
"""Positions that differ by less are equal [rad, m]."""


@dataclass(frozen=True)
class Mimic:
    """One coupling: follower = multiplier * leader + offset [rad, m]."""

    follower: str
    leader: str
    multiplier: float
    offset: float

    def __str__(self) -> str:
        scaled = f"{self.multiplier:g} {self.leader}" if self.multiplier != 1.0 else self.leader
        sign = "+" if self.offset > 0.0 else "-"
        return f"{self.follower} = {scaled}" + (f" {sign} {abs(self.offset):g}" if self.offset else "")

    def of_leader(self, position: float) -> float:
        """Return the leader's position for one of the follower."""
        return (position - self.offset) / self.multiplier


def read_mimics(robot: Element, moving: Sequence[str]) -> tuple[Mimic, ...]:
    """Read the ``<mimic>`` tags of the moving joints; every leader of the result is independent.

    Raises
    ------
    InputError
        A follower whose leader is no moving joint, or couplings in a cycle.
    """
    mimics = []
    for joint in robot.findall("joint"):
        tag = joint.find("mimic")
        follower = joint.get("name", "")
        if tag is None or follower not in moving:
            continue
        leader = tag.get("joint", "")
        if leader not in moving:
            raise InputError(
                f"Joint {follower!r} mimics {leader!r}, which is no moving joint of the URDF; correct its <mimic>."
            )
        multiplier, offset = float(tag.get("multiplier", "1")), float(tag.get("offset", "0"))
        mimics.append(Mimic(follower, leader, multiplier, offset))
    return resolved(mimics)


def resolved(mimics: Sequence[Mimic]) -> tuple[Mimic, ...]:
    """Refer every follower to the joint at the head of its chain: a = m b + c and b = n d + e give a = m n d + m e + c.

    Raises
    ------
    InputError
        The couplings form a cycle.
    """
    by_follower = {mimic.follower: mimic for mimic in mimics}
    found = []
    for mimic in mimics:
        passed = [mimic.follower]
        while mimic.leader in by_follower:
            passed.append(mimic.leader)
            if mimic.leader in passed[:-1]:
                raise InputError(f"The mimic joints {', '.join(passed)} form a cycle of couplings; remove one <mimic>.")
            above = by_follower[mimic.leader]
            multiplier = mimic.multiplier * above.multiplier
            offset = mimic.multiplier * above.offset + mimic.offset
            mimic = replace(mimic, leader=above.leader, multiplier=multiplier, offset=offset)
        found.append(mimic)
    return tuple(found)


def mimics_of(model: pin.Model) -> tuple[Mimic, ...]:
    """Return the couplings of a model's active mimic joints."""
    names, found = model.names, []
    for follower in model.mimicking_joints:
        joint = model.joints[follower].extract()
        leader = next(i for i in range(1, model.njoints) if model.joints[i].nv and model.joints[i].idx_v == joint.idx_v)
        found.append(Mimic(names[follower], names[leader], float(joint.scaling), float(joint.offset)))
    return tuple(found)


def lock_mimics(mimics: Sequence[Mimic], locked: Mapping[str, float]) -> dict[str, float]:
    """Add to ``locked`` the joints that are coupled to a locked one, and followers that never move.

    Parameters
    ----------
    mimics : sequence of Mimic
        Couplings with independent leaders.
    locked : mapping
        The caller's locked joints [rad, m].

    Raises
    ------
    InputError
        The caller locks two coupled joints at positions that contradict each other.
    """
    result = dict(locked)
    for mimic in mimics:
        if mimic.multiplier and mimic.follower in locked and mimic.leader not in result:
            result[mimic.leader] = mimic.of_leader(locked[mimic.follower])
    for mimic in mimics:
        if mimic.multiplier and mimic.leader not in result:
            continue
        value = mimic.multiplier * result.get(mimic.leader, 0.0) + mimic.offset
        if mimic.follower in locked and abs(locked[mimic.follower] - value) > SAME:
            raise InputError(
                f"locked= holds {mimic.follower!r} at {locked[mimic.follower]:g}, but it mimics {mimic.leader!r}, "
                f"which puts it at {value:g}. Lock {mimic.leader!r} alone."
            )
        result[mimic.follower] = value
    return result
