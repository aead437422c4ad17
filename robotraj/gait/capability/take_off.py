"""How high and how far a robot can jump at most: an estimate from the torques and speeds of its legs.

The root stays level and the legs have no mass. The centre of mass is accelerated over the heights z of the root, from
the lowest to the highest at which all feet reach the ground,

    d(v^2 / 2) / dz = sum_feet max_{V >= v} F(z) / m - g,

with the best of seeded random configurations at each height (``leg_samples``): F is the vertical force of a foot, V the
greatest speed at which the root rises above it. The legs still push at the speed v that is reached above each height,
so that a straight leg, which carries any load, adds no more than its speed. The centre of mass rises by v^2 / (2 g) at
most. Over a length L, it moves at least L - R in a flight of the time T, where R is the range of the feet below the
root along x. Its take-off speed is at least that of a vertical jump of the height

    h + ((L - R) / T)^2 / (2 g).

The mass of the legs and the time for their motion reduce what is reached to about half, so that requests above the
estimate are refused.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, warn
from robotraj.gait.capability.leg_samples import LegSamples, sample_legs
from robotraj.robot.robot import Robot
from robotraj.robot.size.reach import reach

LEVELS = 30
"""Number of heights."""
HALVINGS = 20
"""Number of bisections for the speed above a height."""
MODEST = 0.2
"""Multiple of the estimate that a message names as one that would do."""
FAR = 10.0
"""Height or length of a jump relative to the robot's reach above which its unit is doubtful."""
EASY = 0.25
"""Height relative to the robot's reach up to which nothing is estimated."""


def check_take_off(
    robot: Robot, feet: Sequence[str], standing: Array, height: float, length: float, friction: float, margin: float
) -> None:
    """Refuse a jump that is higher or farther than the estimate.

    Raises
    ------
    InputError
        The message has the speed at take-off, the estimate, and a height that would do; for a long jump also a length.

    Warns
    -----
    UserWarning
        The jump is out of proportion to the robot, as heights in centimetres are.
    """
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    air = np.sqrt(8.0 * height / gravity)
    as_height = height + (length / air) ** 2 / (2.0 * gravity)
    if as_height <= EASY * reach(robot.model):
        return
    size = max(height, abs(length))
    if size > FAR * reach(robot.model) > 0.0:
        warn(
            f"The jump goes over {size:.3g} m, and {robot.name!r} reaches {reach(robot.model):.2g} m. Lengths are in "
            "metres: 20 cm are 0.2."
        )
    samples = sample_legs(robot, feet, standing, friction, margin)
    if samples is None:
        return
    flown = max(abs(length) - _stride(samples), 0.0)
    as_height = height + (flown / air) ** 2 / (2.0 * gravity)
    most = rise_of(robot, samples)
    if as_height <= most:
        return
    asked = f"height) is {height:g} m" if not flown else f"length) is {length:g} m at a height of {height:.2g} m"
    if flown:
        # By ballistics v^2 / g = 2 h is the range of a flight that rises by h / 2.
        far, high = np.sign(length) * 2.0 * MODEST * most, 0.5 * MODEST * most
        remedy = f"length={far:.2g} with height={high:.2g} would do."
    else:
        remedy = f"height={MODEST * most:.2g} would do."
    raise InputError(
        f"rt.gait.jump({asked}, a take-off at {np.sqrt(2.0 * gravity * as_height):.3g} m/s. By the effort and velocity "
        f"limits of its legs and its weight, {robot.name!r} rises by about {most:.2g} m at most, a take-off at "
        f"{np.sqrt(2.0 * gravity * most):.2g} m/s. {remedy}"
    )


def greatest_rise(robot: Robot, feet: Sequence[str], standing: Array, friction: float, margin: float) -> float:
    """Return the estimated greatest rise of the centre of mass [m]; infinite where a motor has no limit.

    The parameters are those of ``sample_legs``.
    """
    samples = sample_legs(robot, feet, standing, friction, margin)
    return np.inf if samples is None else rise_of(robot, samples)


def rise_of(robot: Robot, samples: LegSamples) -> float:
    """Return the estimated greatest rise of the centre of mass [m] for samples of the legs."""
    if not np.isfinite(samples.forces).all():
        return float(np.inf)
    heights, forces, rates = -samples.places[:, :, 2], samples.forces, samples.speeds((0.0, 0.0, 1.0))
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    step = float(heights.max(axis=1).min()) / LEVELS
    squared = best = 0.0
    for level in step * np.arange(LEVELS):
        near = np.where((heights >= level) & (heights < level + step), rates, -1.0)
        low, high = 0.0, float(near.max(axis=1).min()) ** 2
        for _ in range(HALVINGS if high > 0.0 else 0):
            middle = 0.5 * (low + high)
            push = float(np.where(near >= np.sqrt(middle), forces, 0.0).max(axis=1).sum())
            reached = middle <= squared + 2.0 * (push / robot.mass - gravity) * step
            low, high = (middle, high) if reached else (low, middle)
        squared = low
        best = max(best, squared)
    return best / (2.0 * gravity)


def _stride(samples: LegSamples) -> float:
    """Return the range of the feet below the root along x [m], by which it moves before and after a flight."""
    shifts = samples.places[:, :, 0] - samples.places[:, :1, 0]
    below = samples.places[:, :, 2] < 0.0
    return float(np.max(shifts, where=below, initial=0.0) - np.min(shifts, where=below, initial=0.0))
