"""Loads that legs cannot carry: an estimate from the torques of the legs.

Over a motion that repeats, the mean vertical force of the ground is the weight. So

    m g <= sum over feet of b F,

where b is the share of the time in which a foot stands, and F its greatest vertical force by the effort limits of its
leg, in the best of seeded random configurations (``leg_samples``). Straight and folded legs, which carry any load, are
left out. At rest, the same holds for the forces in that configuration. Inertia and dry friction are omitted, so that
weights far above the estimate are refused.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.gait.capability.leg_samples import LegSamples, sample_legs
from robotraj.gait.supports import Support
from robotraj.robot.robot import Robot

BENT = (0.5, 0.95)
"""Least height of the root above a foot, and greatest length of its leg, relative to a straight leg."""
BEYOND = 1.5
"""Multiple of the estimate above which a weight is refused."""
EASY = 0.5
"""Part of the load of the standing legs up to which nothing is estimated."""
MODEST = 0.5
"""Part of the estimate that a message names as one that would do."""


def check_rest(robot: Robot, feet: Sequence[str], standing: Array, friction: float, margin: float) -> None:
    """Refuse a motion from a standing configuration in which the legs cannot carry the robot.

    The parameters are those of ``sample_legs``.

    Raises
    ------
    InputError
        The message has the weight, the estimate, and a mass that would do.
    """
    at_rest = sample_legs(robot, feet, standing, friction, margin, 0)
    if at_rest is not None:
        _compare(robot, float(at_rest.forces[:, 0].sum()), "in the configuration in which it stands")


def check_weight(
    robot: Robot,
    supports: Sequence[Support],
    spans: Sequence[tuple[float, float]],
    feet: Sequence[str],
    standing: Array,
    friction: float,
    margin: float,
) -> None:
    """Refuse a motion in which the legs cannot carry the robot.

    Parameters
    ----------
    robot : Robot
    supports : sequence of Support
        Phases of a motion that repeats.
    spans : sequence of (float, float)
        Least and greatest durations of the phases [s].
    feet : sequence of str
    standing, friction, margin
        As for ``sample_legs``.

    Raises
    ------
    InputError
        The message has the weight, the estimate, and a mass that would do.
    """
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    at_rest = sample_legs(robot, feet, standing, friction, margin, 0)
    if at_rest is None or robot.mass * gravity <= EASY * _carried(at_rest.forces[:, 0], supports, spans, feet):
        return
    samples = sample_legs(robot, feet, standing, friction, margin)
    assert samples is not None
    _compare(robot, _carried(bent_forces(samples), supports, spans, feet), "in this gait")


def check_push(
    robot: Robot,
    feet: Sequence[str],
    standing: Array,
    rise: float,
    time: float,
    friction: float,
    margin: float,
    remedy: Callable[[float], str],
) -> None:
    """Refuse a push in which the legs cannot give the speed of a take-off.

    From rest to the speed sqrt(2 g h), at which the centre of mass rises by h, the mean vertical force over the time T
    is  m (g + sqrt(2 g h) / T).

    Parameters
    ----------
    robot : Robot
    feet : sequence of str
        Frames of the feet that push.
    standing, friction, margin
        As for ``sample_legs``.
    rise : float
        Rise of the centre of mass in flight [m].
    time : float
        Duration of the push [s].
    remedy : callable
        From the duration of a push that would do [s] to the option that has it, ``"push=0.2"``.

    Raises
    ------
    InputError
        The message has the force, the estimate, and a push that would do.
    """
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    speed = np.sqrt(2.0 * gravity * rise)
    needed = robot.mass * (gravity + speed / time)
    at_rest = sample_legs(robot, feet, standing, friction, margin, 0)
    if at_rest is None or needed <= EASY * float(at_rest.forces[:, 0].sum()):
        return
    samples = sample_legs(robot, feet, standing, friction, margin)
    assert samples is not None
    most = float(bent_forces(samples).sum())
    if needed <= BEYOND * most:
        return
    left = MODEST * most / robot.mass - gravity
    raise InputError(
        f"The push of {time:.3g} s to a take-off at {speed:.3g} m/s takes {needed:.3g} N. By the effort limits of its "
        f"legs, {robot.name!r} pushes with about {most:.2g} N at most. "
        f"{remedy(speed / left if left > 0.0 else np.inf)} would do."
    )


def _compare(robot: Robot, most: float, where: str) -> None:
    """Refuse a robot that weighs more than the greatest load [N]."""
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    if robot.mass * gravity <= BEYOND * most:
        return
    raise InputError(
        f"{robot.name!r} weighs {robot.mass * gravity:.3g} N ({robot.mass:.3g} kg with what it carries). By the effort "
        f"limits of its legs, it carries about {most:.2g} N at most {where}. {MODEST * most / gravity:.2g} kg would "
        f"do, or effort limits {robot.mass * gravity / (MODEST * most):.2g} times as large."
    )


def _carried(
    forces: Array, supports: Sequence[Support], spans: Sequence[tuple[float, float]], feet: Sequence[str]
) -> float:
    """Return the greatest mean of the forces [N]; with free durations, that of the phase that carries most."""
    loads = [sum(float(forces[f]) for f, foot in enumerate(feet) if foot in support.feet) for support in supports]
    if any(least < greatest for least, greatest in spans):
        return max(loads)
    return sum(load * time for load, (time, _) in zip(loads, spans, strict=True) if load) / sum(t for t, _ in spans)


def bent_forces(samples: LegSamples) -> Array:
    """Return the greatest force of each foot with a bent leg [N]."""
    straight = samples.lengths.max(axis=1, keepdims=True)
    bent = (samples.lengths <= BENT[1] * straight) & (samples.places[:, :, 2] <= -BENT[0] * straight)
    return np.asarray(np.max(samples.forces, axis=1, where=bent, initial=0.0))
