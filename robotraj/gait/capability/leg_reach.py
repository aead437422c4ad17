"""Steps that are longer than the legs reach.

A foot that stands during a whole step stays in place while the root moves on by the step. Its distance from the first
joint of the leg is at most the length l of the leg, so that the step is at most 2 l long. Where the root also turns
about that joint's place, the bound holds for the mean of the standing feet.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.errors import InputError
from robotraj.gait.supports import Support
from robotraj.robot.robot import Robot
from robotraj.robot.root import root_of

MODEST = 0.5
"""Part of the greatest step that a message names as one that would do."""
LOW = 0.1
"""Part of the length of a leg that a message names as a clearance that would do."""


def check_step(robot: Robot, phases: Sequence[Support], length: float, steps: float = 1.0) -> None:
    """Refuse a step during which a foot stands, but whose leg is shorter than half the step.

    Parameters
    ----------
    robot : Robot
    phases : sequence of Support
        Phases of one step.
    length : float
        Displacement of the root in these phases [m].
    steps : float
        Number of ``step_length=`` in it.

    Raises
    ------
    InputError
        The message has the length of the leg and a step length that would do.
    """
    standing = [foot for foot in phases[0].feet if all(foot in phase.feet for phase in phases)]
    lengths = {foot: leg_length(robot, foot) for foot in standing}
    if not lengths or abs(length) <= 2.0 * max(lengths.values()):
        return
    foot = max(lengths, key=lambda each: lengths[each])
    most, step = 2.0 * lengths[foot] / steps, abs(length) / steps
    meanwhile = "meanwhile" if steps == 1 else f"for {steps:g} of them"
    raise InputError(
        f"The step is {step:.3g} m long, but {foot!r} stands in place {meanwhile}, and the leg of {robot.name!r} "
        f"is {lengths[foot]:.3g} m long: a step is {most:.3g} m at most. "
        f"step_length={np.sign(length) * MODEST * most:.2g} would do, at a duration= that the joint speeds allow."
    )


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
