"""Steps that are longer than the legs reach.

A foot that stands during a whole step stays in place while the root moves on by the step. Its distance from the first
joint of the leg is at most the length l that the position limits allow. By the bounds of ``Upright`` that joint is at
least at the height z above the foot, so that the step is at most 2 sqrt(l^2 - z^2) long. Where the root also turns,
the bound holds for the means of the standing feet and of their first joints.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.terrain.function import as_ground
from robotraj.gait.bounds.upright import Upright, root_link
from robotraj.gait.capability.leg_samples import CONFIGURATIONS, sample_legs
from robotraj.gait.feet import foot_contact
from robotraj.gait.supports import GaitTerms, Support
from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of

LONGER = 1.02
"""Ratio of the length of a leg to the greatest one of its samples, at most."""
MODEST = 0.5
"""Part of the greatest step that a message names as one that would do."""
LOW = 0.1
"""Part of the length of a leg that a message names as a clearance that would do."""


def check_step(
    robot: Robot,
    phases: Sequence[Support],
    length: float,
    steps: float,
    terms: GaitTerms,
    posture: Array,
) -> None:
    """Refuse a step during which a foot stands, but for which its leg is too short.

    Parameters
    ----------
    robot : Robot
    phases : sequence of Support
        Phases of one step.
    length : float
        Displacement of the root in these phases [m].
    steps : float
        Number of ``step_length=`` in it.
    terms : GaitTerms
    posture : ndarray (nq,)
        Standing configuration.

    Raises
    ------
    InputError
        The message has the length of the leg and a step length that would do.
    """
    standing = [foot for foot in phases[0].feet if all(foot in phase.feet for phase in phases)]
    straight = np.array([leg_length(robot, foot) for foot in standing])
    if not standing or not np.isfinite(straight).all():
        return
    below = np.array([_below(foot_contact(terms.contact, foot).bound_to(robot)) for foot in standing])
    high, upright = 0.0, terms.upright
    if isinstance(upright, Upright):
        ground = as_ground(terms.ground)
        # The ground under the root is at most half a step's rise above or below the foot.
        slope = 0.5 * abs(float(ground.height(length, 0.0)) - float(ground.height(0.0, 0.0)))
        least = upright.heights(robot, posture, ground)[0] - slope
        high = max(least + _least_rise(robot, standing, upright.tilt), 0.0)
    lengths, far = straight, np.inf
    # Steps that the standing leg is long enough for need no samples.
    for configurations in (0, CONFIGURATIONS):
        samples = sample_legs(robot, standing, posture, 0.0, 0.0, configurations)
        if samples is None:
            return
        lengths = np.minimum(LONGER * samples.lengths.max(axis=1), straight) + below
        far = 2.0 * float(np.sqrt(max(np.max(lengths) ** 2 - high**2, 0.0)))
        if abs(length) <= far:
            return
    foot, leg = standing[int(np.argmax(lengths))], float(np.max(lengths))
    most, step = far / steps, abs(length) / steps
    meanwhile = "meanwhile" if steps == 1 else f"for {steps:g} of them"
    bounded = f" and its root is as high as {upright} bounds it" if high else ""
    raise InputError(
        f"The step is {step:.3g} m long, but {foot!r} stands in place {meanwhile}, and the leg of {robot.name!r} "
        f"is at most {leg:.3g} m long{bounded}: a step is {most:.3g} m at most. "
        f"step_length={np.sign(length) * MODEST * most:.2g} would do, at a duration= that the joint speeds allow."
    )


def _below(contact: BoundContact) -> float:
    """Return how far from the frame of a foot it touches the ground at most [m]; a ball rolls by up to half a turn."""
    return max(float(np.linalg.norm(spot.offset)) + 2.0 * spot.radius for spot in contact.outline())


def _least_rise(robot: Robot, feet: Sequence[str], tilt: float) -> float:
    """Return the least height of the mean of the legs' first joints above the root link [m], at tilts up to a bound.

    A floating root may tilt by it about x and y at once.
    """
    model, first = robot.model, len(root_of(robot.root).velocities)
    root = model.frames[robot.frame(root_link(robot))].placement
    chains = [model.supports[model.frames[robot.frame(foot)].parentJoint] for foot in feet]
    hips = [next(model.jointPlacements[i] for i in chain if i and model.joints[i].idx_v >= first) for chain in chains]
    x, y, z = np.mean([hip.translation for hip in hips], axis=0) - root.translation
    angles = np.linspace(0.0, tilt if robot.root == "planar" else np.sqrt(2.0) * tilt, 20)
    aside = abs(x) if robot.root == "planar" else np.hypot(x, y)
    return float(np.min(z * np.cos(angles) - aside * np.sin(angles)))


def check_swing(robot: Robot, supports: Sequence[Support], clearance: float | None) -> None:
    """Refuse a clearance of swinging feet above the length of the longest leg; no foot is lifted so high.

    Parameters
    ----------
    robot : Robot
    supports : sequence of Support
    clearance : float or None
        Height of swinging feet [m].

    Raises
    ------
    InputError
        The message has the length of the leg and a clearance that would do.
    """
    feet = dict.fromkeys(foot for support in supports for foot in support.feet)
    longest = max((leg_length(robot, foot) for foot in feet), default=np.inf)
    if clearance is None or clearance <= longest:
        return
    raise InputError(
        f"clearance={clearance:g} m lifts swinging feet by more than the leg of {robot.name!r}, which is "
        f"{longest:.3g} m long. clearance={LOW * longest:.2g} would do. Lengths are in metres: {clearance:g} mm are "
        f"{1e-3 * clearance:g}."
    )


def leg_length(robot: Robot, foot: str) -> float:
    """Return the length [m] of the links from the first joint of a leg to its foot; infinite where joints slide."""
    model, first = robot.model, len(root_of(robot.root).velocities)
    frame = model.frames[robot.frame(foot)]
    joints = [i for i in model.supports[frame.parentJoint] if i and model.joints[i].idx_v >= first]
    if not joints or any(robot.units[model.joints[i].idx_v] == "m" for i in joints):
        return float(np.inf)
    links = [*(model.jointPlacements[i].translation for i in joints[1:]), frame.placement.translation]
    return float(sum(np.linalg.norm(link) for link in links))
