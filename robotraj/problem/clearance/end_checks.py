"""Checks before planning: collisions at the fixed ends of a phase and along a given path."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError
from robotraj.dynamics.row import Row
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.problem.clearance.plausible_obstacles import warn_of_obstacles
from robotraj.problem.constraints.base import Constraint, Where
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.feasibility import Ends
from robotraj.robot.loading.geometry import ShapesUnread
from robotraj.robot.robot import Robot

PLACES = 513
"""Number of places of a path at which distances are checked."""


def clearances_of(constraints: Sequence[Constraint], robot: Robot | None) -> tuple[ClearancePairs, ...]:
    """Return the pairs of every ``CollisionFree`` among the constraints of a phase that moves a robot."""
    if robot is None:
        return ()
    return tuple(each.pairs(robot) for each in constraints if isinstance(each, CollisionFree))


def clearance_summary(constraints: Sequence[Constraint], robot: Robot | None) -> list[Row]:
    """Return one row for each obstacle, and one for pairs of links, of every ``CollisionFree`` of a phase."""
    rows = []
    for pairs in clearances_of(constraints, robot):
        links = {pairs.names(pair)[0] for pair in range(pairs.against)}
        rows += [Row("clearance", "m", pairs.margin, np.inf, f"{len(links)} links and {o}") for o in pairs.labels]
        if len(pairs) > pairs.against:
            count = len(pairs.spheres.link_pairs)
            rows.append(Row("clearance", "m", pairs.margin, np.inf, f"{count} pairs of links"))
    return rows


def check_ends(phase: str, constraints: Sequence[Constraint], robot: Robot, ends: Ends) -> None:
    """Refuse ends at which the robot is nearer to an obstacle at rest, or to itself, than the margin.

    Nothing is checked while a saved file is loaded, which reads no shapes.

    Raises
    ------
    InputError
        A pair is nearer than the margin. The message names the worst pair and its distance.

    Warns
    -----
    UserWarning
        An obstacle is out of all proportion to the robot, or its quaternion seems to have w first.
    """
    warn_of_obstacles(phase, constraints, robot)
    try:
        avoided = clearances_of(constraints, robot)
    except ShapesUnread:
        return
    for pairs in avoided:
        for end, q in _fixed(robot, ends):
            _check(phase, pairs, distances_at_rest(pairs, q[None])[0], end)


def check_path(phase: str, constraints: Sequence[Constraint], robot: Robot, path: PiecewisePolynomial) -> None:
    """Refuse a path on which the robot is nearer to an obstacle at rest, or to itself, than the margin.

    No timing changes these distances. They are evaluated at ``PLACES`` places; the proof of a plan finds what lies
    between.

    Raises
    ------
    InputError
        Pairs are nearer than the margin. The message names the worst pair, its distance and its place on the path.
    """
    try:
        avoided = clearances_of(constraints, robot)
    except ShapesUnread:
        return
    s = np.linspace(path.breaks[0], path.breaks[-1], PLACES)
    q = path(s)
    for pairs in avoided:
        if not len(pairs):
            continue
        distances = distances_at_rest(pairs, q)
        place, worst = np.unravel_index(int(np.argmin(distances)), distances.shape)
        if not distances[place, worst] < pairs.margin:
            continue
        near = distances < pairs.margin
        first, last = s[near[:, worst]][[0, -1]]
        labels = {pairs.label(pair) for pair in np.flatnonzero(near.any(axis=0)).tolist()}
        further = sorted(labels - {pairs.label(int(worst))})
        others = f" So are {', '.join(further[:3])}{' and others' if len(further) > 3 else ''}." if further else ""
        raise InputError(
            f"Phase {phase!r}: at s = {s[place]:.4g} of the path {_apart(pairs, int(worst), distances[place])}. It is "
            f"so near from s = {first:.4g} to {last:.4g}.{others} No timing changes that: give another path, or move "
            "the obstacle; name pairs of links in srdf= if they may touch."
        )


def distances_at_rest(pairs: ClearancePairs, q: Array) -> Array:
    """Return the distances of pairs (m, n) [m] at configurations (m, nq), infinite to obstacles that move."""
    moving = np.array([pairs.obstacles[o].moves for o in pairs.second[: pairs.against]], dtype=bool)
    distances = pairs.distances(q, np.zeros(len(q)))
    distances[:, : pairs.against][:, moving] = np.inf
    return distances


def check_moving_obstacles(
    phase: str, constraints: Sequence[Constraint], robot: Robot | None, ends: Ends, durations: tuple[float, float]
) -> None:
    """Refuse fixed ends at which a moving obstacle is nearer than the margin; the motion begins at t = 0 s.

    Raises
    ------
    InputError
        A pair is nearer than the margin. The message names the worst pair, the time and its distance.
    """
    shortest, longest = durations
    if robot is None:
        return
    for pairs in clearances_of(constraints, robot):
        if not any(obstacle.moves for obstacle in pairs.obstacles):
            continue
        times = {Where.START.value: 0.0} | ({Where.END.value: longest} if shortest == longest else {})
        for end, q in _fixed(robot, ends):
            if end in times:
                _check(phase, pairs, pairs.distances(q[None], np.array([times[end]]))[0], end, times[end])


def _check(phase: str, pairs: ClearancePairs, distances: Array, end: str, time: float | None = None) -> None:
    worst = int(np.argmin(distances)) if len(distances) else -1
    if worst >= 0 and distances[worst] < pairs.margin:
        when = "" if time is None else f", t = {time:.4g} s,"
        beside = "the obstacle" if worst < pairs.against else "name the pair in srdf= if it may touch"
        raise InputError(
            f"Phase {phase!r}: at the {end}{when} {_apart(pairs, worst, distances)}. Move the {end} or {beside}."
        )


def _apart(pairs: ClearancePairs, worst: int, distances: Array) -> str:
    """Describe a pair that is nearer than the margin."""
    apart = float(distances[worst])
    is_overlap = f"overlap by {-apart:.4g} m" if apart < 0.0 else f"are {apart:.4g} m apart"
    return (
        f"{pairs.label(worst)} {is_overlap}, below the margin of {pairs.margin:g} m, by the spheres around the robot's "
        "shapes"
    )


def _fixed(robot: Robot, ends: Ends) -> Iterator[tuple[str, Array]]:
    for where, bounds in ends.items():
        if where in (Where.START, Where.END):
            lower, upper = bounds.lower[: robot.nq], bounds.upper[: robot.nq]
            if np.array_equal(lower, upper):
                yield where.value, np.asarray(lower)
