"""Stances between steps: configurations on given footholds, and footholds that no configuration reaches.

Before and after a step, all feet are on their footholds. Inverse kinematics within the position limits find a
configuration for each such stance. A step to which there is none is refused, with the greatest part of it that inverse
kinematics reach: the least distance by which a foot is off its foothold grows with that part. Soles on footholds where
the shapes of two feet overlap are refused too: the footholds determine the places of both feet.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.flat_foot import BoundFlatFoot
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import as_ground
from robotraj.gait.standing import FOOT_TOLERANCE
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import height_above, mean_ground
from robotraj.robot.collision.own_body import own_body
from robotraj.robot.root import QUATERNION

OFF = 0.01
"""Greatest distance of a foot from its foothold in a stance between steps, relative to the reach of the robot."""
HALVINGS = 8
"""Number of bisections for the part of a step that is reached."""
MODEST = 0.25
"""Part of the greatest step that a message names as one that would do."""


class FeetOverlap(InputError):
    """Two feet of the robot overlap on their footholds."""


def check_footholds(
    stance: BalancedStance, first: Array, places: Sequence[Mapping[str, float]], moved: Sequence[Sequence[str]]
) -> tuple[Array, float]:
    """Return the configuration (nq,) on the last footholds, and the turn of the robot [rad].

    Parameters
    ----------
    stance : BalancedStance
    first : ndarray (nq,)
        Standing configuration on the first footholds.
    places : sequence of mapping of str to float
        Footholds before the first step and after each one, by anchor [m, rad].
    moved : sequence of sequence of str
        Feet that move in each step.

    Raises
    ------
    InputError
        The robot cannot stand on the footholds after a step. The message has a part of the step that would do.
    FeetOverlap
        Two feet overlap on their footholds.
    """
    allowed = set(overlapping_feet(stance, first))
    for k, feet in enumerate(moved):
        last, angle, off = standing_on(stance, first, places[0], places[k + 1])
        tolerance = OFF * stance.size if k + 1 < len(moved) else FOOT_TOLERANCE
        if off > tolerance:
            raise InputError(_refusal(stance, first, places, k, feet, off, tolerance))
        overlap = next((pair for pair in overlapping_feet(stance, last) if pair not in allowed), None)
        if overlap is not None:
            raise FeetOverlap(
                f"{overlap} of {stance.robot.name!r} overlap on the footholds after step {k + 1}. Place the feet "
                "farther apart, or let them turn by less in a step."
            )
    return last, angle


def overlapping_feet(stance: BalancedStance, q: Array) -> list[str]:
    """Return the pairs of links of flat feet whose shapes overlap in a configuration, ``"left and right"``."""
    model = stance.robot.model
    feet = {
        model.frames[stance.robot.frame(contact.frame)].parentJoint
        for contact in stance.feet
        if isinstance(contact, BoundFlatFoot)
    }
    if len(feet) < 2 or not stance.robot.collision_model.ngeoms:
        return []
    body = own_body(stance.robot)
    overlaps = body.touching(stance.robot, q)
    return [body.label(pair) for pair in overlaps if feet.issuperset(body.joint[body.pairs[pair]].tolist())]


def _refusal(
    stance: BalancedStance,
    first: Array,
    places: Sequence[Mapping[str, float]],
    k: int,
    feet: Sequence[str],
    off: float,
    tolerance: float,
) -> str:
    """Return the message on step k, for which a foot is off its foothold by more than a tolerance [m]."""
    before, after = places[k], places[k + 1]
    levels = {contact.name: level_under(stance, after, contact.name) for contact in stance.feet}

    def reached(way: float, height: float) -> bool:
        """Whether the robot stands after a part of the displacements, on a part of the differences in height."""
        part = {name: (1.0 - way) * before[name] + way * after[name] for name in before}
        under = {name: level_under(stance, part, name) for name in levels}
        lowest = min(under.values())
        lifts = {name: (height - 1.0) * (at - lowest) for name, at in under.items()}
        return standing_on(stance, first, places[0], part, lifts)[2] <= tolerance

    uneven = float(np.ptp(list(levels.values())))
    lower = greatest(lambda height: reached(1.0, height)) if uneven > OFF * stance.size else 0.0
    moves = [[after.get(f"{c.name}.{a}", 0.0) - before.get(f"{c.name}.{a}", 0.0) for a in "xy"] for c in stance.feet]
    far = float(np.max(np.linalg.norm(moves, axis=1)))
    rise = mean_ground(stance, after) - mean_ground(stance, before)
    level = abs(rise) < OFF * stance.size
    if lower:
        remedy = f"A rise of {MODEST * lower * uneven:.2g} m would do."
    else:
        remedy = f"Steps of {MODEST * greatest(lambda way: reached(way, 0.0)) * far:.2g} m would do."
    step = f"{' and '.join(map(repr, feet))} by {far:.3g} m{'' if level else f' and {abs(rise):.3g} m in mean height'}"
    return (
        f"{stance.robot.name!r} cannot stand on the footholds after step {k + 1}, which moves {step}. By the position "
        f"limits and the lengths of its legs, a foot is {off:.2g} off its foothold in the best configuration found. "
        f"{remedy}"
    )


def greatest(holds: Callable[[float], bool]) -> float:
    """Return the greatest part, up to 1, for which a condition holds, as it does for all smaller ones; 0 without."""
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def level_under(stance: BalancedStance, feet: Mapping[str, float], name: str) -> float:
    """Return the height of the ground under a foot [m]."""
    contact = next(each for each in stance.feet if each.name == name)
    ground = as_ground(contact.contact.ground or Flat())
    return float(ground.height(feet.get(f"{name}.x", 0.0), feet.get(f"{name}.y", 0.0)))


def standing_on(
    stance: BalancedStance,
    first: Array,
    before: Mapping[str, float],
    after: Mapping[str, float],
    lifts: Mapping[str, float] | None = None,
) -> tuple[Array, float, float]:
    """Return the standing configuration (nq,) on other footholds, the turn [rad], and the greatest error of a foot.

    Feet stand ``lifts`` above the ground [m], by name.
    """
    above = dict(lifts or {})
    robot = stance.robot
    data = robot.model.createData()
    com = np.array(pin.centerOfMass(robot.model, data, first))
    axes = "x" if robot.root == "planar" else "xy"
    old, new = (
        np.array([[side[f"{c.name}.{axis}"] for axis in axes] for c in stance.contacts]) for side in (before, after)
    )
    shift = np.zeros(3)
    shift[: len(axes)] = new.mean(axis=0) - old.mean(axis=0)
    shift[2] = height_above(stance, before, com) - height_above(stance, after, com)
    shift[2] += np.mean(list(above.values()) or [0.0])
    angle = 0.0
    near = np.array(first)
    if robot.root == "floating":
        a, b = old - old.mean(axis=0), new - new.mean(axis=0)
        angle = float(np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum()))
        turned = pin.AngleAxis(angle, np.array([0.0, 0.0, 1.0])).toRotationMatrix()
        middle = np.append(old.mean(axis=0), 0.0)
        x, y, z, w = first[QUATERNION]
        near[QUATERNION] = (pin.Quaternion(turned) * pin.Quaternion(w, x, y, z)).coeffs()
        near[:3] = turned @ (first[:3] - middle) + middle + shift
        com = turned @ (com - middle) + middle + shift
    else:
        near[:2] += shift[[0, 2]]
        com = com + shift
        com[1] = np.nan
    # The joints keep their standing posture; the root is placed above the new footholds.
    found = stance.reach(near, after, com, above, near)
    rows, _ = stance.places(found, after)
    return found, angle, float(np.max(np.abs(rows - stance.lifted(above)), initial=0.0))
