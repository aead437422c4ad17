"""Standing configurations: feet on the ground, knees bent, the centre of mass above the feet."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.precision import MET
from robotraj.dynamics.terrain.function import as_ground
from robotraj.guess.legs.singular_legs import BEND, bent, singular_legs
from robotraj.guess.legs.stance import SHORT, BalancedStance, root_freedoms
from robotraj.robot.neutral import amid
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION

REPEATS = 5
"""Number of repetitions with the last solution as posture, for a given height."""
NEAR_HEIGHT = 1e-3
"""Distance of the centre of mass from a given height beyond which other bends of the knees are tried, of the reach."""
ONE_SIDED = 0.1
"""Fraction of a joint's range: a joint that is nearer to a bound bends to the other side, as knees do."""


def upright(robot: Robot, q: Array) -> Array:
    """Return a configuration with a level root that heads along world x."""
    q = np.array(q)
    if robot.root == "floating":
        q[QUATERNION] = (0.0, 0.0, 0.0, 1.0)
    elif robot.root == "planar":
        q[2] = 0.0
    return q


def standing(stance: BalancedStance, height: float | None = None) -> Array:
    """Return the configuration (nq,) with all feet on the ground, bent knees and the centre of mass above the feet.

    The feet keep their horizontal positions of the neutral configuration, or the nearest ones within the limits of the
    joints. If its legs are straight or one of their joints is at a bound, joints at bounds are bent inwards. The centre
    of mass is then lowered by a twentieth of its height, as far as the legs allow. Legs that are folded up or level in
    the neutral configuration start amid their ranges, with the feet where they are closer together.

    Parameters
    ----------
    stance : BalancedStance
    height : float, optional
        Height of the centre of mass above the feet [m].
    """
    robot = stance.robot
    q = upright(robot, robot.neutral)
    feet = stance.locate(q)
    n = root_freedoms(robot)
    model, data = robot.model, robot.model.createData()
    if n:
        q = _grounded(stance, q, feet)
        if _com_height(stance, q) < mean_ground(stance, feet) + SHORT * stance.size:
            unfolded = amid(q, robot.limits)
            feet = min(feet, stance.locate(unfolded), key=_spread)
            q = _grounded(stance, unfolded, feet)
    com = pin.centerOfMass(model, data, q)
    _, slope = stance.places(q, feet)
    lower, upper = stance.bounds
    level = np.max(np.abs(slope[stance.upward][:, n:]), initial=0.0) < 1e-2 * abs(com[2])
    straight = bool(level or singular_legs(stance, q, feet)) or _stretched(
        stance, slope[:, n:], q[len(q) - len(lower) :]
    )
    start = np.array(q)
    anchors_by_axis = (
        [feet[a.name] for c in stance.feet for a in c.anchors if a.name == f"{c.name}.{axis}"] for axis in "xy"
    )
    middle = [float(np.mean(values or [0.0])) for values in anchors_by_axis]
    ground = float(com[2] - height_above(stance, feet, com))
    target = height if height is not None else (0.95 if straight else 1.0) * (com[2] - ground)
    if straight:
        start = _bent(stance, start, SHORT * stance.scales(robot.units[n:]))
    if rows_flat := singular_legs(stance, start, feet):
        start = bent(stance, start, feet, rows_flat, up=target < com[2] - ground)
        straight = True
    com = np.array([*middle, ground + target])
    found = stance.reach(start, feet, com, {}, start if straight else q)
    if height is None:
        return _settled(stance, found)
    found = _at_height(stance, found, feet, com, q)
    if abs(_com_height(stance, found) - com[2]) > NEAR_HEIGHT * stance.size:
        # The nearest bend of a knee may lead to its limit.
        start = _bent(stance, q, ONE_SIDED * (upper - lower))
        other = _at_height(stance, stance.reach(start, feet, com, {}, start), feet, com, q)
        found = min(found, other, key=lambda each: abs(_com_height(stance, each) - com[2]))
    return _settled(stance, found)


def _settled(stance: BalancedStance, q: Array) -> Array:
    """Put the feet on the ground where they are, which changes nothing where they already are on it."""
    return stance.settle(q, stance.locate(q), stance.lifted({}))


