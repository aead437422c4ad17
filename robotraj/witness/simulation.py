"""Forward simulation of a robot by plain double-precision Pinocchio (ABA)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from robotraj.errors import InputError
from robotraj.witness.integration import Motion, Rates, integrate
from robotraj.witness.protocols import Array, RobotLike

Torque = Callable[[float, int, Array, Array], Any]

Acceleration = Callable[[Array, Array, Array], Array]
"""``acceleration(q, v, applied)`` (nv,) under the torques applied to all joints."""


@dataclass(frozen=True)
class Simulation:
    """A simulated motion of a robot.

    Attributes
    ----------
    times : ndarray (m,)
        Sample times [s].
    q, v : ndarray (m, nv)
        Joint positions [rad, m] and velocities [rad/s, m/s].
    failure : str or None
        Why the simulation stopped early, None if it reached the end.
    stopped : float
        Time reached [s].
    """

    times: Array
    q: Array
    v: Array
    failure: str | None
    stopped: float

    @property
    def success(self) -> bool:
        """Whether the simulation reached the end."""
        return self.failure is None


def robot_rates(robot: RobotLike, torque: Torque, acceleration: Acceleration | None = None) -> Rates:
    """Rates of (q, v): v and a = ABA(q, v, B tau - d(v)), with d the joint damping and friction.

    A robot whose contacts hold brings its own ``acceleration`` in the place of ABA.

    Pinocchio's own algorithms ignore damping and friction, so they are subtracted from the torque.
    Source: Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 7.
    """
    model = robot.model
    data = model.createData()
    actuation = np.asarray(robot.actuation, dtype=float)
    nv = robot.nv

    def by_aba(q: Array, v: Array, applied: Array) -> Array:
        return np.asarray(pin.aba(model, data, q, v, applied))

    accelerate = acceleration or by_aba

    def rates(t: float, x: Array, k: int) -> Array:
        q, v = x[:nv], x[nv:]
        applied = actuation @ np.asarray(torque(t, k, q, v), dtype=float) - robot.dissipation(v)
        return np.concatenate([v, accelerate(q, v, applied)])

    return rates


def simulate(
    robot: RobotLike,
    q0: Any,
    v0: Any,
    torque: Torque,
    t_span: tuple[float, float],
    knots: Sequence[float] | None = None,
    *,
    rtol: float = 1e-10,
    atol: float = 1e-12,
    samples_per_interval: int = 20,
) -> Simulation:
    """Integrate M(q) a + h(q, v) = B tau - d(v) with DOP853, restarted at every knot.

    Parameters
    ----------
    robot : Robot
    q0, v0 : array_like (nv,)
        First positions [rad, m] and velocities [rad/s, m/s].
    torque : callable
        ``torque(t, k, q, v)`` gives the torques (nu,) [N m, N] of the actuated joints in interval k.
    t_span : (float, float)
        Begin and end [s].
    knots : sequence of float, optional
        Times where the torque may have a corner or a jump; those outside ``t_span`` are dropped.
    rtol, atol : float
        Tolerances of each step.
    samples_per_interval : int
        Samples kept between two knots.

    Raises
    ------
    InputError
        Sizes or times do not fit. A motion that blows up is reported in ``Simulation.failure``, not raised.
    """
    begin, end = float(t_span[0]), float(t_span[1])
    if not begin < end:
        raise InputError(f"t_span = ({begin:g}, {end:g}) s must run forward.")
    x0 = np.concatenate([_vector(q0, robot.nv, "q0", robot), _vector(v0, robot.nv, "v0", robot)])
    between = [float(t) for t in (knots if knots is not None else ()) if begin < t < end]
    times = np.array([begin, *sorted(between), end])
    motion = integrate(
        robot_rates(robot, torque), x0, times, rtol=rtol, atol=atol, samples_per_interval=samples_per_interval
    )
    return split(motion, robot.nv)


def split(motion: Motion, nv: int) -> Simulation:
    """Separate positions from velocities."""
    return Simulation(motion.times, motion.states[:, :nv], motion.states[:, nv:], motion.failure, motion.stopped)


def _vector(value: Any, size: int, what: str, robot: RobotLike) -> Array:
    array = np.asarray(value, dtype=float).ravel()
    if array.size != size:
        raise InputError(f"{what} has {array.size} values; it needs {size}: {', '.join(robot.joint_names)}.")
    if not np.isfinite(array).all():
        joint = robot.joint_names[int(np.flatnonzero(~np.isfinite(array))[0])]
        raise InputError(f"{what} of joint {joint!r} is not finite; give a number.")
    return array
