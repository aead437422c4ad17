"""Steps before or after which the root has no room: its height and attitude are bounded, and the feet far apart.

Before and after a step, all feet stand, and the root keeps the bounds of ``Upright`` in that step: it is high above the
mean level of the feet and hardly tilts. Inverse kinematics within the position limits find a configuration for each
such stance, with these bounds as further rows. A leg that is too short for a stair, or for a gap, has none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import cast

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.flat import Flat
from robotraj.gait.bounds.upright import Upright, root_link
from robotraj.gait.stepping.stances import MODEST, OFF, greatest, level_under, standing_on
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import mean_ground
from robotraj.problem.constraints.bounds import Between
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION


@dataclass(frozen=True)
class RootRoom:
    """The bounds of a root: how far a configuration is outside them.

    Attributes
    ----------
    robot : Robot
    height : (float, float)
        Least and greatest height of the root link [m].
    attitude : mapping of str to (float, float)
        Bounds of the pitch of a planar root [rad], or of entries of the quaternion of a floating one.
    size : float
        The length to which the height is compared [m].
    """

    robot: Robot
    height: tuple[float, float]
    attitude: Mapping[str, tuple[float, float]]
    size: float

    def __call__(self, q: Array) -> tuple[Array, Array]:
        """Return the excess (m,) over the bounds, zero inside, and its Jacobian (m, nv); lengths relative to size."""
        model, data = self.robot.model, self.robot.model.createData()
        frame = self.robot.frame(root_link(self.robot))
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        up = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[2]
        values, slopes = [float(data.oMf[frame].translation[2]) / self.size], [up / self.size]
        bounds = [(self.height[0] / self.size, self.height[1] / self.size)]
        for name, span in self.attitude.items():
            at = self.robot.position_names.index(name)
            slope = np.zeros(self.robot.nv)
            if self.robot.root == "floating":
                x, y, z, w = q[QUATERNION]
                rates = 0.5 * np.array([[w, -z, y], [z, w, -x], [-y, x, w]])  # of (x, y, z) by the speed in body axes
                slope[3:6] = rates[at - QUATERNION.start]
            else:
                slope[at] = 1.0
            values.append(float(q[at]))
            slopes.append(slope)
            bounds.append(span)
        lower, upper = np.array(bounds).T
        excess = np.array(values) - np.clip(values, lower, upper)
        return excess, np.where(excess[:, None] != 0.0, np.array(slopes), 0.0)


def check_root(
    stance: BalancedStance,
    first: Array,
    places: Sequence[Mapping[str, float]],
    moved: Sequence[Sequence[str]],
    upright: Upright,
) -> None:
    """Refuse a step before or after which the robot cannot stand with its root inside its bounds.

    Parameters
    ----------
    stance, first, places, moved
        As for ``check_footholds``.
    upright : Upright
        Bounds of the root during the steps.

    Raises
    ------
    InputError
        The message has a step or a rise that would do.
    """
    for k, feet in enumerate(moved):
        off = _off(stance, first, places, k, upright)
        if off <= OFF:
            continue
        part = greatest(partial(_fits, stance, first, places, k, upright))
        rise = float(np.ptp([level_under(stance, side, c.name) for c in stance.feet for side in places[k : k + 2]]))
        if rise > OFF * stance.size:
            remedy = f"A rise of {2.0 * MODEST * part * rise:.2g} m would do."
        else:
            far = max(abs(places[k + 1][name] - places[k][name]) for name in places[k])
            remedy = f"Steps of {MODEST * part * far:.2g} m would do."
        raise InputError(
            f"{stance.robot.name!r} cannot stand before and after step {k + 1} of {' and '.join(map(repr, feet))} with "
            f"its root as high and as level as {upright} bounds it: by the position limits and the lengths of its "
            f"legs, a foot or the root is {off * stance.size:.2g} m off in the best configuration found. {remedy}"
        )


def _fits(
    stance: BalancedStance,
    first: Array,
    places: Sequence[Mapping[str, float]],
    k: int,
    upright: Upright,
    share: float,
) -> bool:
    """Whether the robot stands before and after a share of step k."""
    return _off(stance, first, places, k, upright, share) <= OFF


def _off(
    stance: BalancedStance,
    first: Array,
    places: Sequence[Mapping[str, float]],
    k: int,
    upright: Upright,
    share: float = 1.0,
) -> float:
    """Return by how much the best stances before and after step k miss feet and bounds, relative to the reach.

    Of the step only a share is done: of the displacements on level ground, else of the heights above the lowest foot.
    """
    before, after = places[k], places[k + 1]
    heights = {c.name: [level_under(stance, side, c.name) for side in (before, after)] for c in stance.feet}
    lowest = float(np.min(list(heights.values())))
    if np.max(list(heights.values())) - lowest <= OFF * stance.size:
        after = {name: (1.0 - share) * before[name] + share * after[name] for name in before}
        share = 1.0
    levels = [lowest + share * (mean_ground(stance, side) - lowest) for side in (before, after)]
    high = upright.heights(stance.robot, first, Flat(mean_ground(stance, places[0])), (min(levels), max(levels)))
    tilts = {name.removeprefix("q."): _numbers(span) for name, span in upright.states(stance.robot).items()}
    room, worst = RootRoom(stance.robot, high, tilts, stance.size), 0.0
    for i, side in enumerate((before, after)):
        near = standing_on(stance, first, places[0], side)[0]
        lifts = {name: (share - 1.0) * (pair[i] - lowest) for name, pair in heights.items()}
        if share == 1.0 and not room(near)[0].any():
            continue
        com = np.array([*pin.centerOfMass(stance.robot.model, stance.data, near)[:2], np.nan])
        found = stance.reach(near, side, com, lifts, near, room)
        rows, _ = stance.places(found, side)
        feet = np.abs(rows - stance.lifted(lifts)) / stance.size
        worst = max(worst, float(np.max(feet, initial=0.0)), float(np.max(np.abs(room(found)[0]))))
    return worst


def _numbers(span: Between) -> tuple[float, float]:
    """Return the two sides of an interval."""
    return float(cast(float, span.lower)), float(cast(float, span.upper))
