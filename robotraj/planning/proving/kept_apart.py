"""Plans that keep the robot's links from overlapping: rows are added only where a plan comes too near.

A plan is made as if links could overlap, and its motion is compared with the exact shapes. A shallow overlap is pushed
out by rows along the motion. Elsewhere a random search finds a motion around the overlap. Solves on the coarse mesh
start there and end at a free solution (``free_solution``), from which the plan is then made. Where this fails, they
start at a solution that keeps spheres around the links apart. A plan without overlaps is made once more with rows along
itself, for as long as that gains.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from robotraj.fixed_mesh.warm_start import PATIENCE
from robotraj.guess.from_solution import FromSolution
from robotraj.guess.least_time import LineLimits
from robotraj.guess.paths.around_itself import AroundItself, Motion, Route
from robotraj.planning.proving.among_spheres import among_spheres
from robotraj.planning.proving.correction import STOPPED, PlanAttempt, short_of
from robotraj.planning.proving.free_solution import GAIN, SHALLOW, FreeSearch
from robotraj.planning.proving.held_back import held_back
from robotraj.planning.proving.own_overlaps import OVERLAPS, OwnOverlaps, motion_of
from robotraj.planning.proving.search_settings import PUSHES, SearchSettings, coarsely
from robotraj.planning.proving.soft_friction import softest
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.claims.objective_size import objective_size
from robotraj.solution.records import Lack
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.transcription.clearance.surface_rows import NearSurfaces

SEEDS = 4
"""Number of motions from which solves with rows start: the motion that overlaps, where this is shallow; the same with a
way around the overlaps; one that keeps spheres around the links apart; and another between its ends."""
SOLVES = 6
"""Largest number of solves on the coarse mesh along one such motion."""
NONE_YET = (np.inf, np.inf)
"""Depths of overlaps, in sum, of the last two plans with rows.

