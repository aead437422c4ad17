"""The overlaps of a robot's links along a solution, by the exact shapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.precision import MET, SAMPLES
from robotraj.guess.least_time import LineLimits
from robotraj.guess.paths.around_itself import Motion, Route, route_around
from robotraj.problem.clearance.own_shapes import MARGIN, own_shapes
from robotraj.problem.problem import Problem
from robotraj.robot.collision.along_motion import Near, deepest_overlap, near_pairs, pairs_along, pairs_within
from robotraj.robot.limits import Limits
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution
from robotraj.solution.violation import Violation

OVERLAPS = "links that overlap"
RESERVE = 1.2
"""Factor on the joint speeds at the points of an interval, for those between them."""


class Overlap(NamedTuple):
    """A pair of shapes that overlaps in a phase: its deepest overlap [m], and the time [s]."""

    phase: int
    pair: int
    depth: float
    time: float


class OwnOverlaps:
    """Compares solutions of a problem with the exact shapes.

    Attributes
    ----------
    bodies : list of OwnBody or None
        Shapes that must not overlap in each phase.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self.bodies = [own_shapes(phase) for phase in problem.phases]

    def of(self, number: int, part: PhaseSolution) -> dict[int, float]:
        """Return the pairs that overlap, each with a time [s]."""
        near = self._near(number, part, every=False)
        return {each.pair: float(each.times[len(each.times) // 2]) for each in near if each.overlaps}

    def sampled(self, number: int, motion: Motion) -> dict[int, float]:
        """Return the pairs that overlap at equal steps of a motion, each with its depth in the middle of them [m]."""
        robot, body = self._problem.phases[number].robot, self.bodies[number]
        if robot is None or body is None:
            return {}
        q = motion(np.linspace(0.0, 1.0, SAMPLES))
        near = pairs_within(robot, body, q)
        middles = {pair: np.flatnonzero(near[:, pair]) for pair in np.flatnonzero(near.any(axis=0)).tolist()}
        return {pair: body.depth(robot, q[at[len(at) // 2]], pair) for pair, at in middles.items()}

    def deepest_sampled(self, found: Solution) -> float:
        """Return the depth of the deepest overlap at equal steps of the phases of a solution [m]."""
        depths = [self.sampled(number, motion_of(part)) for number, part in enumerate(found.phases)]
        return max((depth for each in depths for depth in each.values()), default=0.0)

    def touching(self, number: int, motion: Motion) -> dict[int, float]:
        """Return the pairs that nearly touch at equal steps of a motion, as under rows that keep them apart, with 0."""
        robot, body = self._problem.phases[number].robot, self.bodies[number]
        if robot is None or body is None:
            return {}
        # Links at twice the margin of rows count as kept apart by them.
        return dict.fromkeys(pairs_along(robot, body, motion, 2.0 * MARGIN), 0.0)

    def deepest(self, found: Solution) -> list[Overlap]:
        """Return the deepest overlap of each pair."""
        overlaps = []
        for number, (part, body) in enumerate(zip(found.phases, self.bodies, strict=True)):
            for each in self._near(number, part, every=True):
                if each.overlaps and body is not None and part.phase.robot is not None:
                    depth, time = deepest_overlap(part.phase.robot, body, in_time(part), each)
                    overlaps.append(Overlap(number, each.pair, max(depth, MET), time))
        return overlaps

    def depths_at(self, found: Solution, known: Sequence[Mapping[int, float]]) -> list[dict[int, float]]:
        """Return the depths of each phase's pairs at their known times [m]."""
        depths: list[dict[int, float]] = [{} for _ in known]
        for each in self.at_known_times(found, known):
            depths[each.phase][each.pair] = each.depth
        return depths

    def at_known_times(self, found: Solution, known: Sequence[Mapping[int, float]]) -> list[Overlap]:
        """Return the overlaps of each phase's pairs at their known times [s], which takes no search."""
        overlaps = []
        for number, (part, body, times) in enumerate(zip(found.phases, self.bodies, known, strict=True)):
            robot = part.phase.robot
            if body is not None and robot is not None:
                at = {pair: in_time(part)(np.array([time]))[0] for pair, time in times.items()}
                depths = {pair: max(body.depth(robot, q, pair), MET) for pair, q in at.items()}
                overlaps += [Overlap(number, pair, depth, times[pair]) for pair, depth in depths.items()]
        return overlaps

    def route(self, number: int, part: PhaseSolution, seed: int) -> Route | None:
        """Return a free motion around the overlaps of a phase; later seeds look for one between its ends.

        None without one, and where the phase is on a path or has a joint without a motor.
        """
        phase, body = self._problem.phases[number], self.bodies[number]
        robot = phase.robot
        if body is None or robot is None or phase.path is not None or LineLimits.of(phase) is None:
            return None
        own = phase.limits if isinstance(phase.limits, Limits) else None
        anywhere = np.full(robot.nq, np.inf)
        bounds = (-anywhere, anywhere) if own is None else (own.position_lower, own.position_upper)

        def free(q: Array) -> NDArray[np.bool_]:
            return np.asarray(~pairs_within(robot, body, q).any(axis=1))

        return route_around(motion_of(part), part.duration, free, bounds, seed, whole=seed > 3)

    def violation(self, each: Overlap) -> Violation:
        """Return an overlap as a violated row."""
        body, phase = self.bodies[each.phase], self._problem.phases[each.phase]
        assert body is not None
        return Violation(phase.name, "clearance", body.label(each.pair), each.time, each.depth, "m", 0.0, "under", 1.0)

    def is_movable(self, each: Overlap) -> bool:
        """Whether rows may move the links of an overlap: those of an arm that is on no given path."""
        phase = self._problem.phases[each.phase]
        return phase.path is None and phase.robot is not None and phase.robot.root == "fixed"

    def _near(self, number: int, part: PhaseSolution, every: bool) -> list[Near]:
        body, robot = self.bodies[number], part.phase.robot
        if body is None or robot is None:
            return []
        x, v = part.joint_states, slice(robot.nq, robot.nq + robot.nv)
        speeds = RESERVE * np.array([np.abs(values[:, v]).max(axis=0) for values in x.values])
        return near_pairs(robot, body, in_time(part), x.breaks, speeds, every=every)


def in_time(part: PhaseSolution) -> Motion:
    """Return the configurations (m, nq) of a solution over times (m,) [s]."""
    x, robot = part.joint_states, part.phase.robot
    assert robot is not None
    return lambda times: np.asarray(x(times)[:, : robot.nq])


def motion_of(part: PhaseSolution) -> Motion:
    """Return the configurations (m, nq) of a solution over fractions (m,) of its phase."""
    first, last = float(part.joint_states.breaks[0]), float(part.joint_states.breaks[-1])
    motion = in_time(part)
    return lambda fractions: motion(first + fractions * (last - first))
