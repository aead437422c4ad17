"""Plan until the plan is proved: solve, measure the errors between the points, and refine the mesh.

A first, coarse mesh approximates the motion, and a second one finds its optimum. The order of the scheme predicts the
mesh that is needed, from the errors of the intervals and from the change of the objective. Where an exact motion
exceeds limits of torques between the points, they are lowered there by the excess, on the same mesh. Where a finer
mesh is not solved, a first one takes iterations without end, or errors stagnate, controls of systems become lines.
Where that does not help either, and the solution on the coarse mesh is no motion, the plan begins again from its guess.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np

from robotraj.planning.proving.measures import Measured, is_motion, measured, proof_on
from robotraj.planning.proving.soft_friction import needs_softening
from robotraj.planning.proving.soft_solves import finer_where_bent, soft_solution
from robotraj.planning.proving.solves import Solves
from robotraj.planning.setting_conditions import is_kinked
from robotraj.planning.warm_start import PATIENCE
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import are_clear
from robotraj.solution.proof import Proof
from robotraj.solution.records import MeshStep
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress, Solver
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.equidistribution import Equidistribute, evenly_finer
from robotraj.transcription.refinement.linear_controls import ENDLESS, on_lines
from robotraj.transcription.refinement.switches import switches, with_knots_at
from robotraj.transcription.schemes.mesh import Mesh

MOST_MESHES = 8
"""Largest number of meshes of a plan."""
ENOUGH = 4
"""Largest number of meshes for a proved motion whose objective has not settled, unless joints stick and slide."""
PATIENCE_STICKING = 300
"""``PATIENCE`` where joints stick and slide."""
CHANGE_FLAT = 1e-4
"""Relative change of the objective within eight iterations below which a solve ends where objectives are flat.

Reversals with dry friction, and times at which powers change their sign, move from point to point. They gain 1e-4 in a
hundred iterations, and the next mesh moves them again.
"""
MET = 1e-3
"""Shortfall of a distance on a given path from which finer meshes are of no use [m]."""
SPENT = (Status.TIME_LIMIT, Status.MEMORY_LIMIT)
LIMITS_OF_THE_USER = (Status.ITERATION_LIMIT, *SPENT)
"""Statuses after which no finer mesh is tried."""
SECOND = 1.5
"""Growth of the number of intervals from a first mesh that could not be solved to the second one."""
LEAP = 1.6
"""Growth of the number of intervals above which a solve may lead away from the optimum of the mesh before."""
DOUBLED = 2.0
"""Growth of the number of intervals of phases that miss their goal where an error stagnates.