A further one is made while one of them is deeper by a share of ``GAIN``. Rows that push one pair out may push another
one in, which the next rows then push out.
"""


class _Coarse(NamedTuple):
    """A solve on the coarse mesh, of which ``left`` further ones may follow along the same motion."""

    search: FreeSearch
    left: int
    from_routes: bool


class _Plan(NamedTuple):
    """A plan with the rows of a search, and the depths of overlaps of the last two such plans."""

    search: FreeSearch
    deep: tuple[float, float]


class _AmongSpheres:
    """A solve on the coarse mesh with spheres around the links."""


class _Closer(NamedTuple):
    """The plan with the rows of a search along the one before it, whose objective it has to lower to ``bar``."""

    search: FreeSearch
    bar: float


class KeptApart:
    """The overlaps of the links of a robot, from plan to plan.

    Parameters
    ----------
    problem : Problem
    settings : Settings
    """

    def __init__(self, problem: Problem, settings: Settings) -> None:
        self._problem, self._search = problem, SearchSettings(settings)
        self._overlaps = OwnOverlaps(problem)
        self._stage: _Coarse | _Plan | _AmongSpheres | _Closer | None = None
        self._rows: Sequence[NearSurfaces | None] = ()
        self._open: list[dict[int, float]] = [{} for _ in problem.phases]
        self._seed = 0
        self._was_proved = False  # the plan before, but for its overlaps

    def from_guess(self, guess: InitialGuess | Solution | None) -> PlanAttempt | None:
        """Return the plan with rows along a proved solution whose links nearly touch; None for any other guess.

        Without these rows a plan would leave the solution, overlap, and look for a free motion again.
        """
        if not isinstance(guess, Solution) or guess.proof is None or not guess.proof.holds:
            return None
        names = [_positions_of(part.phase) for part in guess.phases]
        if None in names or names != [_positions_of(phase) for phase in self._problem.phases]:
            return None
        motions = [motion_of(part) for part in guess.phases]
        pairs = [self._overlaps.touching(number, motion) for number, motion in enumerate(motions)]
        if not any(pairs):
            return None
        search = FreeSearch.begin(self._problem, self._overlaps.bodies, motions, True, pairs, guess)
        return self._planned(_Plan(search, NONE_YET), guess, self._search.from_known, "", "rows of the guess")

    def next_attempt(self, found: Solution, dropped: Solution | None) -> PlanAttempt | None:
        """Return the next plan where links overlap along a solution; None where none is left to try.

        Solves on the coarse mesh look for a solution without overlaps first, from which the plan is then made.
        """
        if not found.success:
            return None
        stage, self._stage = self._stage, None
        self._was_proved = found.proof is not None and found.proof.holds
        if self._seed == 0:
            self._search = replace(self._search, patience=max(PATIENCE, found.iterations))
        if isinstance(stage, _Closer) and dropped is None:
            self._rows = stage.search.surfaces
        if dropped is None:
            self._open = [self._overlaps.of(number, part) for number, part in enumerate(found.phases)]
        if not any(pairs for pairs, phase in zip(self._open, self._problem.phases, strict=True) if phase.path is None):
            if dropped is None and self._was_proved and isinstance(stage, (_Plan, _Closer)):
                return self._closer(found, stage.search)
            return None
        attempt = None
        if isinstance(stage, _Coarse) and dropped is not None:
            attempt = self._after_coarse(dropped, stage)
        elif isinstance(stage, _AmongSpheres) and dropped is not None:
            attempt = self._after_spheres(dropped)
        elif isinstance(stage, _Plan):
            attempt = self._after_plan(found, stage, dropped is not None)
        while attempt is None and self._seed < SEEDS:
            self._seed += 1
            attempt = self._from_seed(found)
        return attempt

    def accepts(self, again: Solution) -> bool:
        """Whether a plan was proved as the one before it, wherever its links overlap; a coarse solution is none."""
        if isinstance(self._stage, _Closer):
            proved = again.proof is not None and again.proof.holds
            return proved and again.objective < self._stage.bar and self.allows(again)
        if isinstance(self._stage, (_Coarse, _AmongSpheres)) or not again.success:
            return False
        # A plan that lacks something else is no gain on one that does not.
        return not self._was_proved or (again.proof is not None and again.proof.holds)

    @property
    def surfaces(self) -> Sequence[NearSurfaces | None]:
        """Links that the rows of the last plan keep apart, by phase."""
        return self._rows

    def allows(self, again: Solution) -> bool:
        """Whether no links overlap along a plan that did not along the one before."""
        return all(pairs or not self._overlaps.of(k, again.phases[k]) for k, pairs in enumerate(self._open))

    def judged(self, found: Solution) -> Solution:
        """Return a solution whose proof does not hold where links overlap.

        It counts as solved if no row can move the links: on a given path, or where legs overlap in their gait.
        """
        if not any(self._open) or found.proof is None:
            return found
        stopped = found.status in STOPPED
        overlaps = self._overlaps.at_known_times(found, self._open) if stopped else self._overlaps.deepest(found)
        movable = any(self._overlaps.is_movable(each) for each in overlaps)
        depth = max((each.depth for each in overlaps), default=0.0)
        return short_of(found, depth, list(map(self._overlaps.violation, overlaps)), is_met=not movable)

    def _along(self, routes: tuple[Route | None, ...], found: Solution) -> PlanAttempt:
        """Return the first solve on the coarse mesh with rows along free motions, or along the solution itself."""
        are_free = any(routes)
        guess = AroundItself(routes, FromSolution(found)) if are_free else found
        motions: list[Motion] = [route or motion_of(part) for route, part in zip(routes, found.phases, strict=True)]
        search = FreeSearch.begin(self._problem, self._overlaps.bodies, motions, are_free, self._open, guess)
        first = _Coarse(search, (SOLVES if are_free else PUSHES) - 1, are_free)
        return self._on_coarse(first, OVERLAPS, "a way around itself" if are_free else "rows along the motion")

    def _on_coarse(self, stage: _Coarse, lacked: str, why: str) -> PlanAttempt:
        """Return the next solve on the coarse mesh."""
        self._stage, search = stage, stage.search
        own = coarsely(self._search.nearby(stage.from_routes))
        if isinstance(search.start, Solution):
            own = replace(own, solver=own.solver.from_nearby())
        return PlanAttempt(softest(self._problem), search.start, own, search.surfaces, lacked, why, is_single=True)

    def _after_coarse(self, solution: Solution, stage: _Coarse) -> PlanAttempt | None:
        """Return what follows from a solve on the coarse mesh: a further one, or the plan from the best of them."""
        search = stage.search
        if solution.success:
            motions = [motion_of(part) for part in solution.phases]
            hit = [self._overlaps.sampled(number, motion) for number, motion in enumerate(motions)]
            cost = np.inf if any(hit) else held_back(solution, self._overlaps.bodies)
            search = search.respond(solution, motions, hit, cost)
            if stage.left and not search.is_over:
                further = stage._replace(search=search, left=stage.left - 1)
                return self._on_coarse(further, OVERLAPS if any(hit) else "", "rows along the free motion")
        if search.best is None:
            return None
        own = self._search.from_known if stage.from_routes else self._search.nearby(False)
        plan = self._planned(_Plan(search, NONE_YET), search.best, own, "", "the plan from the free motion")
        return plan._replace(is_brief=not stage.from_routes)

    def _planned(self, stage: _Plan, guess: Solution, settings: Settings, lacked: str, why: str) -> PlanAttempt:
        """Return the plan with the rows of a search."""
        self._stage, self._rows = stage, stage.search.surfaces
        return PlanAttempt(self._problem, guess, settings, self._rows, lacked, why)

    def _after_plan(self, found: Solution, plan: _Plan, refused: bool) -> PlanAttempt | None:
        """Return the plan with further rows against one that overlaps, or with the rows of the best free solution."""
        further = None if refused or not self._has_routes(found) else self._further(found, plan)
        best, behind = plan.search.best, plan.search.behind
        if further is not None or best is None or behind is None:
            return further
        # The rows at which the best free solution ended keep a finer one near it.
        last = _Plan(replace(behind, best=None, behind=None), NONE_YET)
        attempt = self._planned(last, best, self._search.from_known, OVERLAPS, "the rows before it")
        return attempt._replace(is_brief=False)

    def _further(self, found: Solution, plan: _Plan) -> PlanAttempt | None:
        """Return the plan with further rows along a plan that overlaps, on its meshes; None where they do not help."""
        depths = self._overlaps.depths_at(found, self._open)
        deep = sum(depth for each in depths for depth in each.values())
        if deep > (1.0 - GAIN) * max(plan.deep):
            return None
        search = plan.search.overlapped([motion_of(part) for part in found.phases], depths)
        own, further = self._search.on_meshes_of(found, True), _Plan(search, (plan.deep[1], deep))
        return self._planned(further, found, own, OVERLAPS, "further rows")

    def _from_seed(self, found: Solution) -> PlanAttempt | None:
        """Return the first solve from the next motion; None without one."""
        if self._seed == 1:
            return self._along((None,) * len(found.phases), found) if self._is_shallow(found) else None
        if self._seed == 3:
            return self._with_spheres() if self._has_routes(found) else None
        routes = tuple(
            self._overlaps.route(number, part, self._seed) if self._open[number] else None
            for number, part in enumerate(found.phases)
        )
        complete = all(route or not pairs for route, pairs in zip(routes, self._open, strict=True))
        return self._along(routes, found) if complete else None

    def _with_spheres(self) -> PlanAttempt | None:
        """Return the solve that keeps spheres around the links apart; None where they are apart, or refuse an end."""
        problem = among_spheres(softest(self._problem), self._open)
        if problem is None:
            return None
        self._stage = _AmongSpheres()
        own = coarsely(self._search.from_known)
        return PlanAttempt(problem, None, own, (), OVERLAPS, "spheres around the links", is_single=True)

    def _after_spheres(self, solution: Solution) -> PlanAttempt | None:
        """Return the first solve with rows on the exact shapes along one with spheres, which are larger than these."""
        if not solution.success:
            return None
        motions = [motion_of(part) for part in solution.phases]
        hit = [self._overlaps.sampled(number, motion) for number, motion in enumerate(motions)]
        pairs = [{*known, *more} for known, more in zip(self._open, hit, strict=True)]
        search = FreeSearch.begin(self._problem, self._overlaps.bodies, motions, not any(hit), pairs, solution)
        if not any(hit):
            search = replace(search, best=solution, behind=search)
        first = _Coarse(search, SOLVES - 1, True)
        return self._on_coarse(first, OVERLAPS if any(hit) else "", "rows along the motion")

    def _closer(self, found: Solution, search: FreeSearch) -> PlanAttempt | None:
        """Return the plan with rows along the one before it; None where its own rows hardly hold it back."""
        goals = self._search.own.goals
        assert goals is not None
        size = objective_size(found.phases, found.objective)
        cost = held_back(found, self._overlaps.bodies) / size
        if cost <= goals.objective:
            return None
        motions = [motion_of(part) for part in found.phases]
        along = FreeSearch.begin(self._problem, self._overlaps.bodies, motions, True, search.pairs, found)
        self._stage = _Closer(along, found.objective - goals.objective * size)
        own = self._search.on_meshes_of(found, False)
        lacked = str(Lack("objective that rows between links may cost", cost, goals.objective))
        return PlanAttempt(self._problem, found, own, along.surfaces, lacked, "rows along the plan")

    def _has_routes(self, found: Solution) -> bool:
        """Whether all overlaps are those of arms with a motor at every joint, whose guesses can be routes."""
        return all(LineLimits.of(part.phase) for part, pairs in zip(found.phases, self._open, strict=True) if pairs)

    def _is_shallow(self, found: Solution) -> bool:
        """Whether rows along the motion push all overlaps out: they are shallow, or nothing else is known to help."""
        depths = self._overlaps.depths_at(found, self._open)
        lined = (LineLimits.of(phase) is not None for phase in self._problem.phases)
        return all(
            depth <= SHALLOW for own, known in zip(lined, depths, strict=True) if own for depth in known.values()
        )


def _positions_of(phase: Phase) -> tuple[str, ...] | None:
    """Return the names of the positions of a phase's robot; None for a System."""
    return None if phase.robot is None else tuple(phase.robot.position_names)
