"""Distances of a robot's exact shapes from obstacles and from each other, by coal, along a plan.

A pair whose distance d changes at a rate of at most L(t) cannot be nearer than the margin m until the integral of L is
d - m. Each pair is evaluated again then, and near its margin, or the smallest distance of all, every ``RESOLUTION``.
The bound L is independent of the planner. It is the sampled speeds of the joints in an interval, with a reserve, times
the greatest distances of the shape's points from each joint.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from typing import NamedTuple, cast

import coal
import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.dynamics.obstacles.coal_shapes import coal_shape
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.phase import Phase
from robotraj.robot.collision.exact_shapes import ExactShape, link_shapes, sometimes_apart
from robotraj.robot.collision.own_body import own_body
from robotraj.robot.collision.solids import Placed, Solid, depth, one_inside
from robotraj.robot.robot import Robot
from robotraj.solution.violation import Violation
from robotraj.witness.planned import robot_sample
from robotraj.witness.protocols import PhaseSolutionLike

RESOLUTION = 1e-3
"""Longest time between evaluations near contact [s]."""
SEEN = 0.9
"""Share of the smallest distance, both beyond the margin, below which no distance goes unseen."""
RESERVE = 1.2
"""Factor on sampled speeds."""
SIZE = 1e-2
"""Penetration that counts as a relative violation of 1 [m]."""
NO_MARGIN = "nearer than the margin, which rows do not state: spheres around them are always nearer"
"""Why a plan does not keep a pair the margin apart."""
CONSTRUCTED = "apart, without the margin: they are nearer in every sampled configuration"
"""Why a pair need not keep the margin."""
PER_INTERVAL = 9
"""Samples of speeds in every interval."""


@dataclass(frozen=True)
class Clearance(OneLine):
    """The smallest distance of a phase.

    Attributes
    ----------
    phase, label : str
        Name of the phase, and of both shapes.
    distance, margin : float
        Smallest distance, and the distance that the constraint requires [m].
    time : float
        Time of the smallest distance [s].
    """

    phase: str
    label: str
    distance: float
    margin: float
    time: float


class _Shape(NamedTuple):
    """A shape that a joint carries, or an obstacle in the world."""

    label: str
    geometry: coal.CollisionGeometry
    joint: int
    placement: pin.SE3
    obstacle: Obstacle | None = None


def clearance_of(
    planned: PhaseSolutionLike, clock: Callable[[], None] = lambda: None
) -> tuple[list[Clearance], list[Violation], list[str]]:
    """Return the smallest distance for every ``CollisionFree`` of a phase, violations, and pairs without the margin.

    Each of these has the reason, ``CONSTRUCTED`` or ``NO_MARGIN``.
    """
    phase = planned.phase
    nearest: list[Clearance] = []
    broken: list[Violation] = []
    left_out: list[str] = []
    if not isinstance(phase, Phase) or phase.robot is None:
        return nearest, broken, left_out
    for free in phase.constraints:
        if isinstance(free, CollisionFree):
            shapes, pairs = _pairs(phase.robot, free)
            least = _least(planned, phase.robot, shapes, pairs, float(free.margin), clock)
            near = [pair for pair, (distance, _) in zip(pairs, least, strict=True) if 0.0 <= distance < free.margin]
            exempt = _without_margin(phase.robot, free, shapes, near)
            left_out += [f"{shapes[a].label} and {shapes[b].label}: {reason}" for (a, b), reason in exempt.items()]
            found = [
                Clearance(
                    phase.name,
                    f"{shapes[a].label} and {shapes[b].label}",
                    distance,
                    0.0 if (a, b) in exempt else float(free.margin),
                    time,
                )
                for (a, b), (distance, time) in zip(pairs, least, strict=True)
            ]
            nearest += sorted(found, key=lambda each: each.distance - each.margin)[:1]
            broken += _violations(found)
    return nearest, broken, left_out


def _violations(found: Sequence[Clearance]) -> list[Violation]:
    worst: dict[str, Clearance] = {}
    for each in found:
        known = worst.get(each.label)
        if each.distance < each.margin and (known is None or each.distance < known.distance):
            worst[each.label] = each
    return [
        Violation(e.phase, "clearance", e.label, e.time, e.margin - e.distance, "m", e.margin, "under", SIZE)
        for e in worst.values()
    ]


def _pairs(robot: Robot, free: CollisionFree) -> tuple[list[_Shape], list[tuple[int, int]]]:
    """Return the exact shapes, and the pairs that are checked."""
    model, disabled = robot.model, cast("Sequence[tuple[str, str]]", free.srdf or ())
    exact, apart = link_shapes(robot, disabled)
    own = [_Shape(*shape) for shape in exact]
    carried, world = [], []
    for obstacle in free.obstacles:
        position, rotation = obstacle.pose() if not obstacle.moves else (np.zeros(3), np.eye(3))
        local = pin.SE3(np.array(rotation), np.array(position))
        if obstacle.frame is None:
            world.append(_Shape(obstacle.label, coal_shape(obstacle), 0, local, obstacle))
        else:
            frame = model.frames[robot.frame(obstacle.frame)]
            shape = coal_shape(obstacle)
            carried.append(_Shape(obstacle.label, shape, int(frame.parentJoint), frame.placement * local))
    shapes = [*own, *carried, *world]
    pairs = []
    for i, j in product(range(len(own) + len(carried)), range(len(own) + len(carried), len(shapes))):
        obstacle_moves = shapes[j].obstacle is not None and shapes[j].obstacle.moves  # type: ignore[union-attr]
        if shapes[i].joint or obstacle_moves:
            pairs.append((i, j))
    if free.self_collision:
        pairs += [(i, j) for i, j in own_body(robot, disabled).pairs.tolist()]
        among = []
        for k, held in enumerate(carried, start=len(own)):
            beside = {shape.label for shape in own if shape.joint == held.joint}
            for i, shape in enumerate(own):
                if shape.label not in beside and all(frozenset((shape.label, name)) in apart for name in beside):
                    among.append((k, i))
        pairs += sometimes_apart(robot, [ExactShape(*shape[:4]) for shape in shapes], among) if among else []
    return shapes, pairs


def _without_margin(
    robot: Robot, free: CollisionFree, shapes: Sequence[_Shape], near: Sequence[tuple[int, int]]
) -> dict[tuple[int, int], str]:
    """Return the pairs of links, or of links and carried obstacles, without rows for the margin, each with the reason.

    They are nearer than the margin in every sampled configuration, or the spheres around them are.
    """
    own = [(a, b) for a, b in near if shapes[a].obstacle is None and shapes[b].obstacle is None]
    spheres = free.pairs(robot).spheres if own else None
    if spheres is None:
        return {}
    kept = {frozenset((spheres.links[i], spheres.links[j])) for i, j in spheres.link_pairs.tolist()}
    open_ = [(a, b) for a, b in own if frozenset((shapes[a].label, shapes[b].label)) not in kept]
    could = set(sometimes_apart(robot, [ExactShape(*shape[:4]) for shape in shapes], open_, float(free.margin)))
    return {pair: NO_MARGIN if pair in could else CONSTRUCTED for pair in open_}


def _places(robot: Robot, data: pin.Data, shapes: Sequence[_Shape], q: Array, t: float) -> list[coal.Transform3s]:
    pin.forwardKinematics(robot.model, data, q)
    places = []
    for shape in shapes:
        placed = data.oMi[shape.joint] * shape.placement if shape.joint else shape.placement
        rotation, position = placed.rotation, placed.translation
        if shape.obstacle is not None and shape.obstacle.moves:
            position, rotation = shape.obstacle.pose(t)
        places.append(coal.Transform3s(rotation, position))
    return places


def _least(
    planned: PhaseSolutionLike,
    robot: Robot,
    shapes: Sequence[_Shape],
    pairs: Sequence[tuple[int, int]],
    margin: float,
    clock: Callable[[], None],
) -> list[tuple[float, float]]:
    """Return the smallest distance of every pair that was evaluated, and its time.

    Between evaluations no pair comes nearer than the margin, nor nearer than ``SEEN`` of the smallest of all.
    """
    knots = np.asarray(planned.knots, dtype=float)
    count = max(int(np.ceil((knots[-1] - knots[0]) / RESOLUTION)), 1)
    times = np.unique(np.concatenate([np.linspace(knots[0], knots[-1], count + 1), knots]))
    q = robot_sample(planned, times).q
    drift = _obstacle_speeds(shapes, pairs, times)
    bounds = _rates(robot, shapes, pairs) @ speeds_of(planned, knots).T + drift[:, None]
    # Largest change of each distance from the start to each knot.
    travel = np.cumsum(np.column_stack([np.zeros(len(pairs)), bounds * np.diff(knots)]), axis=1)
    interval = np.clip(np.searchsorted(knots, times, side="right") - 1, 0, len(knots) - 2)
    least = [(np.inf, float(times[0]))] * len(pairs)
    due, smallest = np.zeros(len(pairs)), np.inf
    data, request = robot.model.createData(), coal.DistanceRequest()
    for k, t in enumerate(times):
        now = np.flatnonzero(due <= t + 1e-12) if k else np.arange(len(pairs))
        if not now.size:
            continue
        clock()
        places = _places(robot, data, shapes, q[k], float(t))
        travelled = travel[now, interval[k]] + bounds[now, interval[k]] * (t - knots[interval[k]])
        for pair, gone in zip(now.tolist(), travelled.tolist(), strict=True):
            a, b = pairs[pair]
            distance = coal.distance(
                shapes[a].geometry, places[a], shapes[b].geometry, places[b], request, coal.DistanceResult()
            )
            if k in (0, len(times) - 1) and distance > 0.0:
                distance = _outside(shapes[a], places[a], shapes[b], places[b], distance)
            if distance < least[pair][0]:
                least[pair] = float(distance), float(t)
            smallest = min(smallest, float(distance))
            left = distance - max(margin, margin + SEEN * (smallest - margin))
            due[pair] = np.interp(gone + max(left, 0.0), travel[pair], knots, right=np.inf)
    return least


def _outside(first: _Shape, place: coal.Transform3s, second: _Shape, other: coal.Transform3s, apart: float) -> float:
    """Return the distance of two surfaces [m], or the negative depth where one shape lies inside the other, a mesh."""
    placed = [
        Placed(Solid(shape.geometry), np.array(at.getRotation()), np.array(at.getTranslation()))
        for shape, at in ((first, place), (second, other))
    ]
    return -depth(*placed) if one_inside(*placed) else apart


def speeds_of(planned: PhaseSolutionLike, knots: Array) -> Array:
    """Largest joint speeds in every interval, with a reserve, (K, nv)."""
    sites = np.linspace(0.0, 1.0, PER_INTERVAL)
    lengths = np.diff(knots)
    times = (knots[:-1, None] + lengths[:, None] * sites).ravel()
    which = np.repeat(np.arange(len(lengths)), PER_INTERVAL)
    v = robot_sample(planned, times, which).v
    return RESERVE * np.abs(v).reshape(len(lengths), PER_INTERVAL, -1).max(axis=1)


def _rates(robot: Robot, shapes: Sequence[_Shape], pairs: Sequence[tuple[int, int]]) -> Array:
    """Return bounds (pairs, nv) [m/rad, 1]: the rate of a distance is at most rates @ abs(v).

    A joint that carries both shapes does not change their distance.
    """
    levers = np.array([_levers(robot, shape) for shape in shapes]).reshape(len(shapes), robot.model.njoints)
    first, second = np.array(pairs, dtype=int).reshape(-1, 2).T
    each = np.where((levers[first] > 0.0) & (levers[second] > 0.0), 0.0, levers[first] + levers[second])
    rates = np.zeros((len(first), robot.nv))
    for number, joint in enumerate(robot.model.joints):
        if number:
            # A follower turns or slides at a multiple of its leader's speed.
            factor = abs(joint.extract().scaling) if joint.nv == 0 else 1.0
            rates[:, joint.idx_v : joint.idx_v + max(joint.nv, 1)] += factor * each[:, number, None]
    return rates


def _levers(robot: Robot, shape: _Shape) -> Array:
    """Greatest distance of the shape's points from each joint that carries it (njoints,); 1 for those that slide."""
    model, row = robot.model, np.zeros(robot.model.njoints)
    if not shape.joint:
        return row
    shape.geometry.computeLocalAABB()
    box = shape.geometry
    middle = shape.placement.act(np.array(box.aabb_center))
    reach, at = float(np.linalg.norm(middle)) + float(box.aabb_radius), shape.joint
    while at > 0:
        joint = model.joints[at]
        turns, way = _motion_of(robot, at)
        row[at] = reach if turns and joint.nv < 2 else 1.0 if joint.nv < 2 else max(reach, 1.0)
        reach += float(np.linalg.norm(model.jointPlacements[at].translation)) + way
        at = int(model.parents[at])
    return row


