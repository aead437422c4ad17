"""Checks of the arguments of gaits, and of the ground on which they repeat."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.dynamics.terrain.base import Ground
from robotraj.gait.bounds.upright import Upright
from robotraj.problem.constraints.bounds import Between, Interval
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.robot.robot import Robot

TimeSpan = float | Sequence[float | None] | Between
"""A fixed duration [s], or bounds of a free one; None leaves a side open."""

PERIODS = 3
"""Number of periods for which the height of the ground is compared."""
HEIGHT_TOLERANCE = 1e-3
"""Largest difference of the ground's height between periods [m]."""


def number(value: object, name: str, unit: str = "m", advice: str = "") -> float:
    """Return a finite real number; ``name`` is for messages, as ``"rt.gait.jump(length)"``.

    Raises
    ------
    InputError
        The value is no finite number.
    """
    if isinstance(value, np.ndarray) and not value.ndim:
        value = value[()]
    if not isinstance(value, float | int | np.floating | np.integer) or isinstance(value, bool):
        raise InputError(f"{name} must be one number{unit and f' [{unit}]'}, got {value!r}.{advice and ' '}{advice}")
    if not np.isfinite(value):
        raise InputError(f"{name} must be finite, got {value!r}.")
    return float(value)


def positive(value: object, default: float, name: str) -> float:
    """Return a positive duration [s], by default ``default``.

    Raises
    ------
    InputError
        The value is not positive.
    """
    found = default if value is None else number(value, name, "s")
    if not found > 0.0:
        raise InputError(f"{name} is {value!r}; give a positive duration [s].")
    return found


def fraction(value: object, name: str) -> float:
    """Return a fraction of a step, from 0 to less than 1.

    Raises
    ------
    InputError
        The value is outside that range.
    """
    found = number(value, name, "")
    if not 0.0 <= found < 1.0:
        raise InputError(f"{name} is {value!r}; give the fraction of a step, from 0 to less than 1.")
    return found


def check_options(repeat: object, upright: object) -> None:
    """Raise an InputError if ``repeat`` is no repetition, or ``upright`` no bounds."""
    if repeat is not None and not isinstance(repeat, Mirror | Periodic):
        raise InputError(f"repeat= must be rt.gait.mirror(robot) or rt.Periodic(...), got {repeat!r}.")
    if upright is not None and not isinstance(upright, Upright):
        raise InputError(f"upright= must be rt.gait.Upright(...), or None for no bounds, got {upright!r}.")


def check_ground_repeats(
    robot: Robot, feet: Sequence[str], gains: Mapping[str, Interval], mirrored: bool, ground: Ground
) -> None:
    """Check that the ground repeats with the gait: h(x + gain, +-y) = h(x, y) + rise.

    Heights are compared under the feet of the neutral configuration, for a few periods. A free gain is not checked.

    Raises
    ------
    InputError
        The height of the ground under a foot differs between periods.
    """
    known = [gains.get(f"q.root_{axis}", 0.0) for axis in "xyz"]
    fixed = [float(gain) for gain in known if isinstance(gain, float | int | np.floating | np.integer)]
    if len(fixed) < len(known):
        return
    forward, side, rise = fixed
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.neutral)
    for foot in feet:
        x, y = data.oMf[robot.frame(foot)].translation[:2]
        first = ground.height(float(x), float(y))
        for period in range(1, PERIODS + 1):
            there = (float(x + period * forward), float((-y if mirrored and period % 2 else y) + period * side))
            off = float(ground.height(*there)) - float(first) - period * rise
            if abs(off) > HEIGHT_TOLERANCE:
                raise InputError(
                    f"The gait repeats, but the ground does not: after {period} periods it is {abs(off):.3g} m "
                    f"{'higher' if off > 0 else 'lower'} under {foot!r} than the gait. Gaits repeat on level ground, "
                    "on slopes and on regular stairs; write other motions with rt.gait.sequence."
                )


def check_free_root(robot: Robot) -> None:
    """Refuse a robot that is fixed in the world.

    Raises
    ------
    InputError
        Its root is fixed.
    """
    if robot.root == "fixed":
        raise InputError(
            f"{robot.name!r} is fixed in the world; load it with root='floating', or root='planar' for motion in the "
            "x-z plane."
        )


def step_timing(
    length: float | None, duration: TimeSpan | None, speed: float | None, what: str
) -> tuple[float, TimeSpan]:
    """Return step length [m] and duration [s] from two of length, duration and speed.

    Raises
    ------
    InputError
        Not exactly two of them are given, or they are no numbers.
    """
    if sum(value is not None for value in (length, duration, speed)) != 2:
        raise InputError(f"rt.gait.{what} needs two of step_length=, duration= and speed=; give exactly two.")
    if length is not None:
        advice = "A free length is a displacement: repeat=rt.Periodic(displacement={'q.root_x': rt.between(...)})."
        length = number(length, f"rt.gait.{what}(step_length)", advice=advice)
    if speed is None:
        assert length is not None and duration is not None
        return length, duration
    speed = number(speed, f"rt.gait.{what}(speed)", "m/s")
    if length is None:
        if isinstance(duration, Sequence):
            raise InputError(f"rt.gait.{what}: duration= is {duration!r} beside speed=; give one number [s].")
        time = number(duration, f"rt.gait.{what}(duration)", "s")
        return speed * time, time
    if not speed > 0.0:
        raise InputError(f"rt.gait.{what}: speed= is {speed!r} beside a step length; give a positive speed [m/s].")
    return length, length / speed
