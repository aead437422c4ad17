"""What gaits ask of their arguments, and of the ground that they repeat on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.dynamics.terrain.base import Ground
from robotraj.gait.upright import Upright
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.robot.robot import Robot

PERIODS = 3
"""Repetitions that a ground is looked at for."""
LEVEL_TO = 1e-3
"""How far the ground of one period may be from that of another [m]."""


def number(value: Any, name: str, unit: str = "m", advice: str = "") -> float:
    """Give a finite real number, or refuse what is none; ``name`` as in ``"rt.gait.jump(length)"``."""
    if isinstance(value, np.ndarray) and not value.ndim:
        value = value[()]
    if not isinstance(value, float | int | np.floating | np.integer) or isinstance(value, bool):
        raise InputError(f"{name} must be one number{unit and f' [{unit}]'}, got {value!r}.{advice and ' '}{advice}")
    if not np.isfinite(value):
        raise InputError(f"{name} must be finite, got {value!r}.")
    return float(value)


def share(value: Any, name: str) -> float:
    """Give a share of a step, from 0 to less than 1."""
    if not 0.0 <= number(value, name, "") < 1.0:
        raise InputError(f"{name} is {value!r}; give the share of a step, from 0 to less than 1.")
    return float(value)


def check_kinds(repeat: Any, upright: Any) -> None:
    """Refuse what is no repetition and no posture."""
    if repeat is not None and not isinstance(repeat, Mirror | Periodic):
        raise InputError(f"repeat= must be rt.gait.mirror(robot) or rt.Periodic(...), got {repeat!r}.")
    if upright is not None and not isinstance(upright, Upright):
        raise InputError(f"upright= must be rt.gait.Upright(...), or None for no bounds, got {upright!r}.")


def check_ground_repeats(
    robot: Robot, feet: Sequence[str], gains: Mapping[str, Any], mirrored: bool, ground: Ground
) -> None:
    """Refuse a ground that feet would find elsewhere than the period before: h(x + gain, +-y) = h(x, y) + rise.

    Looked at below the feet of the neutral configuration, for a few periods; nothing is known where a gain is free.
    """
    way, side, rise = (gains.get(f"q.root_{axis}", 0.0) for axis in "xyz")
    if not all(isinstance(gain, float | int | np.floating | np.integer) for gain in (way, side, rise)):
        return
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.neutral)
    for foot in feet:
        x, y = data.oMf[robot.frame(foot)].translation[:2]
        first = ground.height(float(x), float(y))
        for period in range(1, PERIODS + 1):
            there = (float(x + period * way), float((-y if mirrored and period % 2 else y) + period * side))
            off = float(ground.height(*there)) - float(first) - period * float(rise)
            if abs(off) > LEVEL_TO:
                raise InputError(
                    f"The gait repeats, and the ground does not: under {foot!r} it is {abs(off):.3g} m "
                    f"{'higher' if off > 0 else 'lower'} after {period} of its steps than they climb. Gaits repeat on "
                    "level ground, along slopes and on even stairs; write others out with rt.gait.sequence."
                )