def _motion_of(robot: Robot, number: int) -> tuple[bool, float]:
    """Return whether a joint turns, and how far it slides from its placement at most [m]."""
    joint = robot.model.joints[number]
    if joint.nv > 1:
        return True, 0.0
    data = joint.createData()
    joint.calc(data, pin.neutral(robot.model))
    if np.any(np.asarray(data.S).ravel()[3:]):
        return True, 0.0
    limits = robot.limits.position_lower[joint.idx_v], robot.limits.position_upper[joint.idx_v]
    if joint.nv == 0:
        follower = joint.extract()
        limits = tuple(follower.scaling * each + follower.offset for each in limits)
    return False, max(abs(each) if np.isfinite(each) else 10.0 for each in limits)


def _obstacle_speeds(shapes: Sequence[_Shape], pairs: Sequence[tuple[int, int]], times: Array) -> Array:
    """Largest speed of the obstacle of each pair, sampled, with a reserve (pairs,) [m/s]."""
    speed = {}
    for number, shape in enumerate(shapes):
        if shape.obstacle is not None and shape.obstacle.moves:
            positions, rotations = shape.obstacle.poses(times)
            turned = np.linalg.norm(np.diff(rotations, axis=0), axis=(1, 2)) * shape.obstacle.reach
            moved = np.linalg.norm(np.diff(positions, axis=0), axis=1) + np.nan_to_num(turned)
            speed[number] = RESERVE * float(np.max(moved / np.diff(times), initial=0.0))
    return np.array([speed.get(a, 0.0) + speed.get(b, 0.0) for a, b in pairs])
