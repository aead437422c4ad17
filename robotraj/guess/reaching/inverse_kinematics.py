"""Inverse kinematics to poses of a frame, with minimum-jerk motions between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.precision import MET, SAME
from robotraj._util.values import dataclass
from robotraj.guess.ends import default_parameters, ends_of
from robotraj.guess.joint_motion import designed
from robotraj.guess.minimum_jerk import through
from robotraj.guess.reaching.descent import SEEDS, descended
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess
from robotraj.problem.objectives.terminal_pose import target_of
from robotraj.problem.phase import Phase
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION

Target: TypeAlias = "ArrayLike | tuple[ArrayLike, ArrayLike] | pin.SE3"
"""A position in the world [m], or a pose."""


@dataclass(frozen=True)
class InverseKinematics(InitialGuess):
    """Joint positions at which a frame reaches a target, and the minimum-jerk motion to them.

    Damped least squares (``guess.reaching.descent``) start at the first configuration, then at seeded random ones.
    All are inside the position limits of the phase and the bounds of its end. Torques are those of the inverse
    dynamics, as for ``rt.guess.MinimumJerk``.

    Parameters
    ----------
    frame : str
    target : sequence of 3 float, pinocchio.SE3 or (position, rotation)
        A position in the world [m], or a pose.
    waypoints : sequence of targets
        Targets that the frame passes before the last one, in order.
    fractions : sequence of float, optional
        Places of start, waypoints and target in the phase, ascending from 0 to 1.
    duration : float, optional
        Guessed duration [s] where it is free.
    """

    frame: str
    target: Target
    waypoints: Sequence[Target] = ()
    fractions: Sequence[float] | None = None
    duration: float | None = None

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Solve the inverse kinematics and interpolate.

        Raises
        ------
        InputError
            The phase moves a System, the robot has no such frame, or the frame cannot reach a target.
        """
        robot = phase.robot
        if robot is None:
            raise InputError(
                f"InverseKinematics needs a robot, but phase {phase.name!r} moves a System; use another guess."
            )
        robot = designed(phase, default_parameters(phase))
        nq = robot.nq
        lower, upper = np.full(nq, -np.inf), np.full(nq, np.inf)
        if isinstance(phase.limits, Limits):
            lower, upper = phase.limits.positions
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
    robot: Robot, frame: str, target: Target, near: Array, lower: Array, upper: Array, what: str = "target"
) -> Array:
    """Return positions (nq,) at which a frame reaches a target; the search starts at ``near``.

    A floating root moves as well, unless the bounds fix its position or its quaternion.

    Parameters
    ----------
    robot : Robot
    frame : str
    target : sequence of 3 float, pinocchio.SE3 or (position, rotation)
    near, lower, upper : ndarray (nq,)
        First iterate and bounds [rad, m].
    what : str
        Name of the target in error messages.

    Raises
    ------
    InputError
        No configuration inside the bounds was found. The message names the frame, the least distance, and the joints
        that are at their bounds there.
    """
    index = robot.frame(frame)
    position, rotation = target_of(target, f"{what} of frame {frame!r}")
    rng = np.random.default_rng(0)
    low = np.where(np.isfinite(lower), lower, -np.pi)
    high = np.where(np.isfinite(upper), upper, np.pi)
    if robot.root == "floating":
        low[: QUATERNION.stop] = high[: QUATERNION.stop] = near[: QUATERNION.stop]
    data = robot.model.createData()

    def errors(q: Array) -> tuple[Array, Array]:
        gap = _error(robot, data, index, position, rotation, q[0])
        axes = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        return gap[None], pin.computeFrameJacobian(robot.model, data, q[0], index, axes)[None, : len(gap)]

    best, least = near, np.inf
    for start in (near, *(rng.uniform(low, np.maximum(low, high)) for _ in range(SEEDS - 1))):
        found, missed = descended(errors, start[None], (lower, upper), model=robot.model)
        gap = float(np.linalg.norm(missed))
        if gap < least:
            best, least = found[0], gap
        if least < SAME:
            break
    if least < MET:
        return best
    at_bounds = [
        f"{joint} at {value:.4g} {unit}".rstrip()
        for joint, unit, value, lo, hi in zip(
            robot.position_names, robot.position_units, best, lower, upper, strict=True
        )
        if value - lo < MET or hi - value < MET
    ]
    bounds = f" with {', '.join(at_bounds)} at a bound" if at_bounds else ""
    miss = _error(robot, robot.model.createData(), index, position, rotation, best)
    turned = f" and {np.linalg.norm(miss[3:]):.3g} rad" if rotation is not None else ""
    raise InputError(
        f"Frame {frame!r} of {robot.name!r} cannot reach the {what} {np.round(position, 6).tolist()}: the "
        f"nearest configuration found is {np.linalg.norm(miss[:3]):.3g} m{turned} away{bounds}. Move the "
        "target, or widen the bounds."
    )


def _error(robot: Robot, data: pin.Data, index: int, position: Array, rotation: Array | None, q: Array) -> Array:
    """Return the displacement from frame to target [m] and, for poses, the rotation vector in world axes [rad]."""
    pin.framesForwardKinematics(robot.model, data, q)
    pose = data.oMf[index]
    gap = position - pose.translation
    if rotation is None:
        return np.asarray(gap)
    return np.concatenate([gap, pose.rotation @ pin.log3(pose.rotation.T @ rotation)])
