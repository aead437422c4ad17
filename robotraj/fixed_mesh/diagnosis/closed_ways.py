"""Obstacles that close the way: no path was found past one of them, and without it there is one.

A search by trees of straight motions that finds no path does not exclude one. The conflicts are likely, not certain.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj.fixed_mesh.diagnosis.self_collision import SIZE
from robotraj.guess.paths.geometric_path import GeometricPath
from robotraj.guess.paths.phase_scene import scene_of
from robotraj.guess.paths.planner import RRTConnect
from robotraj.guess.straight_line import StraightLine
from robotraj.problem.clearance.end_checks import distances_at_rest
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict

Ignored = tuple[Indices, CollisionFree]
"""Indices of pairs, and a constraint without them."""

SEARCH = RRTConnect(iterations=5_000)
"""Search without one of the obstacles. Nearly all paths that are found are found so soon."""
STEP = 0.02
"""Largest change of a joint [rad, m] between the configurations of a path at which distances are evaluated."""


def closed_ways(problem: Problem) -> tuple[Conflict, ...]:
    """Return, for each phase whose way is closed, the distance that must give least among those that open it.

    If no obstacle closes the way alone, the worst distance on a path that ignores all of them is returned.
    """
    found = []
    for phase, first, last in _closed(problem):
        ways = list(_opened(phase, first, last, _one_ignored, "it"))
        ways = ways or list(_opened(phase, first, last, _obstacles_ignored, "all obstacles"))
        found += [min(ways, key=lambda way: way.relative)] if ways else []
    return tuple(found)


def _closed(problem: Problem) -> Iterator[tuple[Phase, Array, Array]]:
    """Yield the phases whose way is closed, with the configurations (nq,) of their ends."""
    guess = GeometricPath(StraightLine()).prepared(problem)
    assert isinstance(guess, GeometricPath)
    for index, phase in enumerate(problem.phases):
        if guess.is_closed(phase, index):
            yield phase, *guess.ends(phase, index)


def _one_ignored(constraint: CollisionFree, pairs: ClearancePairs) -> Iterator[Ignored]:
    """Yield the pairs of each obstacle, and those of links, with the constraint without them."""
    still = [(number, obstacle) for number, obstacle in enumerate(pairs.obstacles) if not obstacle.moves]
    for number, obstacle in still:
        others = [each for each in constraint.obstacles if each is not obstacle]
        yield np.flatnonzero(pairs.second[: pairs.against] == number), replace(constraint, obstacles=others)
    if len(pairs) > pairs.against:
        yield np.arange(pairs.against, len(pairs)), replace(constraint, self_collision=False)


def _obstacles_ignored(constraint: CollisionFree, pairs: ClearancePairs) -> Iterator[Ignored]:
    """Yield the pairs of all obstacles, with the constraint without them."""
    if pairs.against:
        yield np.arange(pairs.against), replace(constraint, obstacles=())


def _opened(
    phase: Phase,
    first: Array,
    last: Array,
    ignored: Callable[[CollisionFree, ClearancePairs], Iterator[Ignored]],
    what: str,
) -> Iterator[Conflict]:
    """Yield a conflict for each set of pairs without which a path is found."""
    assert phase.robot is not None
    for number, constraint in enumerate(phase.constraints):
        if isinstance(constraint, CollisionFree):
            pairs = constraint.pairs(phase.robot)
            for own, changed in ignored(constraint, pairs):
                path = _path_with(phase, number, changed, first, last)
                if path is not None:
                    yield _conflict(phase, pairs, own, path, what)


def _path_with(phase: Phase, number: int, constraint: CollisionFree, first: Array, last: Array) -> Array | None:
    """Return configurations (m, nq) along a path with another constraint in the place of one; None without a path."""
    kept = [constraint if k == number else each for k, each in enumerate(phase.constraints)]
    scene = scene_of(replace(phase, constraints=kept))
    corners = None if scene is None else SEARCH.path(scene, first, last, 0)
    if corners is None:
        return None
    parts = [
        a + np.linspace(0.0, 1.0, 2 + int(np.abs(b - a).max() / STEP))[:, None] * (b - a)
        for a, b in zip(corners[:-1], corners[1:], strict=True)
    ]
    return np.concatenate(parts)


def _conflict(phase: Phase, pairs: ClearancePairs, own: Indices, path: Array, what: str) -> Conflict:
    """Describe the pair that is farthest below its margin on a path that ignores some pairs."""
    distances = distances_at_rest(pairs, path)[:, own]
    _, worst = np.unravel_index(int(np.argmin(distances)), distances.shape)
    least, pair = float(distances.min()), int(own[worst])
    link, other = pairs.names(pair)
    past = other if pair < pairs.against else f"{link} and {other}"
    reason = f"no way past {past} was found; a path that ignores {what} comes so near"
    relative = (pairs.margin - least) / max(pairs.margin, SIZE)
    return Conflict(
        phase.name, f"clearance, {pairs.label(pair)}", np.nan, pairs.margin, least, "m", relative, reason=reason
    )
