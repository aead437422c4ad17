"""Plans that keep the robot's links from overlapping: rows are added only where a plan comes too near.

A plan is made as if links could overlap, and its motion is compared with the exact shapes. Pairs that overlap get rows
along this motion, and the plan is made again from it, until no pair overlaps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotraj.guess.from_solution import FromSolution
from robotraj.guess.least_time import LineLimits
from robotraj.guess.paths.around_itself import AlongCorners, free_path
from robotraj.planning.diagnosis.self_collision import body_of
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.collision.along_motion import deepest_overlap, near_pairs, overlapping
from robotraj.robot.collision.own_body import OwnBody
from robotraj.robot.limits import Limits
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.records import with_effort_of
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solution.violation import Violation
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.status import Status

if TYPE_CHECKING:
    from robotraj.transcription.clearance.surface_rows import NearSurfaces, Path

Array = NDArray[np.float64]

ROUNDS, LINEAR = 10, 4
"""Largest number of plans with rows, and of those before a path without overlaps is the guess."""
PATIENCE = 150
"""Largest number of iterations of a solve along an overlapping motion."""
MARGIN = 2e-3
"""Least height of points above the other surface in the first round [m]."""
MORE = 1e-3
"""Growth of this height, beyond the depth of the overlap that is left, from round to round [m]."""
MOST = 0.02
"""Largest height [m]."""
RESERVE = 1.2
"""Factor on the joint speeds at the points of an interval, for those between them."""
STOPPED = (Status.INTERRUPTED, Status.TIME_LIMIT, Status.MEMORY_LIMIT)
"""Statuses after which nothing else is tried."""
LEAST = 1e-6
"""Least depth of an overlap [m]; where edges cross, no point lies inside."""


class Overlap(NamedTuple):
    """A pair of shapes that overlaps in a phase: its deepest overlap [m], and the time [s]."""

    phase: int
    pair: int
    depth: float
    time: float


class PlanAttempt(NamedTuple):
    """A plan with rows on surfaces: its guess and settings, and whether it ends with the first solve that fails."""

    guess: InitialGuess | Solution
    settings: Settings
    surfaces: Sequence[NearSurfaces | None]
    is_brief: bool


class KeptApart:
    """The overlaps of the links of a robot, from plan to plan.

    Rows along an overlapping motion are tried first: they push the shallow side out. Where they have no solution, the
    guess is a path without overlaps, if arms have one between fixed ends.

    Parameters
    ----------
    problem : Problem
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._bodies = [body_of(phase) for phase in problem.phases]
        self._margins: list[dict[int, float]] = [{} for _ in problem.phases]
        self._overlaps: list[Overlap] = []
        self._rounds = 0
        self._failed = False
        self._around = False

    def next_attempt(self, found: Solution, settings: Settings) -> PlanAttempt | None:
        """Return the next plan where links overlap along a solution; None where none is left to try."""
        if not found.success or self._rounds == ROUNDS:
            return None
        if not self._failed:
            self._overlaps = self._found(found)
        movable = [each for each in self._overlaps if self._problem.phases[each.phase].path is None]
        if not movable or (self._failed and self._around):
            return None
        self._rounds += 1
        for each in movable:
            margins = self._margins[each.phase]
            raised = margins[each.pair] + each.depth + MORE if each.pair in margins and not self._failed else MARGIN
            margins[each.pair] = min(raised, MOST)
        if self._failed or self._rounds > LINEAR:
            self._failed, self._around = False, True
            return self._attempt_around(found, settings)
        surfaces = [self._surfaces(part.phase, phase, _by_fractions(part)) for phase, part in enumerate(found.phases)]
        solver = settings.solver
        # A failure here has another guess, and needs no second opinion.
        if isinstance(solver, InteriorPoint):
            solver = replace(solver, fallback=None)
        near = replace(
            settings,
            mesh=tuple(part.mesh for part in found.phases),
            restarts=Restarts(0),
            solver=solver.at_most(PATIENCE),
        )
        return PlanAttempt(found, near, surfaces, True)

    def kept(self, before: Solution, found: Solution) -> Solution:
        """Return a plan with rows, or else the one before it, with the effort of both."""
        self._failed = not found.success
        if found.status in STOPPED:
            # Nothing else is tried; the plan before it is a motion, although links overlap.
            return replace(with_effort_of(found, before), status=found.status)
        return with_effort_of(found, before) if self._failed else with_effort_of(before, found)

    def _attempt_around(self, found: Solution, settings: Settings) -> PlanAttempt | None:
        """Return a plan from a path without overlaps; None where there is none."""
        corners: list[Array | None] = []
        for phase, margins in enumerate(self._margins):
            corners.append(self._path(phase) if margins else None)
            if margins and corners[-1] is None:
                return None
        guess = AlongCorners(tuple(corners), FromSolution(found))
        surfaces = []
        for phase, part in enumerate(found.phases):
            states, nq = guess.of(part.phase, phase).states, part.phase.robot.nq if part.phase.robot else 0
            surfaces.append(self._surfaces(part.phase, phase, partial(_positions, states, nq)))
        return PlanAttempt(guess, replace(settings, restarts=Restarts(0)), surfaces, False)

    def _path(self, phase: int) -> Array | None:
        """Return the corners of a path of a phase without overlaps, between its fixed ends."""
        posed, body = self._problem.phases[phase], self._bodies[phase]
        limits, robot = LineLimits.of(posed), posed.robot
        ends = [np.asarray(bounds.lower) for bounds in posed.joint_ends.values()]
        if body is None or robot is None or limits is None or not all(map(np.array_equal, ends, _upper(posed))):
            return None
        first, last = (end[: robot.nq] for end in ends)
        own = posed.limits if isinstance(posed.limits, Limits) else None
        free = np.full(robot.nq, np.inf)
        lower, upper = (-free, free) if own is None else (own.position_lower, own.position_upper)
        return free_path(lambda q: ~overlapping(robot, body, q), first, last, lower, upper)

    def judged(self, found: Solution) -> Solution:
        """Return a solution whose proof does not hold where links overlap.

        It counts as solved if no row can move the links: on a given path, or where legs overlap in their gait.
        """
        if not self._overlaps or found.proof is None:
            return found
        shortfall = max(found.proof.shortfall, *(each.depth for each in self._overlaps))
        movable = any(self._is_movable(each) for each in self._overlaps)
        status = Status.NOT_PROVED if movable and found.status is Status.SOLVED else found.status
        broken = tuple(self._violation(each) for each in self._overlaps)
        return replace(
            found,
            status=status,
            proof=replace(found.proof, shortfall=shortfall),
            interval_violations=(*found.interval_violations, *broken),
        )

    def _is_movable(self, each: Overlap) -> bool:
        phase = self._problem.phases[each.phase]
        return phase.path is None and phase.robot is not None and phase.robot.root == "fixed"

    def _found(self, found: Solution) -> list[Overlap]:
        overlaps = []
        for phase, (part, body) in enumerate(zip(found.phases, self._bodies, strict=True)):
            robot = part.phase.robot
            if body is None or robot is None:
                continue
            motion = _motion(part)
            x, v = part.joint_states, slice(robot.nq, robot.nq + robot.nv)
            speeds = RESERVE * np.array([np.abs(values[:, v]).max(axis=0) for values in x.values])
            for each in near_pairs(robot, body, motion, x.breaks, speeds):
                if each.overlaps:
                    depth, time = deepest_overlap(robot, body, motion, each)
                    overlaps.append(Overlap(phase, each.pair, max(depth, LEAST), time))
        return overlaps

    def _surfaces(self, posed: Phase, phase: int, motion: Path) -> NearSurfaces | None:
        from robotraj.transcription.clearance.surface_rows import NearSurfaces

        body, robot, margins = self._bodies[phase], posed.robot, dict(self._margins[phase])
        if body is None or robot is None or not margins:
            return None
        ends = {pair: self._least_at_ends(posed, body, pair) for pair in margins}
        return NearSurfaces(robot, body, motion, margins, ends)

    def _least_at_ends(self, phase: Phase, body: OwnBody, pair: int) -> tuple[float, float]:
        """Return half the distance of a pair at each end that is fixed [m], infinite at others."""
        assert phase.robot is not None
        least = []
        for bounds in phase.joint_ends.values():
            q = np.asarray(bounds.lower[: phase.robot.nq])
            fixed = np.array_equal(q, bounds.upper[: phase.robot.nq])
            least.append(0.5 * body.distance(phase.robot, q, pair) if fixed else np.inf)
        return least[0], least[1]

    def _violation(self, each: Overlap) -> Violation:
        body, phase = self._bodies[each.phase], self._problem.phases[each.phase]
        assert body is not None
        return Violation(phase.name, "clearance", body.label(each.pair), each.time, each.depth, "m", 0.0, "under", 1.0)


def _upper(phase: Phase) -> list[Array]:
    return [np.asarray(bounds.upper) for bounds in phase.joint_ends.values()]


def _positions(states: Path, nq: int, fractions: Array) -> Array:
    return np.asarray(states(fractions)[:, :nq])


def _motion(part: PhaseSolution) -> Path:
    x, robot = part.joint_states, part.phase.robot
    assert robot is not None
    return lambda times: np.asarray(x(times)[:, : robot.nq])


def _by_fractions(part: PhaseSolution) -> Path:
    first, last = float(part.joint_states.breaks[0]), float(part.joint_states.breaks[-1])
    motion = _motion(part)
    return lambda fractions: motion(first + fractions * (last - first))
