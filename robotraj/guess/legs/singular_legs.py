"""Legs that are straight or folded: the height of their feet has no slope, so Newton's method cannot bend them.

The height of a foot then changes in second order only. Its Hessian, along the motions that leave the foot's other rows,
has an eigenvector that bends the leg most for the least motion. One formula serves knees, and legs of more joints.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.precision import DIFFERENCE, MET, SAME
from robotraj.guess.legs.stance import BalancedStance, root_freedoms

FLAT = 1e-2
"""Slope of a foot's height, relative to the robot's reach, below which a leg is singular."""
BEND = 0.6
"""Largest change of a joint: [rad], or of the reach."""
PREFERRED = np.array([1.0, 0.1, 10.0])
"""Weights of the motion of a leg's middle (forwards, outwards, upwards) that choose between two bends of equal room."""


def singular_legs(stance: BalancedStance, q: Array, feet: Mapping[str, float]) -> list[int]:
    """Return the rows of the heights of feet that joints cannot change at first order, the other rows held."""
    slope = _slope(stance, q, feet)
    found = []
    for row in stance.upward:
        motions = _motions(stance, slope, row)
        if motions.shape[1] and np.abs(slope[row] @ motions).max() < FLAT * stance.size:
            found.append(row)
    return found


def bent(stance: BalancedStance, q: Array, feet: Mapping[str, float], rows: list[int], up: bool) -> Array:
    """Bend singular legs so that their feet move up towards the root, or down.

    Parameters
    ----------
    stance : BalancedStance
    q : ndarray (nq,)
    feet : mapping of str to float
        Anchors by name.
    rows : list of int
        Heights of the feet, as ``singular_legs`` returns them.
    up : bool
        Whether the legs become shorter.
    """
    slope, result = _slope(stance, q, feet), np.array(q)
    joints = slice(len(q) - slope.shape[1], None)
    hessians = _hessians(stance, q, feet, rows)
    for row, hessian in zip(rows, hessians, strict=True):
        motions = _motions(stance, slope, row)
        values, vectors = np.linalg.eigh(motions.T @ hessian @ motions)
        best = int(np.argmax(values if up else -values))
        if (values[best] if up else -values[best]) > MET * stance.size:
            result[joints] += _to_one_side(stance, q, motions @ vectors[:, best])
    return stance.inside(result)


def _slope(stance: BalancedStance, q: Array, feet: Mapping[str, float]) -> Array:
    """Slopes (m, joints) of all rows, per rad or per reach."""
    n = root_freedoms(stance.robot)
    slope: Array = stance.places(q, feet)[1][:, n:] * stance.scales(stance.robot.units[n:])
    return slope


def _motions(stance: BalancedStance, slope: Array, row: int) -> Array:
    """Return an orthonormal basis (joints, k) of the motions of a foot's joints that keep its other rows."""
    contact = next(c for c in stance.feet if row in stance.columns([c.name]))
    own = stance.columns([contact.name])
    moving = np.flatnonzero(np.abs(slope[own]).max(axis=0) > MET * stance.size)
    others = slope[[each for each in own if each not in stance.upward]][:, moving]
    if not moving.size:
        return np.zeros((slope.shape[1], 0))
    _, sizes, right = np.linalg.svd(others, full_matrices=True)
    rank = int(np.sum(sizes > MET * stance.size))
    basis = np.zeros((slope.shape[1], moving.size - rank))
    basis[moving] = right[rank:].T
    return basis


def _hessians(stance: BalancedStance, q: Array, feet: Mapping[str, float], rows: list[int]) -> Array:
    """Return the second derivatives (rows, joints, joints) of heights by finite differences of their slopes."""
    robot, n = stance.robot, root_freedoms(stance.robot)
    columns = []
    for unit in np.diag(stance.scales(robot.units))[n:]:
        ahead, behind = (pin.integrate(robot.model, q, sign * DIFFERENCE * unit) for sign in (1.0, -1.0))
        columns.append((_slope(stance, ahead, feet)[rows] - _slope(stance, behind, feet)[rows]) / (2.0 * DIFFERENCE))
    found = np.stack(columns, axis=2)
    return 0.5 * (found + found.transpose(0, 2, 1))


def _to_one_side(stance: BalancedStance, q: Array, motion: Array) -> Array:
    """Scale a motion of joints to a bend, to the side with more room, else that where the leg's middle should move."""
    lower, upper = stance.bounds
    joints, scales = q[len(q) - len(lower) :], stance.scales(stance.robot.units[-len(lower) :])
    motion = BEND * motion / np.abs(motion).max() * scales
    moving = np.abs(motion) > MET * scales

    def room(sign: float) -> float:
        free = np.where(sign * motion > 0.0, upper - joints, joints - lower)[moving]
        return float(np.min(np.minimum(free / np.abs(motion[moving]), 1.0), initial=1.0))

    forwards, backwards = room(1.0), room(-1.0)
    if abs(forwards - backwards) < SAME:
        sign = 1.0 if _middle_moves(stance, q, motion) >= 0.0 else -1.0
    else:
        sign = 1.0 if forwards > backwards else -1.0
    return np.asarray(sign * max(forwards, backwards) * motion)


def _middle_moves(stance: BalancedStance, q: Array, motion: Array) -> float:
    """Return how far the joints of a leg move forwards, outwards and upwards, weighted."""
    robot, data = stance.robot, stance.data
    names = robot.velocity_names[-len(motion) :]
    moving = [robot.model.getJointId(name) for name in np.array(names)[np.abs(motion) > 0.0]]
    rate = np.concatenate([np.zeros(robot.nv - len(motion)), motion])
    pin.forwardKinematics(robot.model, data, q, rate)
    total = np.zeros(3)
    for joint in moving:
        velocity = data.oMi[joint].rotation @ data.v[joint].linear
        total += velocity * np.array([1.0, np.sign(data.oMi[joint].translation[1]), 1.0])
    return float(PREFERRED @ total)
