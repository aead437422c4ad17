"""Forward simulation of a robot by plain double-precision Pinocchio (ABA)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.robot.configuration import unit_quaternion
from robotraj.robot.coupling.dynamics import accelerations
from robotraj.robot.root import QUATERNION
from robotraj.robot.tangent import floats, normalised
from robotraj.robot.tangent import rates as rates_of
from robotraj.witness.protocols import RobotLike
from robotraj.witness.simulation.integration import Rates, integrate
from robotraj.witness.simulation.spans import Motion

Torque = Callable[[float, int, Array, Array], ArrayLike]

Acceleration = Callable[[Array, Array, Array], Array]
"""``acceleration(q, v, applied)`` (nv,) under the torques applied to all joints."""

Push = Callable[[float, int, Array], Array]
"""``push(t, k, q)`` returns further torques (nv,) on all joints [N m, N]."""


@dataclass(frozen=True)
class Simulation(OneLine):
    """A simulated motion of a robot.

    Attributes
    ----------
    times : ndarray (m,)
        Sample times [s].
    q : ndarray (m, nq)
        Positions [rad, m].
    v : ndarray (m, nv)
        Velocities [rad/s, m/s].
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


def robot_rates(
    robot: RobotLike, torque: Torque, acceleration: Acceleration | None = None, push: Push | None = None
) -> Rates:
    """Return the rates of (q, v): q' and a = ABA(q, v, B tau - r(q, v)), r that of springs, damping, friction.

    q' is v; of a quaternion it is half its product with (omega, 0), omega in the body's axes. ``acceleration`` replaces
    ABA for robots with contacts, and ``push`` adds known forces.

    Pinocchio's own algorithms ignore springs, damping and friction, so they are subtracted from the torque.
    Source: Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 7.
    """
    model = robot.model
    data = model.createData()
    actuation = np.asarray(robot.actuation, dtype=float)
    nq = model.nq

    def by_aba(q: Array, v: Array, applied: Array) -> Array:
        return accelerations(model, data, q, v, applied)

    accelerate = acceleration or by_aba

    def rates(t: float, x: Array, k: int) -> Array:
        q, v = normalised(model, x[:nq]), x[nq:]
        applied = actuation @ np.asarray(torque(t, k, q, v), dtype=float) - robot.resistance(q, v)
        if push is not None:
            applied = applied + push(t, k, q)
        return np.concatenate([rates_of(model, x[:nq], v), accelerate(q, v, applied)])

    return rates


def simulate(
    robot: RobotLike,
    q0: ArrayLike,
    v0: ArrayLike,
    torque: Torque,
    t_span: tuple[float, float],
    knots: Sequence[float] | None = None,
    *,
    rtol: float = 1e-10,
    atol: float = 1e-12,
    samples_per_interval: int = 20,
) -> Simulation:
    """Integrate M(q) a + h(q, v) = B tau - d(v) by DOP853, or LSODA where it is stiff, restarted at every knot.

    Parameters
    ----------
    robot : Robot
    q0, v0 : array_like (nq,), (nv,)
        Initial positions [rad, m] and velocities [rad/s, m/s]; quaternions have length 1.
    torque : callable
        ``torque(t, k, q, v)`` returns the torques (nu,) [N m, N] of the actuated joints in interval k.
    t_span : (float, float)
        Begin and end [s].
    knots : sequence of float, optional
        Times at which the torque may have a corner or a jump; those outside ``t_span`` are ignored.
    rtol, atol : float
        Tolerances of each step.
    samples_per_interval : int
        Samples between two knots.

    Raises
    ------
    InputError
        Sizes or times do not match. ``Simulation.failure`` reports a diverging motion; no error is raised.
    """
    begin, end = float(t_span[0]), float(t_span[1])
    if not begin < end:
        raise InputError(f"t_span = ({begin:g}, {end:g}) s must run forward.")
    q = _vector(q0, robot.position_names, "q0")
    if floats(robot.model):
        q[QUATERNION] = unit_quaternion(q[QUATERNION], "q0")
    x0 = np.concatenate([q, _vector(v0, robot.velocity_names, "v0")])
    between = [float(t) for t in (knots if knots is not None else ()) if begin < t < end]
    times = np.array([begin, *sorted(between), end])
    motion = integrate(
        robot_rates(robot, torque), x0, times, rtol=rtol, atol=atol, samples_per_interval=samples_per_interval
    )
    return split(motion, robot.model)


def split(motion: Motion, model: pin.Model) -> Simulation:
    """Separate positions, with quaternions of length 1, from velocities."""
    q, v = normalised(model, motion.states[:, : model.nq]), motion.states[:, model.nq :]
    return Simulation(motion.times, q, v, motion.failure, motion.stopped)


def _vector(value: ArrayLike, names: Sequence[str], what: str) -> Array:
    array = np.array(value, dtype=float).ravel()
    if array.size != len(names):
        raise InputError(f"{what} has {array.size} values; it needs {len(names)}: {', '.join(names)}.")
    if not np.isfinite(array).all():
        joint = names[int(np.flatnonzero(~np.isfinite(array))[0])]
        raise InputError(f"{what} of joint {joint!r} is not finite; give a number.")
    return array
