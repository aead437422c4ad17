"""The scene of a phase: its robot, and the obstacles that its ``rt.CollisionFree`` names."""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np

from robotraj.guess.paths.moving_scene import MovingScene
from robotraj.guess.paths.scene import PathScene
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.problem.clearance.sphere_tree import sphere_tree
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.phase import Phase
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot

_KNOWN: WeakKeyDictionary[Phase, PathScene] = WeakKeyDictionary()


def scene_of(phase: Phase) -> PathScene | None:
    """Return the scene of a phase; None without ``rt.CollisionFree``, for a moving base, and where joints follow."""
    robot = phase.robot
    if robot is None or robot.root != "fixed" or robot.nq != robot.nv or robot.followers:
        return None
    kept = [constraint.pairs(robot) for constraint in phase.constraints if isinstance(constraint, CollisionFree)]
    if not kept:
        return None
    if phase not in _KNOWN:
        _KNOWN[phase] = _scene(phase, robot, kept)
    return _KNOWN[phase]


def _scene(phase: Phase, robot: Robot, kept: Sequence[ClearancePairs]) -> PathScene:
    widest = max(kept, key=lambda pairs: len(pairs) - pairs.against)
    apart = widest.spheres.link_pairs if len(widest) > widest.against else widest.spheres.link_pairs[:0]
    every = [obstacle for pairs in kept for obstacle in pairs.obstacles]
    obstacles = [obstacle for obstacle in every if not obstacle.moves]
    moving = [obstacle for obstacle in every if obstacle.moves]
    limits = phase.limits if isinstance(phase.limits, Limits) else None
    free = np.full(robot.nq, np.inf)
    speeds = np.ones(robot.nv) if limits is None else limits.largest("velocity")
    return PathScene(
        sphere_tree(robot, widest.spheres, apart, obstacles),
        -free if limits is None else limits.position_lower,
        free if limits is None else limits.position_upper,
        np.where(np.isfinite(speeds), speeds, 1.0),
        max(pairs.margin for pairs in kept),
        MovingScene(robot, widest.spheres, apart, obstacles, moving) if moving else None,
    )
