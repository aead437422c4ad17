"""Samples, Systems and joint limits of planned phases, with their exact types."""

from __future__ import annotations

from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj.dynamics.variable import Named
from robotraj.robot.limits import Limits
from robotraj.witness.protocols import PhaseSolutionLike, SystemLike


class RobotSample(NamedTuple):
    """The plan of a robot at m times.

    Attributes
    ----------
    q, v, a : ndarray (m, nq), (m, nv), (m, nv)
    tau : ndarray (m, nu)
    z, forces : Named
        Algebraic variables (m,) and contact forces (m, 3) or (m, 6) by name.
    """

    q: Array
    v: Array
    a: Array
    tau: Array
    z: Named[float | Array]
    forces: Named[Array]


def robot_sample(
    planned: PhaseSolutionLike, times: Array, interval: int | NDArray[np.int_] | None = None
) -> RobotSample:
    """Sample the phase of a robot at times (m,)."""
    sample = planned.at(times, interval=interval)
    return RobotSample(sample.q, sample.v, sample.a, sample.tau, sample.z, sample.forces)


def system_of(planned: PhaseSolutionLike) -> SystemLike:
    """Return the System of a phase that has one."""
    system = planned.phase.system
    assert system is not None
    return system


def limits_of(planned: PhaseSolutionLike) -> Limits | None:
    """Return the joint limits that the phase imposes, None without any."""
    return cast("Limits | None", planned.phase.limits)
