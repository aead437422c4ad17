"""How high a robot can jump at most: an estimate from the torques and speeds of its legs.

The root stays level and the legs have no mass. In a configuration of a leg, the vertical force of its foot is at most
F = max over directions d in the friction cone of min_j tau_j / |J_j . d|, and its root rises at most at the speed V at
which the first joint reaches its speed limit, with the foot below it at rest. The centre of mass is accelerated over
the heights z of the root, from the lowest to the highest at which all feet reach the ground,

    d(v^2 / 2) / dz = sum_feet max_{V >= v} F(z) / m - g,

with the best of seeded random configurations at each height. It rises by v^2 / (2 g) at most. The mass of the legs and
the time for their motion reduce what is reached, so that requests far above the estimate are refused.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION, root_of
from robotraj.robot.size.reach import reach

Array = NDArray[np.float64]

CONFIGURATIONS, LEVELS = 2000, 30
"""Numbers of random configurations and of heights."""
DIRECTIONS = 8
"""Directions of friction forces around the cone."""
BEYOND = 1.5
"""Multiple of the estimate above which a height is refused."""
MODEST = 0.2
"""Multiple of the estimate that a message names as one that would do."""
EASY = 0.25
"""Height relative to the robot's reach up to which nothing is estimated."""
FAST = 1e3
"""Speed [rad/s, m/s] that stands for no limit."""


def check_height(
    robot: Robot, feet: Sequence[str], standing: Array, height: float, friction: float, margin: float
) -> None:
    """Refuse a jump that is far higher than the estimate.

    Raises
    ------
    InputError
        The message has the speed at take-off, the estimate, and a height that would do.
    """
    if height <= EASY * reach(robot.model):
        return
    most = greatest_rise(robot, feet, standing, friction, margin)
    if height <= BEYOND * most:
        return
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    raise InputError(
        f"rt.gait.jump(height) is {height:g} m, a take-off at {np.sqrt(2.0 * gravity * height):.3g} m/s. By the effort "
        f"and velocity limits of its legs and its weight, {robot.name!r} rises by about {most:.2g} m at most. "
        f"height={MODEST * most:.2g} would do."
    )


def greatest_rise(robot: Robot, feet: Sequence[str], standing: Array, friction: float, margin: float) -> float:
    """Return the estimated greatest rise of the centre of mass [m]; infinite where a motor has no limit.

    Parameters
    ----------
    robot : Robot
    feet : sequence of str
        Frames of the feet.
    standing : ndarray (nq,)
        Standing configuration, which the joints beside the legs keep.
    friction : float
        Coefficient that the plan may use.
    margin : float
        Share of torque and speed that the plan keeps back.
    """
    chains = [_joints(robot, foot) for foot in feet]
    torques, speeds = ((1.0 - margin) * robot.limits.largest(each) for each in ("effort", "velocity"))
    if not all(chains) or not np.isfinite([torques[i] for chain in chains for i in chain]).all():
        return float(np.inf)
    speeds = np.minimum(speeds, FAST)
    heights, forces, rates = _samples(robot, feet, chains, standing, friction, torques, speeds)
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    step = float(heights.max(axis=1).min()) / LEVELS
    squared = best = 0.0
    for level in step * np.arange(LEVELS):
        near = (heights >= level) & (heights < level + step) & (rates >= np.sqrt(squared))
        push = float(np.where(near, forces, 0.0).max(axis=1).sum())
        squared = max(squared + 2.0 * (push / robot.mass - gravity) * step, 0.0)
        best = max(best, squared)
    return best / (2.0 * gravity)


def _joints(robot: Robot, foot: str) -> list[int]:
    """Return the indices in v of the joints between the root and a foot."""
    model, first = robot.model, len(root_of(robot.root).velocities)
    above = [model.joints[i] for i in model.supports[model.frames[robot.frame(foot)].parentJoint] if i]
    return [int(joint.idx_v) for joint in above if joint.idx_v >= first]


def _samples(
    robot: Robot,
    feet: Sequence[str],
    chains: Sequence[Sequence[int]],
    standing: Array,
    friction: float,
    torques: Array,
    speeds: Array,
) -> tuple[Array, Array, Array]:
    """Return heights of the root above each foot [m], vertical forces [N] and speeds [m/s], (feet, samples) each."""
    model, data = robot.model, robot.model.createData()
    shift, base = robot.nq - robot.nv, 3 if robot.root == "planar" else 1
    lower, upper = (np.clip(side, -np.pi, np.pi) for side in robot.limits.sides("position"))
    turns = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    aside = [(friction * np.cos(turn), friction * np.sin(turn), 1.0) for turn in turns]
    directions = np.array([(0.0, 0.0, 1.0), *aside])
    used = sorted({i for chain in chains for i in chain})
    rng = np.random.default_rng(0)
    heights, forces, rates = np.zeros((3, len(feet), CONFIGURATIONS))
    q = np.array(standing)
    if robot.root == "floating":
        q[QUATERNION] = (0.0, 0.0, 0.0, 1.0)
    for k in range(CONFIGURATIONS):
        q[[i + shift for i in used]] = rng.uniform(lower[used], upper[used])
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        for f, (foot, chain) in enumerate(zip(feet, chains, strict=True)):
            frame = robot.frame(foot)
            slope = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3][:, chain]
            heights[f, k] = data.oMi[base].translation[2] - data.oMf[frame].translation[2]
            levers = np.maximum(np.abs(directions @ slope), 1e-9)
            forces[f, k] = (torques[chain] / levers).min(axis=1).max()
            moving = slope[np.abs(slope).max(axis=1) > 1e-6]
            # Joint speeds, relative to their limits, that move the foot straight down at 1 m/s.
            down = np.linalg.pinv(moving * speeds[chain])[:, -1]
            rates[f, k] = 1.0 / max(float(np.abs(down).max()), 1e-9)
    return heights, forces, rates
