"""Inverse kinematics to poses of a frame, and minimum jerk between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.guess.base import InitialGuess, PhaseGuess
from robotraj.guess.ends import default_parameters, ends_of
from robotraj.guess.joint_motion import designed
from robotraj.guess.minimum_jerk import through
from robotraj.problem.objectives.terminal_pose import target_of
from robotraj.robot.root import QUATERNION
from robotraj.robot.tangent import PLACE, REST

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.robot.robot import Robot

Array = NDArray[np.float64]

CLOSE = 1e-8
"""Length of the error [m, rad] that counts as reached."""
STEPS = 300
"""Damped steps tried from one configuration."""
RESTARTS = 30
"""Seeded random configurations tried after the one nearby."""


@dataclass(frozen=True)
class InverseKinematics(InitialGuess):
    """Joint positions that bring a frame to a target at the end, and minimum jerk to them.

    Damped least squares from the start, then from seeded random configurations, inside the position limits of
    the phase and the bounds of its end. Torques are those of the inverse dynamics, as for ``rt.guess.MinimumJerk``.

    Parameters
    ----------
    frame : str
    target : sequence of 3 float, pinocchio.SE3 or (position, rotation)
        A position in the world [m], or a pose.
    waypoints : sequence of targets
        Passed before the target.
    fractions : sequence of float, optional
        Of start, waypoints and target, ascending from 0 to 1.
    duration : float, optional
        Guessed duration [s] where it is free.
    """

    frame: str
    target: Any
    waypoints: Sequence[Any] = ()
    fractions: Sequence[float] | None = None
    duration: float | None = None

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Solve the inverse kinematics and interpolate.

        Raises
        ------
        InputError
            The phase moves no robot, there is no such frame, or it cannot reach a target.
        """
        robot = phase.robot
        if robot is None:
            raise InputError(f"InverseKinematics needs a robot, but phase {phase.name!r} moves a System.")
        robot = designed(phase, default_parameters(phase))
        nq = robot.nq
        lower, upper = np.full(nq, -np.inf), np.full(nq, np.inf)
        if phase.limits is not None:
            lower, upper = phase.limits.positions  # type: ignore[union-attr]
        q = ends_of(phase)[0][:nq]
        reached = []
        for i, target in enumerate([*self.waypoints, self.target]):
            last = i == len(self.waypoints)
            if last:
                lower = np.maximum(lower, phase.end_bounds.lower[:nq])
                upper = np.minimum(upper, phase.end_bounds.upper[:nq])
            q = reach(robot, self.frame, target, q, lower, upper, "target" if last else f"waypoint {i}")
            reached.append(q)
        return through(phase, reached[:-1], self.fractions, self.duration, "InverseKinematics", reached[-1])


def reach(
    robot: Robot, frame: str, target: Any, near: Array, lower: Array, upper: Array, what: str = "target"
) -> Array:
    """Positions (nq,) that bring a frame to a target, the first found from ``near`` outwards.

    A floating root moves with the joints, but where its place or its quaternion is fixed.

    Parameters
    ----------
    robot : Robot
    frame : str
    target : sequence of 3 float, pinocchio.SE3 or (position, rotation)
    near, lower, upper : ndarray (nq,)
        Where to start and the bounds [rad, m].
    what : str
        What the target is, for errors.

    Raises
    ------
    InputError
        No configuration inside the bounds was found; the message names the frame, how far off the nearest one
        is, and the joints that stand at their bounds there.
    """
    index = robot.frame(frame)
    position, rotation = target_of(target, f"{what} of frame {frame!r}")
    rng = np.random.default_rng(0)
    low = np.where(np.isfinite(lower), lower, -np.pi)
    high = np.where(np.isfinite(upper), upper, np.pi)
    if robot.root == "floating":
        low[: QUATERNION.stop] = high[: QUATERNION.stop] = near[: QUATERNION.stop]
    best, least = near, np.inf
    for start in (near, *(rng.uniform(low, np.maximum(low, high)) for _ in range(RESTARTS))):
        q, gap = _descend(robot, index, position, rotation, np.clip(start, lower, upper), lower, upper)
        if gap < least:
            best, least = q, gap
        if least < CLOSE:
            return best
    at_bounds = [
        f"{joint} at {value:.4g} {unit}".rstrip()
        for joint, unit, value, lo, hi in zip(
            robot.position_names, robot.position_units, best, lower, upper, strict=True
        )
        if value - lo < 1e-6 or hi - value < 1e-6
    ]
    bounds = f" with {', '.join(at_bounds)} at a bound" if at_bounds else ""
    miss = _error(robot, robot.model.createData(), index, position, rotation, best)
    turned = f" and {np.linalg.norm(miss[3:]):.3g} rad" if rotation is not None else ""
    raise InputError(
        f"Frame {frame!r} of {robot.name!r} cannot reach the {what} {np.round(position, 6).tolist()}: the "
        f"nearest configuration found is {np.linalg.norm(miss[:3]):.3g} m{turned} away{bounds}. Move the "
        "target, or the bounds."
    )


def _descend(
    robot: Robot, index: int, position: Array, rotation: Array | None, q: Array, lower: Array, upper: Array
) -> tuple[Array, float]:
    """Damped least squares, dq = J' (J J' + m 1)^-1 e, with joints held where they would leave their bounds.

    Sources: Nakamura and Hanafusa, Journal of Dynamic Systems, Measurement, and Control 108 (1986); the
    damping m follows Marquardt, Journal of the Society for Industrial and Applied Mathematics 11 (1963).
    """
    data, damping = robot.model.createData(), 1e-3
    error = _error(robot, data, index, position, rotation, q)
    gap = float(np.linalg.norm(error))
    for _ in range(STEPS):
        if gap < CLOSE:
            break
        jacobian = pin.computeFrameJacobian(robot.model, data, q, index, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)[
            : len(error)
        ]
        pull = jacobian.T @ error
        held = jacobian * _free(robot, q, pull, lower, upper)
        step = held.T @ np.linalg.solve(held @ held.T + damping * np.eye(len(error)), error)
        trial = np.clip(pin.integrate(robot.model, q, step), lower, upper)
        after = _error(robot, data, index, position, rotation, trial)
        size = float(np.linalg.norm(after))
        if size < gap:
            q, error, gap, damping = trial, after, size, max(damping / 5.0, 1e-12)
        elif damping > 1e6:
            break
        else:
            damping *= 4.0
    return q, gap


def _free(robot: Robot, q: Array, pull: Array, lower: Array, upper: Array) -> NDArray[np.bool_]:
    """Entries of v (nv,) that push no position beyond a bound; a floating root's by its fixed parts."""
    if robot.root != "floating":
        return ~((q <= lower) & (pull < 0) | (q >= upper) & (pull > 0))
    joints, along = slice(QUATERNION.stop, None), pull[REST]
    at, low, high = q[joints], lower[joints], upper[joints]
    root = [not np.array_equal(lower[part], upper[part]) for part in (PLACE, QUATERNION)]
    return np.concatenate([np.repeat(root, 3), ~((at <= low) & (along < 0) | (at >= high) & (along > 0))])


def _error(robot: Robot, data: Any, index: int, position: Array, rotation: Array | None, q: Array) -> Array:
    """Way from the frame to the target [m], and the rotation vector between them in the world [rad]."""
    pin.framesForwardKinematics(robot.model, data, q)
    pose = data.oMf[index]
    gap = position - pose.translation
    if rotation is None:
        return np.asarray(gap)
    return np.concatenate([gap, pose.rotation @ pin.log3(pose.rotation.T @ rotation)])
