"""Flips that legs cannot do: the energy at take-off.

A flight that rises by h takes T = sqrt(8 h / g). In it a robot with the radius of gyration k turns at 2 pi / T, so that
its energy at take-off, relative to its weight, is

    h + k^2 (2 pi / T)^2 / (2 g) = h + c^2 / h,     c = pi k / 2.

It is least for h = c, where it is 2 c. The legs give about the energy of the highest vertical jump
(``take_off.rise_of``). k is that of the standing robot. Tucked legs and a turn that begins on the ground reduce what is
needed, so that requests far above the estimate are refused.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.gait.capability.take_off import greatest_rise
from robotraj.robot.robot import Robot

BEYOND = 1.5
"""Multiple of the estimate above which a turn is refused."""


def height_of_least_energy(robot: Robot, standing: Array, axis: Sequence[float]) -> float:
    """Return c, the rise of the centre of mass for which a turn takes the least energy at take-off [m]."""
    data = robot.model.createData()
    pin.ccrba(robot.model, data, standing, np.zeros(robot.nv))
    inertia = float(np.asarray(axis) @ np.asarray(data.Ig.inertia) @ np.asarray(axis))
    return float(0.5 * np.pi * np.sqrt(inertia / robot.mass))


def check_turn(
    robot: Robot,
    feet: Sequence[str],
    standing: Array,
    height: float,
    axis: Sequence[float],
    friction: float,
    margin: float,
) -> None:
    """Refuse a turn whose energy at take-off is far above the estimate of what the legs give.

    Parameters
    ----------
    robot : Robot
    feet : sequence of str
    standing : ndarray (nq,)
    height : float
        Rise of the centre of mass in flight [m].
    axis : (float, float, float)
        Unit vector.
    friction, margin
        As for ``sample_legs``.

    Raises
    ------
    InputError
        The message has the rise with the same energy, the estimate, and a height or an effort that would do.
    """
    least = height_of_least_energy(robot, standing, axis)
    needed, most = height + least**2 / height, greatest_rise(robot, feet, standing, friction, margin)
    if needed <= BEYOND * most:
        return
    air = np.sqrt(8.0 * height / float(np.linalg.norm(robot.model.gravity.linear)))
    remedy = (
        f"height={least:.2g} needs that of {2.0 * least:.2g} m and would do."
        if 2.0 * least <= most
        else f"Any flip needs that of {2.0 * least:.2g} m; give motors with higher limits."
    )
    raise InputError(
        f"rt.gait.flip(height) is {height:.3g} m: one turn in {air:.2g} s of flight needs the energy of a rise by "
        f"{needed:.2g} m at take-off. By the effort and velocity limits of its legs and its weight, {robot.name!r} "
        f"rises by about {most:.2g} m at most. {remedy}"
    )