def _grounded(stance: BalancedStance, q: Array, feet: Mapping[str, float]) -> Array:
    """Return a configuration whose root is moved vertically until the feet are on the ground on average."""
    q, (rows, _) = np.array(q), stance.places(q, feet)
    q[1 if stance.robot.root == "planar" else 2] -= float(np.mean(rows[stance.upward]))
    return q


def _spread(feet: Mapping[str, float]) -> float:
    """Return the sum of the squares of the feet's horizontal places, to the rounding of one place [m^2]."""
    return round(sum(value**2 for name, value in feet.items() if name.endswith((".x", ".y"))), 6)


def _stretched(stance: BalancedStance, slope: Array, joints: Array) -> bool:
    """Whether a joint that moves the feet is at a bound, so that a leg cannot extend, or bend to one side."""
    lower, upper = stance.bounds
    scales = stance.scales(stance.robot.units[root_freedoms(stance.robot) :])
    near = np.minimum(joints - lower, upper - joints) < SHORT * scales
    return bool(np.any(_move_feet(stance, slope) & near))


def _move_feet(stance: BalancedStance, slope: Array) -> NDArray[np.bool_]:
    """Return which joints move the feet, from the slopes (m, joints) of the feet's rows."""
    scales = stance.scales(stance.robot.units[root_freedoms(stance.robot) :])
    return np.asarray(scales * np.max(np.abs(slope), axis=0, initial=0.0) > MET * stance.size)


def _at_height(stance: BalancedStance, q: Array, feet: Mapping[str, float], com: Array, home: Array) -> Array:
    """Return a configuration at a centre of mass, which has priority over the posture of the legs.

    The other joints keep near those of ``home``. They would lower the centre of mass as well: a torso would roll aside.
    """
    joints = slice(len(q) - len(stance.bounds[0]), None)
    legs = _move_feet(stance, stance.places(q, feet)[1][:, root_freedoms(stance.robot) :])
    for _ in range(REPEATS):
        posture = upright(stance.robot, q)
        posture[joints] = np.where(legs, q[joints], home[joints])
        q = stance.reach(q, feet, com, {}, posture)
    return q


def _bent(stance: BalancedStance, q: Array, near: Array) -> Array:
    """Bend joints inwards that are within ``near`` of one bound."""
    lower, upper = stance.bounds
    q = np.array(q)
    joints = q[len(q) - len(lower) :]
    bend = np.minimum(BEND * stance.scales(stance.robot.units[-len(lower) :]), 0.5 * (upper - lower))
    joints += np.where(joints - lower < near, bend, np.where(upper - joints < near, -bend, 0.0))
    return stance.inside(q)


def _com_height(stance: BalancedStance, q: Array) -> float:
    return float(pin.centerOfMass(stance.robot.model, stance.data, q)[2])


def mean_ground(stance: BalancedStance, feet: Mapping[str, float]) -> float:
    """Return the mean height of the ground under the feet [m]."""
    heights = []
    for contact in stance.feet:
        ground = as_ground(contact.contact.ground)
        heights.append(float(ground.height(feet.get(f"{contact.name}.x", 0.0), feet.get(f"{contact.name}.y", 0.0))))
    return float(np.mean(heights))


def pendulum_time(stance: BalancedStance, q: Array) -> float:
    """Return sqrt(h / g) [s], with the height h of the centre of mass above the feet: the time scale of a step."""
    model = stance.robot.model
    com = np.array(pin.centerOfMass(model, stance.data, q))
    height = pendulum_height(stance, height_above(stance, stance.locate(q), com))
    return float(np.sqrt(height / np.linalg.norm(model.gravity.linear)))


def pendulum_height(stance: BalancedStance, above: float) -> float:
    """Return the height of an inverted pendulum [m]: that of the centre of mass above the feet, if it is not too low.

    A mass at or below the height of the contacts gets a pendulum of a twentieth of the reach.
    """
    return max(above, SHORT * stance.size)


def height_above(stance: BalancedStance, feet: Mapping[str, float], com: Array) -> float:
    """Return the height of the centre of mass above the mean of the feet [m]."""
    return float(com[2] - mean_ground(stance, feet))
