"""Where a foot stops the fall of the linear inverted pendulum.

A pendulum of height h at x with speed v comes to rest above the capture point x + v sqrt(h / g), if it is pushed from
there. Played backwards, it comes from rest above x - v sqrt(h / g). On two point feet it can be pushed from the line
between them alone, so that this line passes through the capture point.
Source: Pratt, Carff, Drakunov, Goswami, Capture point: a step toward humanoid push recovery, Humanoids (2006).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import pendulum_time

BEYOND = 1.25
"""Distance of the other foot from the standing one, relative to that of the capture point.

The mass is not at the capture point when the foot lands, and comes to rest between the feet: it must be pushed from
beyond the capture point.
"""


def capture_point(stance: BalancedStance, q: Array, v: Array, backwards: bool) -> Array:
    """Return the capture point (3,) of a state, of which x and y have a meaning [m].

    Parameters
    ----------
    stance : BalancedStance
    q, v : ndarray (nq,), (nv,)
    backwards : bool
        Whether the motion comes from rest.
    """
    time = pendulum_time(stance, q)
    pin.centerOfMass(stance.robot.model, stance.data, q, v)
    com, speed = np.array(stance.data.com[0]), np.array(stance.data.vcom[0])
    return np.asarray(com - time * speed if backwards else com + time * speed)


def caught(standing: Mapping[str, float], point: Mapping[str, float]) -> dict[str, float]:
    """Return the foothold beyond the capture point by axis, on the line from the standing foot [m]."""
    return {axis: at + BEYOND * (point[axis] - at) for axis, at in standing.items()}
