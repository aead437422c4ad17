"""Swings that are too short for the motors: an estimate from the speeds, torques and inertias of the legs.

A foot that moves by d from rest to rest, at most at the speed V and with the acceleration a, takes

    T = 2 sqrt(d / a)   if d <= V^2 / a,   else   d / V + V / a.

V and a are those of the foot relative to the root in the standing configuration, from rest and without gravity
(``leg_samples``). The root moves with the foot at the same speed at most, so that V is doubled. A foot that lands with
an impact does not brake, and covers twice the way. Bent legs accelerate faster, but lifting the foot and the load of
the other legs take torques: a1 needs between 0.9 and 1.4 T for a step aside. So swings far below T are refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.gait.capability.leg_samples import sample_legs
from robotraj.robot.robot import Robot

BEYOND = 1.5
"""Multiple of the estimated acceleration above which a swing is refused."""
MODEST = 3.0
"""Multiple of the estimated time that a message names as one that would do."""


def check_swing_time(
    robot: Robot,
    standing: Array,
    moves: Mapping[str, float],
    time: float,
    margin: float,
    remedy: Callable[[float], str],
    impact: bool = False,
) -> None:
    """Refuse a swing in which the motors cannot move the feet as far.

    Parameters
    ----------
    robot : Robot
    standing : ndarray (nq,)
        Standing configuration.
    moves : mapping of str to float
        Distance of each swinging foot [m].
    time : float
        Duration of the swing [s].
    margin : float
        Share of torques and speeds that the plan keeps back.
    remedy : callable
        From the duration of a swing that would do [s] to the option that has it, ``"swing=0.2"``.
    impact : bool
        Whether the feet may land with an impact, and need not brake.

    Raises
    ------
    InputError
        The message has the foot, its acceleration, the estimate, and a swing that would do.
    """
    feet = list(moves)
    samples = sample_legs(robot, feet, standing, 0.0, margin, 0)
    if samples is None:
        return
    axes: Sequence[tuple[float, float, float]] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    speeds = np.max([samples.speeds(axis)[:, 0] for axis in axes], axis=0)
    accelerations = np.max([samples.accelerations(axis) for axis in axes], axis=0)
    ways = [0.5 * way if impact else way for way in moves.values()]
    least = [_least_time(d, 2.0 * v, a) for d, v, a in zip(ways, speeds, BEYOND * accelerations, strict=True)]
    f = int(np.argmax(least))
    if time >= least[f]:
        return
    foot, way = feet[f], ways[f]
    enough = MODEST * _least_time(way, 2.0 * float(speeds[f]), float(accelerations[f]))
    raise InputError(
        f"{foot!r} swings over {moves[foot]:.3g} m in {time:.3g} s, which takes an acceleration of "
        f"{4.0 * way / time**2:.3g} m/s^2 at least. By the effort and velocity limits and the inertia of its leg, "
        f"{robot.name!r} accelerates it by about {accelerations[f]:.2g} m/s^2, up to {2.0 * speeds[f]:.2g} m/s. "
        f"{remedy(enough)} would do."
    )


def _least_time(way: float, speed: float, acceleration: float) -> float:
    """Return the least time from rest to rest [s]; 0 where the leg cannot move the foot along x or y at all."""
    if not way or not acceleration or not speed:
        return 0.0
    if way <= speed**2 / acceleration:
        return float(2.0 * np.sqrt(way / acceleration))
    return way / speed + speed / acceleration
