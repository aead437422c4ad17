"""Places, forces and speeds of feet in random configurations of the legs, with the root level.

In a configuration of a leg with the Jacobian J of its foot, the vertical force of the foot is at most
F = max over directions d in the friction cone of min_j tau_j / |J_j . d|. The foot moves relative to the root along a
direction at most at the speed at which the first joint reaches its speed limit, and from rest at most with the
acceleration at which the first joint reaches its effort limit against the inertia of the leg.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.guess.legs.stance import BalancedStance
from robotraj.robot.coupling.dynamics import mass_matrix
from robotraj.robot.per_robot import PerRobot
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION, root_of

CONFIGURATIONS = 2000
"""Number of random configurations."""
DIRECTIONS = 8
"""Directions of friction forces around the cone."""
FAST = 1e3
"""Speed [rad/s, m/s] that stands for no limit."""
STRONG = 1e9
"""Torque [N m, N] that stands for no limit."""
_KNOWN: PerRobot[LegSamples | None] = PerRobot()


@dataclass(frozen=True, eq=False)
class LegSamples:
    """Configurations of the legs that were sampled.

    Attributes
    ----------
    places : ndarray (feet, samples, 3)
        Feet relative to the root, in its axes [m].
    lengths : ndarray (feet, samples)
        Distances of the feet from the first joints of their legs [m].
    forces : ndarray (feet, samples)
        Greatest vertical forces [N]; infinite where motors have no limits.
    motions : tuple of ndarray (samples, joints, 3)
        For each foot, joint speeds relative to their limits that move it at 1 m/s along x, y and z,
        as nearly as the leg can.
    loads : tuple of ndarray (1, joints, 3)
        For each foot, torques relative to their limits for accelerations of these joint speeds a second from rest,
        without gravity, in the standing configuration.
    moved : tuple of ndarray (samples, 3, 3)
        For each foot, its velocities at these joint speeds, in columns.
    """

    places: Array
    lengths: Array
    forces: Array
    motions: tuple[Array, ...]
    loads: tuple[Array, ...]
    moved: tuple[Array, ...]

    def speeds(self, direction: Sequence[float]) -> Array:
        """Return the greatest speeds (feet, samples) of the feet along a unit vector [m/s]."""
        return self._greatest(self.motions, direction)

    def accelerations(self, direction: Sequence[float]) -> Array:
        """Return the greatest accelerations (feet,) of the standing feet from rest along a unit vector [m/s^2]."""
        return self._greatest(self.loads, direction)[:, 0]

    def _greatest(self, shares: tuple[Array, ...], direction: Sequence[float]) -> Array:
        along = np.asarray(direction)
        used = [np.abs(share @ along).max(axis=1) for share in shares]
        reached = [along @ moved[: len(share)] @ along for moved, share in zip(self.moved, shares, strict=True)]
        return np.asarray(reached / np.maximum(used, 1e-9))


def greatest_friction(stance: BalancedStance) -> float:
    """Return the greatest friction coefficient of the feet; 1 at most, since steeper forces than that need no cone."""
    return min(max(contact.contact.friction for contact in stance.contacts), 1.0)


def leg_joints(robot: Robot, foot: str) -> list[int]:
    """Return the indices in v of the joints between the root and a foot."""
    model, first = robot.model, len(root_of(robot.root).velocities)
    above = [model.joints[i] for i in model.supports[model.frames[robot.frame(foot)].parentJoint] if i]
    return [int(joint.idx_v) for joint in above if joint.idx_v >= first]


def sample_legs(
    robot: Robot,
    feet: Sequence[str],
    standing: Array,
    friction: float,
    margin: float,
    configurations: int = CONFIGURATIONS,
) -> LegSamples | None:
    """Return samples, the first of which is the standing configuration; None if a foot is fixed to the root.

    They are drawn once for each robot and choice of parameters.

    Parameters
    ----------
    robot : Robot
    feet : sequence of str
        Frames of the feet.
    standing : ndarray (nq,)
        Standing configuration, which the joints beside the legs keep.
    friction : float
        Coefficient that a plan may use.
    margin : float
        Share of torque and speed that a plan keeps back.
    configurations : int
        Number of random configurations after the standing one.
    """
    key = (tuple(feet), standing.tobytes(), friction, margin, configurations)
    return _KNOWN.get(robot, key, lambda: _sampled(robot, feet, standing, friction, margin, configurations))


def _sampled(
    robot: Robot, feet: Sequence[str], standing: Array, friction: float, margin: float, configurations: int
) -> LegSamples | None:
    chains = [leg_joints(robot, foot) for foot in feet]
    if not all(chains):
        return None
    torques, speeds = ((1.0 - margin) * robot.limits.largest(each) for each in ("effort", "velocity"))
    # Joints without a motor may have springs, whose torques are not judged here.
    torques = np.where([name in robot.actuated for name in robot.velocity_names], torques, np.inf)
    speeds = np.minimum(speeds, FAST)
    model, data = robot.model, robot.model.createData()
    hips = [next(i for i in range(model.njoints) if model.joints[i].idx_v == chain[0]) for chain in chains]
    shift, base = robot.nq - robot.nv, 3 if robot.root == "planar" else 1
    lower, upper = (np.clip(side, -np.pi, np.pi) for side in robot.limits.sides("position"))
    turns = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    aside = [(friction * np.cos(turn), friction * np.sin(turn), 1.0) for turn in turns]
    directions = np.array([(0.0, 0.0, 1.0), *aside])
    used = sorted({i for chain in chains for i in chain})
    rng = np.random.default_rng(0)
    places = np.zeros((len(feet), configurations + 1, 3))
    lengths, forces = np.zeros(places.shape[:2]), np.zeros(places.shape[:2])
    slopes = tuple(np.zeros((configurations + 1, 3, len(chain))) for chain in chains)
    q = np.array(standing)
    if robot.root == "floating":
        q[QUATERNION] = (0.0, 0.0, 0.0, 1.0)
    mass = mass_matrix(model, data, q)
    for k in range(configurations + 1):
        if k:
            q[[i + shift for i in used]] = rng.uniform(lower[used], upper[used])
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        for f, (foot, chain) in enumerate(zip(feet, chains, strict=True)):
            frame = robot.frame(foot)
            slope = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3][:, chain]
            at = data.oMf[frame].translation
            places[f, k] = at - data.oMi[base].translation
            lengths[f, k] = np.linalg.norm(at - data.oMi[hips[f]].translation)
            levers = np.maximum(np.abs(directions @ slope), 1e-9)
            forces[f, k] = (torques[chain] / levers).min(axis=1).max()
            slopes[f][k] = np.where(np.abs(slope).max(axis=1, keepdims=True) > 1e-6, slope * speeds[chain], 0.0)
    motions = tuple(np.asarray(np.linalg.pinv(each), dtype=float) for each in slopes)
    moved = tuple(each @ motion for each, motion in zip(slopes, motions, strict=True))
    loads = tuple(
        mass[np.ix_(chain, chain)] @ (speeds[chain][:, None] * motion[:1]) / np.minimum(torques[chain], STRONG)[:, None]
        for motion, chain in zip(motions, chains, strict=True)
    )
    return LegSamples(places, lengths, forces, motions, loads, moved)