After a second time the plan ends."""


def prove(
    problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None = None
) -> Solution:
    """Plan on finer and finer meshes until ``settings.goals`` hold.

    Returns
    -------
    Solution
        With ``proof``. Its status is ``Status.NOT_PROVED`` if it is no motion within its limits. If a finer mesh cannot
        be solved, it is the solution on the coarser one.
    """
    return _Refining(problem, settings, progress).plan(guess)


class _Refining:
    """A plan on one mesh after the other."""

    def __init__(self, problem: Problem, settings: Settings, progress: Progress | None) -> None:
        assert settings.goals is not None
        self.problem, self.settings, self.progress, self.goals = problem, settings, progress, settings.goals
        self.best: Solution | None = None
        self.steps: list[MeshStep] = []
        self.solves = Solves(progress)
        self.sticking = needs_softening(problem)
        """Whether joints stick and slide to save effort."""
        self.kinked = any(is_kinked(phase) for phase in problem.phases)
        self.flat = self.sticking or self.kinked
        self.solver = settings.solver.until_settled(CHANGE_FLAT) if self.flat else settings.solver
        self.measures: Measured | None = None
        """Measures of the best solution so far."""
        self.unchecked: tuple[object, Measured] | None = None
        """Phases and measures of the last solution that was measured before limits were imposed between its points."""
        self.limits_between = False
        """Whether limits are imposed between the points on the present mesh."""
        self.neighbour: Proof | None = None
        """Proof of a similar problem on the first mesh, whose solution is the guess."""
        self.afresh = False
        """Whether the plan began again from the guess, on a finer mesh."""

    def plan(self, guess: InitialGuess | Solution | None) -> Solution:
        """Solve on one mesh after the other."""
        mesh = self.settings.mesh
        meshes = coarsest = (mesh,) * len(self.problem.phases) if isinstance(mesh, Mesh) else tuple(mesh)
        lines, soft = on_lines(self.problem, coarsest), None
        if self.sticking and not isinstance(guess, Solution):
            soft = soft_solution(self.problem, guess, meshes, self.settings, self.solves)
        if soft is not None:
            guess, meshes = soft, finer_where_bent(soft, self.settings)
        self.neighbour = proof_on(guess, meshes)
        last: Solution | None = None
        best_limited, stagnant = False, 0
        for number in range(MOST_MESHES):
            first = number == 0 and self.neighbour is None
            try:
                self.limits_between = number == MOST_MESHES - 1 or (number >= ENOUGH - 1 and not self._patient)
                known = soft or self.best or self.neighbour
                last = self._on(meshes, self.best or guess, first, nearby=known is not None)
            except KeyboardInterrupt:
                if last is None:
                    raise
                return self.solves.concluded(replace(self.best or last, status=Status.INTERRUPTED), self.steps)
            if last.status is Status.INTERRUPTED:
                return self.solves.concluded(replace(self.best or last, status=Status.INTERRUPTED), self.steps)
            # Free controls may exploit the program of a coarse mesh.
            endless = last.iterations >= ENDLESS and lines != coarsest
            if last.success:
                self.best = last = self._measured(last, self.measures)
                best_limited = self.limits_between
                if self._meets_obstacle_on_path(last):
                    break
            elif (
                (not first or endless)
                and last.status not in SPENT
                and (calmer := on_lines(self.problem, meshes)) != meshes
            ):
                meshes = calmer
                continue
            elif self._strayed(last, endless):
                # What a coarse mesh took for a motion is none, and leads to none.
                self.best, self.measures, self.afresh = None, None, True
                meshes = tuple(evenly_finer(mesh, SECOND) for mesh in (lines if endless else coarsest))
                continue
            elif smaller := self._smaller_step(last, meshes):
                meshes = smaller
                continue
            elif not first or last.status in LIMITS_OF_THE_USER or are_clear(last.conflicts):
                break
            if not first and last.proof is not None and last.proof.holds:
                break
            if number >= ENOUGH - 1 and not self._patient and self.best is not None and is_motion(self.best):
                break
            phase = None if self.measures is None else self.measures.stagnant
            stagnant = 0 if phase is None else stagnant + 1
            least = 1.0 if not first else self._second if soft is None else SECOND
            finer = self._finer(meshes, least, DOUBLED if stagnant else 1.0)
            if stagnant == 1 or finer == meshes:
                lines = on_lines(self.problem, finer)
                finer = tuple(lines[k] if k == phase or phase is None else each for k, each in enumerate(finer))
            if stagnant > 1 or finer == meshes:
                break
            meshes = finer
        assert last is not None
        if self.best is not None and is_motion(self.best):
            self._move_knots_to_switches()
        elif self.best is not None and not best_limited:
            self._limit_best_between()
        return self.solves.concluded(self.best or last, self.steps)

    @property
    def _patient(self) -> bool:
        """Whether more meshes than ``ENOUGH`` pay where only the objective of a proved motion has not settled."""
        return self.sticking and not self.kinked

    def _smaller_step(self, failed: Solution, meshes: tuple[Mesh, ...]) -> tuple[Mesh, ...]:
        """Return meshes between the last ones and much finer ones on which limited iterations did not suffice.

        None are returned for flat objectives, which take many iterations on any mesh.
        """
        limited = failed.status is Status.ITERATION_LIMIT and self.measures is not None and self.measures.only_unsettled
        if not limited or self.best is None or self.flat:
            return ()
        before = [part.mesh for part in self.best.phases]
        leapt = any(mesh.count > LEAP * coarse.count for mesh, coarse in zip(meshes, before, strict=True))
        return tuple(evenly_finer(mesh, SECOND) for mesh in before) if leapt else ()

    def _strayed(self, failed: Solution, endless: bool) -> bool:
        """Whether a finer mesh has no solution near that of a coarse one, which is no motion."""
        ended = self.afresh or failed.status in (SPENT if endless else LIMITS_OF_THE_USER)
        return not ended and self.best is not None and not is_motion(self.best)

    def _meets_obstacle_on_path(self, solution: Solution) -> bool:
        """Whether a moving obstacle is met on a given path, which no finer mesh changes."""
        on_path = any(phase.path is not None for phase in self.problem.phases)
        return on_path and solution.proof is not None and solution.proof.shortfall > MET

    def _limit_best_between(self) -> None:
        """Solve with limits between the points of the best motion, which were left to a mesh that was not solved."""
        assert self.best is not None and self.measures is not None
        before, self.limits_between = self.measures.before, True
        with suppress(KeyboardInterrupt):
            found = self._on(tuple(part.mesh for part in self.best.phases), self.best, first=False, nearby=True)
            if found.success:
                self.steps.pop()
                self.best = self._measured(found, before)

    def _move_knots_to_switches(self) -> None:
        """Solve again with knots where bounded rates jump; a motion that is not proved or no better is dropped."""
        assert self.best is not None and self.measures is not None
        kept, measures, self.limits_between = self.best, self.measures, True
        meshes = tuple(with_knots_at(part.mesh, switches(part.phase, part.trajectory)) for part in kept.phases)
        if meshes == tuple(part.mesh for part in kept.phases):
            return
        with suppress(KeyboardInterrupt):
            found = self._on(meshes, kept, first=False, nearby=True)
            if found.success and found.objective < kept.objective:
                moved = self._measured(found, measures.before)
                if moved.proof is not None and moved.proof.motion_holds:
                    # What is left to gain is no more than before.
                    left = min(moved.proof.unsettled, measures.proof.unsettled)
                    self.best = replace(moved, proof=replace(moved.proof, unsettled=left))
                    return
                self.steps.pop()
        self.measures = measures

    def _is_settled(self, solution: Solution) -> bool:
        """Whether the mesh of a solution is fine enough for limits to be imposed between its points."""
        measures = self._measures(solution, self.measures)
        self.unchecked = solution.phases, measures
        self.limits_between = measures.proof.error <= self.goals.error and measures.growth <= 1.0
        return self.limits_between

    @property
    def _second(self) -> float:
        """Growth from the first mesh to the second."""
        refinement = self.settings.refinement
        return refinement.second if isinstance(refinement, Equidistribute) else SECOND

    def _finer(self, meshes: tuple[Mesh, ...], least: float, missed: float) -> tuple[Mesh, ...]:
        """Return the next meshes, with ``missed`` times as many intervals in phases whose error exceeds its goal.

        Without measures, all intervals are divided evenly.
        """
        refinement = self.settings.refinement
        assert refinement is not None
        if self.best is None or self.measures is None:
            return tuple(evenly_finer(mesh, max(least, missed, SECOND)) for mesh in meshes)
        return self.measures.next_meshes(self.best.phases, refinement, max(least, self.measures.growth), missed)

    def _on(
        self, meshes: tuple[Mesh, ...], start: InitialGuess | Solution | None, first: bool, nearby: bool
    ) -> Solution:
        """Solve on meshes; where torques exceed their limits between the points, lower the limits there.

        Limits between the points are ignored on the first meshes, which only find a guess for the next. They are also
        ignored where the objective needs a finer mesh, unless ``limits_between``.
        """
        settings = replace(self.settings, mesh=meshes, solver=self._warm if nearby else self.solver)
        if self.measures is not None and self.measures.only_unsettled:
            patience = PATIENCE_STICKING if self._patient else PATIENCE
            settings = replace(settings, solver=settings.solver.at_most(patience), restarts=Restarts(0))
        if first:
            plain = replace(settings.interval_limits, rounds=0)
            return self.solves.solve(self.problem, start, replace(settings, interval_limits=plain))
        if self.best is None and not self.afresh:
            # Other guesses were tried on the first mesh.
            settings = replace(settings, restarts=Restarts(0))
        return self.solves.solve(
            self.problem, start, settings, lower=True, hold=None if self.limits_between else self._is_settled
        )

    @property
    def _warm(self) -> Solver:
        """The solver of a solve that starts from a solution on another mesh."""
        if self.sticking and self.best is None:
            # The solution with soft friction is that of another problem.
            return self.solver
        # Limits of rates are active nearly everywhere in least time. Lower and upper ones alternate with the mesh,
        # as the signs of powers do.
        return self.solver.from_nearby(altered=self.kinked or any(phase.rows.rates for phase in self.problem.phases))

    def _measured(self, solution: Solution, before: Measured | None) -> Solution:
        """Measure a solution between its points, and compare it with the solutions ``before``."""
        if self.unchecked is not None and self.unchecked[0] is solution.phases and self.unchecked[1].before is before:
            self.measures = self.unchecked[1].with_violations(solution)
        else:
            self.measures = self._measures(solution, before)
        self.unchecked = None
        proof, parts = self.measures.proof, solution.phases
        points, intervals = sum(len(part.points) for part in parts), sum(part.mesh.count for part in parts)
        step = MeshStep(intervals, points, proof.error, solution.objective, solution.iterations, solution.seconds)
        self.steps.append(step)
        return replace(solution, proof=proof)

    def _measures(self, solution: Solution, before: Measured | None) -> Measured:
        """Measure a solution; without a coarser mesh, its objective still has to gain what the neighbour's had."""
        expected = np.inf if self.neighbour is None else self.neighbour.unsettled
        return measured(solution, before, self.goals, self.sticking, expected)
