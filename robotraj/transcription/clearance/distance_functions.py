"""Distances of pairs as point functions: one for all pairs of a joint, or of two joints.

A sphere with centre p and radius r is at least n' p - h - r from a convex shape, for every unit vector n. Here h is the
largest n' x of the shape. For spheres around p and q with radii r and s it is at least n' (p - q) - r - s. These bounds
equal the distance where n is its gradient. With n fixed they are as smooth as the robot's kinematics, while a distance
has corners.

The plane of a moving obstacle moves with it, and its function depends on the time. Centres, normals and offsets are
constants, which differ from pair to pair.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.values import dataclass
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.dynamics.point import symbolic_model
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.robot.collision.placements import joint_tree
from robotraj.robot.robot import Robot
from robotraj.transcription.assembly.point_functions import PointFunctions

Clocks = tuple[bool, bool]

_FUNCTIONS: WeakKeyDictionary[Robot, dict[Hashable, DistanceFunction]] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class DistanceFunction:
    """A point function y(q; c) = n' p(q) - offset [m]. For moving obstacles p and n are in their axes at t0 + tau T.

    Attributes
    ----------
    stage : PointFunctions
        The function of the positions, then of t0 and T where these are free and the obstacle moves.
    positions : ndarray of int
        Entries of q on which it depends.
    timed : bool
        Whether it depends on the time.
    """

    stage: PointFunctions
    positions: Indices
    timed: bool


def key_of(pairs: ClearancePairs, pair: int, free: Clocks = (False, False), plane: bool = False) -> Hashable:
    """Return a key that pairs with one function share; with ``plane``, moving obstacles have fixed planes too."""
    spheres = pairs.spheres
    joint, other = int(spheres.joint[pairs.first[pair]]), int(pairs.second[pair])
    if pair >= pairs.against:
        return joint, int(spheres.joint[other])
    obstacle = pairs.obstacles[other]
    if obstacle.moves and not plane:
        return joint, _SameObstacle(obstacle), free
    return joint


def function_of(
    pairs: ClearancePairs, pair: int, free: Clocks = (False, False), plane: bool = False
) -> DistanceFunction:
    """Return the function of a pair, which is built once for each robot and key.

    Parameters
    ----------
    pairs : ClearancePairs
    pair : int
    free : (bool, bool)
        Whether t0 and T are unknowns; otherwise they are constants after tau.
    plane : bool
        Whether the function of a moving obstacle is that of a fixed plane, whose constants hold at one time.
    """
    known = _FUNCTIONS.setdefault(pairs.robot, {})
    key = key_of(pairs, pair, free, plane)
    if key not in known:
        known[key] = _made(pairs, pair, free, plane)
    return known[key]


def function_of_links(robot: Robot, joint: int, other: int, count: int) -> DistanceFunction:
    """Return the function of pairs of points on joints, which is built once for each robot: n' (p - q) - offset [m].

    Its constants are p and q in the frames of the joints, n and the offset, of one of the ``count`` pairs after the
    other. Joints that move both are neutral in n.
    """
    known = _FUNCTIONS.setdefault(robot, {})
    key = joint, other, count
    if key not in known:
        known[key] = _of_links(robot, joint, other, count)
    return known[key]


def constants_of(pairs: ClearancePairs, chosen: Indices) -> Array:
    """Return the constants (n, n_c) of pairs with one function, without those of planes and times."""
    spheres = pairs.spheres
    first, second = pairs.first[chosen], pairs.second[chosen]
    if chosen[0] >= pairs.against:
        return np.column_stack([spheres.centre[first], spheres.centre[second]])
    return np.asarray(spheres.centre[first])


class _SameObstacle:
    """A key by the identity of an obstacle, with a reference to it."""

    def __init__(self, obstacle: Obstacle) -> None:
        self.obstacle = obstacle

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _SameObstacle) and other.obstacle is self.obstacle

    def __hash__(self) -> int:
        return id(self.obstacle)


def _made(pairs: ClearancePairs, pair: int, free: Clocks, plane: bool) -> DistanceFunction:
    robot, spheres = pairs.robot, pairs.spheres
    joint = int(spheres.joint[pairs.first[pair]])
    q = ca.SX.sym("q", robot.nq)
    if pair >= pairs.against:
        return _of_links(robot, joint, int(spheres.joint[pairs.second[pair]]), 1)
    obstacle = pairs.obstacles[pairs.second[pair]]
    if plane or not obstacle.moves:
        c = ca.SX.sym("c", 7)
        return _stage(robot, ca.dot(c[3:6], _world(robot, joint, q, c[:3])) - c[6], q, None, c, (joint,))
    before = 1 + free.count(False)
    c, clock = ca.SX.sym("c", 7 + before), ca.SX.sym("clock", free.count(True))
    unknown, known = iter(ca.vertsplit(clock)), iter(ca.vertsplit(c[1:before]))
    t0, duration = (next(unknown) if is_free else next(known) for is_free in free)
    position, rotation = obstacle.pose(t0 + c[0] * duration)
    local = ca.mtimes(rotation.T, _world(robot, joint, q, c[before : before + 3]) - position)
    distance = ca.dot(c[before + 3 : before + 6], local) - c[before + 6]
    return _stage(robot, distance, q, clock, c, (joint,))


def _of_links(robot: Robot, joint: int, other: int, count: int) -> DistanceFunction:
    q, every = ca.SX.sym("q", robot.nq), ca.SX.sym("c", 10, count)
    distances = []
    for c in ca.horzsplit(every):
        apart = _world(robot, joint, q, c[:3]) - _world(robot, other, q, c[3:6])
        distances.append(ca.dot(c[6:9], apart) - c[9])
    return _stage(robot, ca.vertcat(*distances), q, None, ca.vec(every), (joint, other))


def _stage(
    robot: Robot, distance: ca.SX, q: ca.SX, clock: ca.SX | None, c: ca.SX, joints: Sequence[int]
) -> DistanceFunction:
    """Return the point function of a distance over the positions on which it depends."""
    tree, model = joint_tree(robot), robot.model
    # Joints that move both points alike do not change their distance and stay neutral.
    alike = tree.moving_both(*joints) if len(joints) > 1 else ()
    own = np.flatnonzero(tree.is_carried_by()[list(joints)].any(axis=0)).tolist()
    moving = [model.joints[j] for j in own if j not in alike]
    positions = sorted({at for joint in moving for at in range(joint.idx_q, joint.idx_q + max(joint.nq, 1))})
    still = [at for at in range(robot.nq) if at not in positions]
    neutral = robot.neutral[still]
    distance = ca.substitute(distance, q[still], ca.DM(neutral)) if still else distance
    unknowns = q[positions] if clock is None else ca.vertcat(q[positions], clock)
    return DistanceFunction(PointFunctions(unknowns, c, distance), np.array(positions, dtype=int), clock is not None)


def _world(robot: Robot, joint: int, q: ca.SX, centre: ca.SX) -> ca.SX:
    if joint == 0:
        return centre
    position, rotation = symbolic_model(robot).frame_placement(str(robot.model.names[joint]))(q)
    return position + ca.mtimes(rotation, centre)
