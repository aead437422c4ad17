"""Simulation of a plan with joint feedback, as a controller of the machine adds it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, require_solution
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.robot.tangent import difference
from robotraj.witness.checks.residual import TORQUE_UNITS
from robotraj.witness.peak import Peak, largest, peaks
from robotraj.witness.plants.robot_plant import RobotPlant
from robotraj.witness.plants.sizes import sizes_of
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.simulation import drift as drifts
from robotraj.witness.simulation.drift import Drift, DriftRow, drift_of
from robotraj.witness.simulation.integration import integrate
from robotraj.witness.simulation.simulate import split


@dataclass(frozen=True)
class TrackingResult(OneLine):
    """The motion of a robot under a plan and joint feedback.

    Attributes
    ----------
    error : Drift
        By state: final and largest distance between the simulated and the planned motion.
    feedback : mapping of str to Peak
        By actuated joint: largest torque that the feedback added [N m, N].
    failure : str or None
        Why and when the simulation stopped early; None if it did not.
    """

    error: Drift
    feedback: dict[str, Peak]
    failure: str | None

    def __str__(self) -> str:
        """Return the largest error, the largest added torque, and when and why the simulation stopped."""
        error, added = self.error.worst, max(self.feedback.values(), key=lambda peak: peak.value)
        return (
            f"With feedback: {error.name} by {error.largest:.3g} {error.unit} from the plan at t = {error.time:.4g} s "
            f"in phase {error.phase!r}; the feedback adds {added.value:.3g} {added.unit} at most, {added.name}."
            + (f" Stopped: {self.failure}" if self.failure else "")
        )


def track(
    solution: SolutionLike,
    kp: float | Sequence[float],
    kd: float | Sequence[float],
    *,
    offset: ArrayLike = 0.0,
    rtol: float = 1e-8,
    atol: float = 1e-10,
    samples_per_interval: int = 10,
) -> TrackingResult:
    """Simulate tau = tau_plan + kp (q_plan - q) + kd (v_plan - v) of the actuated joints.

    Open-loop drift of an unstable motion grows on any mesh; feedback may keep it small. Contacts hold and touch down
    at the planned times, as in ``validate``.

    Parameters
    ----------
    solution : Solution
        Of a robot.
    kp, kd : float or sequence (nu,)
        Gains [N m/rad, N/m] and [N m s/rad, N s/m], at least 0.
    offset : float or array_like (2 nv,)
        Disturbance of the first state of the plan: of q in the tangent space (``pin.integrate``), then of v.
    rtol, atol, samples_per_interval
        As for ``simulate``.

    Raises
    ------
    InputError
        The solution moves a System, or the number of gains is not that of the actuated joints.
    """
    require_solution(solution, "rt.witness.track")
    if not solution.phases or any(planned.phase.robot is None for planned in solution.phases):
        raise InputError("The solution moves a System, and track() adds joint feedback to robots: use validate().")
    rows: list[tuple[DriftRow, ...]] = []
    added: list[dict[str, Peak]] = []
    x: Array | None = None
    failure = None
    for planned, sizes in zip(solution.phases, sizes_of(solution), strict=True):
        robot, plant = realised(planned), RobotPlant(planned)
        gains = _gains(kp, "kp", robot.actuated), _gains(kd, "kd", robot.actuated)
        knots = np.asarray(planned.knots, dtype=float)
        if x is None:
            x = _moved(robot.model, plant.states(knots[:1], 0)[0], offset)
        matrix = np.asarray(robot.actuation, dtype=float).T
        gain = np.hstack([gains[0][:, None] * matrix, gains[1][:, None] * matrix])
        follower = RobotPlant(planned, partial(_always, gain))
        x, _ = follower.begin(x)

        def rates(t: float, state: Array, k: int, follower: RobotPlant = follower) -> Array:
            return follower.rate(t, state, follower.given(np.array([t]))[0])

        motion = integrate(
            rates,
            x,
            knots,
            rtol=rtol,
            atol=atol,
            samples_per_interval=samples_per_interval,
            settle=plant.settle,
        )
        simulation = split(motion, robot.model)
        sample = [planned.at(t, interval=int(k)) for t, k in zip(motion.times, motion.intervals, strict=True)]
        away = np.hstack(
            [
                difference(robot.model, np.array([s.q for s in sample]), simulation.q),
                simulation.v - np.array([s.v for s in sample]),
            ]
        )
        torques = -away @ gain.T
        unit = dict(zip(robot.velocity_names, robot.units, strict=True))
        units = [TORQUE_UNITS[unit[joint]] for joint in robot.actuated]
        added.append(peaks(robot.actuated, units, motion.times, torques, planned.phase.name))
        rows.append(drift_of(plant, motion, planned.phase.name, sizes))
        x = motion.states[-1]
        if motion.failure is not None:
            failure = f"phase {planned.phase.name!r}, t = {motion.stopped:.4g} s: {motion.failure}"
            break
    return TrackingResult(drifts.merge(rows), largest(added), failure)


def _always(gain: Array, times: Array) -> Array:
    """Return one gain for all times."""
    return np.broadcast_to(gain, (len(times), *gain.shape))


def _moved(model: pin.Model, x: Array, offset: ArrayLike) -> Array:
    """Return a state (q, v) moved by an offset (2 nv,)."""
    nq, nv = model.nq, model.nv
    try:
        away = np.array(np.broadcast_to(np.asarray(offset, dtype=float).ravel(), 2 * nv))
    except ValueError as error:
        raise InputError(f"offset has {np.size(offset)} values; give one, or {2 * nv} of q and v.") from error
    return np.concatenate([pin.integrate(model, x[:nq], away[:nv]), x[nq:] + away[nv:]])


def _gains(value: ArrayLike, what: str, joints: Sequence[str]) -> Array:
    array = np.asarray(value, dtype=float).ravel()
    if array.size not in (1, len(joints)):
        raise InputError(f"{what} has {array.size} values; give one, or one for each of: {', '.join(joints)}.")
    if not (np.isfinite(array).all() and (array >= 0).all()):
        raise InputError(f"{what} = {value!r} must be finite and at least 0.")
    return np.broadcast_to(array, (len(joints),)).copy()
