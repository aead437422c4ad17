"""Limits of leaders within those of their followers: q_f = m q_l + c bounds q_l, v_l, a_l and the jerk of l."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj.robot.coupling.mimics import Mimic
from robotraj.robot.limits import BOUNDS, Limits

CARRIED = ("position", "velocity", "acceleration", "jerk")
"""Quantities whose limits followers pass on. The motor is the leader's, so efforts of followers are no limits."""


def tightened(limits: Limits, mimics: Sequence[Mimic]) -> Limits:
    """Return the limits of independent joints, each within those of its followers.

    A limit of a follower whose lower and upper sides are equal or missing is no limit: files write 0 for it.

    Parameters
    ----------
    limits : Limits
        Of all joints.
    mimics : sequence of Mimic
        Couplings with independent leaders.
    """
    if not mimics:
        return limits
    sides = {name: np.array(getattr(limits, name)) for name in BOUNDS}
    for mimic in mimics:
        leader, follower = limits.joints.index(mimic.leader), limits.joints.index(mimic.follower)
        for quantity in CARRIED:
            low, high = sides[f"{quantity}_lower"], sides[f"{quantity}_upper"]
            ends = np.array([low[follower], high[follower]])
            if ends[0] >= ends[1] or (quantity == "position" and mimic.follower in limits.missing):
                continue
            offset = mimic.offset if quantity == "position" else 0.0
            first, last = sorted((ends - offset) / mimic.multiplier)
            low[leader], high[leader] = max(low[leader], first), min(high[leader], last)
    return _without(limits, sides, [mimic.follower for mimic in mimics])


def _without(limits: Limits, sides: dict[str, Array], followers: Sequence[str]) -> Limits:
    """Return limits with these sides for the joints that follow no other."""
    kept = [joint not in followers for joint in limits.joints]
    joints = tuple(joint for joint in limits.joints if joint not in followers)
    missing = tuple(joint for joint in limits.missing if joint in joints)
    own = {name: side[kept] for name, side in sides.items()}
    return replace(limits, joints=joints, missing=missing, **own)  # type: ignore[arg-type]  # names of arrays
