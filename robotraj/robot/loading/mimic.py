"""Joints that a URDF couples by ``<mimic>``: follower = multiplier * leader + offset.

By default Pinocchio reads them as independent joints; its forward dynamics does not support coupled ones. A plan that
moved a leader without its follower would not be valid for the real robot. All joints of a coupled mechanism, such as a
gripper, are therefore locked, each follower at the position that its leader determines.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from xml.etree.ElementTree import Element

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass


@dataclass(frozen=True)
class Mimic:
    """One coupling: follower = multiplier * leader + offset [rad, m]."""

    follower: str
    leader: str
    multiplier: float
    offset: float


def read_mimics(robot: Element, moving: Sequence[str]) -> tuple[Mimic, ...]:
    """Read the ``<mimic>`` tags of the moving joints.

    Raises
    ------
    InputError
        A follower whose leader is no moving joint.
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
    return tuple(mimics)


def lock_mimics(mimics: Sequence[Mimic], locked: Mapping[str, float], neutral: Mapping[str, float]) -> dict[str, float]:
    """Add every joint of the coupled mechanisms to ``locked``.

    Parameters
    ----------
    mimics : sequence of Mimic
        The couplings.
    locked : mapping
        The caller's locked joints; a leader locked here sets its followers.
    neutral : mapping
        Position of a leader that the caller does not lock [rad, m].

    Raises
    ------
    InputError
        The caller locks a follower at another position than its leader determines, or the couplings form a cycle.
    """
    by_follower = {mimic.follower: mimic for mimic in mimics}
    result = dict(locked)

    def position(joint: str, passed: tuple[str, ...] = ()) -> float:
        if joint in passed:
            raise InputError(f"The mimic joints {', '.join(passed)} form a cycle of couplings; remove one <mimic>.")
        if joint not in by_follower:
            return float(locked.get(joint, neutral[joint]))
        mimic = by_follower[joint]
        return mimic.multiplier * position(mimic.leader, (*passed, joint)) + mimic.offset

    for mimic in mimics:
        for joint in (mimic.leader, mimic.follower):
            value = position(joint)
            if joint in locked and abs(locked[joint] - value) > 1e-9:
                raise InputError(
                    f"locked= holds {joint!r} at {locked[joint]:g}, but it mimics "
                    f"{by_follower[joint].leader!r}, which "
                    f"puts it at {value:g}. Lock {by_follower[joint].leader!r} instead."
                )
            result[joint] = value
    return result
