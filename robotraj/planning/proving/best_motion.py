"""Solutions of a problem on one mesh after the other: the best one so far, and its measures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.time_left import LimitReached
from robotraj.planning.plan_limits import PlanLimits
from robotraj.planning.proving.local_optimum import gain_from
from robotraj.planning.proving.measures import Measured, is_motion, largest_roughness, measured
from robotraj.planning.proving.solves import Solves
from robotraj.planning.sizes.shares import shares_of
from robotraj.planning.warm_start import PATIENCE
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.claims.objective_size import objective_size, size_for
from robotraj.solution.proof import Proof
from robotraj.solution.records import MeshStep
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress, Solver
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.status import Status
from robotraj.transcription.interval_limits.full_friction import has_full_friction
from robotraj.transcription.refinement.switches import switches, with_knots_at
from robotraj.transcription.schemes.mesh import Mesh

if TYPE_CHECKING:
    from robotraj.transcription.clearance.surface_rows import NearSurfaces

PATIENCE_STICKING = 300
"""``PATIENCE`` where joints stick and slide."""
CHANGE_FLAT = 1e-4
"""Relative change of the objective within eight iterations below which a solve ends where objectives are flat.

Reversals with dry friction, and times at which powers change their sign, move from point to point. They gain 1e-4 in a
hundred iterations, and the next mesh moves them again.
"""
CHANGE_OF_POWERS = 3e-3
"""The same where joints stick and slide and the objective has kinks: hundreds of iterations gain a percent.

Most of that gain is power between the points, which the sum that is minimised does not see."""
BARRIER_OF_POWERS = 1e-4
"""First barrier parameter there on a later mesh. A larger one raises the objective by a fifth, and takes a hundred
iterations to lower it again."""
SMOOTHER = 6.0
"""Factor on the weight of smooth torques where they alternate with the mesh nevertheless."""
BEYOND = 1.0
"""Excess over a limit, relative to its bound, above which no lower limit helps: the motion needs a finer mesh."""


class BestMotion:
    """Solves a problem on given meshes, and keeps the best solution with its measures.

    Attributes
    ----------
    problem : Problem
    settings : Settings
        With goals and a refinement.
    solves : Solves
    solution : Solution or None
        The best solution so far, with its proof.
    measures : Measured or None
        Measures of the best solution.
    steps : list of MeshStep
    sticking : bool
        Whether joints stick and slide to save effort.
    has_full_friction : bool
        Whether limits of torques between the points are those against full dry friction. Least times depend on them, so
        that they are imposed on every mesh.
    limits_between : bool
        Whether limits are imposed between the points on the present mesh.
    neighbour : Proof or None
        Proof of a similar problem on the first mesh, whose solution is the guess.
    near : bool
        Whether the guess is a solution of a similar problem.
    first : Solution or None
        The first solution, whose program is solved again from the plan.
    afresh : bool
        Whether the plan began again from the guess, on a finer mesh.
    """

    def __init__(
        self,
        problem: Problem,
        settings: Settings,
        progress: Progress | None,
        surfaces: Sequence[NearSurfaces | None] = (),
    ) -> None:
        assert settings.goals is not None
        self.problem, self.settings, self.goals = problem, settings, settings.goals
        self.solution: Solution | None = None
        self.first: Solution | None = None
        self.measures: Measured | None = None
        self.steps: list[MeshStep] = []
        self.solves = Solves(progress, surfaces)
        shares = shares_of(problem)
        self.sticking, self.kinked = shares.sticking, shares.kinked
        self.has_full_friction = any(map(has_full_friction, problem.phases))
        change = CHANGE_OF_POWERS if self.has_sticking_powers else CHANGE_FLAT
        # The objective is flat near its optimum: iterations move kinks from point to point.
        flat = self.sticking or self.kinked
        self.solver = settings.solver.until_settled(change) if flat else settings.solver
        self.limits_between = False
        self.neighbour: Proof | None = None
        self.near = False
        self.afresh = False
        self._is_limited = False
        self._unchecked: tuple[object, Measured] | None = None
        """Phases and measures of the last solution that was measured before limits were imposed between its points."""

    @property
    def is_motion(self) -> bool:
        """Whether the best solution is a motion within its limits."""
        return self.solution is not None and is_motion(self.solution)

    @property
    def is_patient(self) -> bool:
        """Whether many iterations and meshes pay where only the objective of a proved motion has not settled."""
        return self.sticking and not self.kinked

    @property
    def has_sticking_powers(self) -> bool:
        """Whether joints stick and slide and the objective has kinks, as powers have where they change their sign."""
        return self.sticking and self.kinked

    def begin_afresh(self) -> None:
        """Drop the best solution: what a coarse mesh took for a motion is none, and leads to none."""
        self.solution, self.first, self.measures, self.afresh = None, None, None, True

    def solve(
        self,
        meshes: tuple[Mesh, ...],
        guess: InitialGuess | Solution | None,
        first: bool,
        start: Solution | None = None,
    ) -> Solution:
        """Solve on meshes, from ``start``, else from the best solution, else from ``guess``.

        Limits between the points are ignored on the first meshes, which only find a guess for the next. They are also
        ignored where the objective needs a finer mesh, unless ``limits_between``. Where torques exceed their limits
        between the points, these limits are lowered there.
        """
        begin = start or self.solution or guess
        solver = self._warm_solver if self.near or self.solution is not None else self.solver
        settings = replace(self.settings, mesh=meshes, solver=solver)
        if self.measures is not None and self.measures.only_unsettled:
            patience = PATIENCE_STICKING if self.is_patient else PATIENCE
            settings = replace(settings, solver=settings.solver.at_most(patience), restarts=Restarts(0))
        if first and not self.has_full_friction:
            plain = replace(settings.interval_limits, rounds=0)
            return self.solves.solve(self.problem, begin, replace(settings, interval_limits=plain))
        if self.solution is None and not self.afresh:
            # Other guesses were tried on the first mesh.
            settings = replace(settings, restarts=Restarts(0))
        hold = None if self.limits_between else self._is_settled
        return self.solves.solve(self.problem, begin, settings, lower=True, hold=hold)

    def keep(self, solution: Solution) -> Solution:
        """Keep a solution as the best one, and return it with its proof."""
        self.solution = self._with_proof(solution, self.measures)
        self.first = self.first or self.solution
        self._is_limited = self.limits_between
        return self.solution

    def conclude(self, last: Solution) -> Solution:
        """Impose what is left on the best solution, and return it with the records of the plan; else ``last``.

        A proved motion gets knots where bounded rates jump, and smoother torques where they alternate. Any other is
        solved again with limits between its points, if these were left to a mesh that was not solved.
        """
        if self.is_motion:
            self._move_knots_to_switches()
            self._smooth()
            self._settle()
        elif self.solution is not None and not self._is_limited:
            self._limit_between()
        return self.solves.concluded(self.solution or last, self.steps)

    def interrupted(self, last: Solution) -> Solution:
        """Return the best solution, or else ``last``, with the records of the plan so far."""
        return self.solves.concluded(replace(self.solution or last, status=Status.INTERRUPTED), self.steps)

    def _limit_between(self) -> None:
        """Solve with limits between the points on the meshes of the best solution."""
        assert self.solution is not None and self.measures is not None
        before, self.limits_between = self.measures.before, True
        with suppress(LimitReached):
            found = self.solve(tuple(part.mesh for part in self.solution.phases), None, first=False)
            if found.success:
                self.steps.pop()
                self.solution = self._with_proof(found, before)

    def _settle(self) -> None:
        """Solve once more from a plan that holds, on a mesh no finer; what that gains, the plan has missed.

        A gain is solved on the meshes of the plan, too, since a coarse mesh may only gain between its points. Where it
        is a motion there, it replaces the plan. Where it is not found there, the objective has not settled.
        """
        plan, first, measures = self.solution, self.first, self.measures
        assert plan is not None and plan.proof is not None and measures is not None
        if first is None or measures.before is None or not plan.proof.holds:
            return
        with suppress(LimitReached):
            limits = self.solves.progress
            unseen = limits.unseen if isinstance(limits, PlanLimits) else None
            gain = gain_from(plan, first, self.goals, self.solver, unseen)
            if gain is None:
                return
            self.solves.add(gain.outcome, [gain.round])
            if gain.share <= self.goals.objective:
                return
            size = objective_size(plan.phases, plan.objective)
            coarse, self.limits_between = gain.solution, True
            found = self.solve(tuple(part.mesh for part in plan.phases), None, first=False, start=coarse)
            self.solution = replace(plan, proof=replace(plan.proof, unsettled=gain.share))
            if not found.success:
                return
            self.solution = plan
            if plan.objective - found.objective <= self.goals.objective * size:
                return
            better = self._with_proof(found, measures.before)
            if better.proof is not None and better.proof.motion_holds:
                left = max(plan.proof.unsettled, (found.objective - coarse.objective) / size)
                self.solution = replace(better, proof=replace(better.proof, unsettled=left))
                return
            self.steps.pop()
            self.measures = measures

    def _move_knots_to_switches(self) -> None:
        """Solve again with knots where bounded rates jump, which a shorter motion repays."""
        assert self.solution is not None
        kept = self.solution
        meshes = tuple(with_knots_at(part.mesh, switches(part.phase, part.trajectory)) for part in kept.phases)
        if meshes != tuple(part.mesh for part in kept.phases):
            self._replace_by(meshes, lambda found: found.objective < kept.objective)

    def _smooth(self) -> None:
        """Solve again with a larger weight of smooth torques where they alternate with the mesh."""
        assert self.solution is not None and self.measures is not None
        kept, rough = self.solution, self.measures.proof.roughness
        if self.measures.proof.is_smooth or not self.settings.smoothing:
            return
        most = kept.objective + self.goals.objective * abs(kept.objective)
        self.settings = replace(self.settings, smoothing=min(1.0, SMOOTHER * self.settings.smoothing))

        def is_better(found: Solution) -> bool:
            return found.objective <= most and largest_roughness(found.phases) < rough

        self._replace_by(tuple(part.mesh for part in kept.phases), is_better)

    def _replace_by(self, meshes: tuple[Mesh, ...], is_better: Callable[[Solution], bool]) -> None:
        """Solve again on meshes; a motion that is not proved or no better is dropped."""
        assert self.solution is not None and self.measures is not None
        kept, measures, self.limits_between = self.solution.objective, self.measures, True
        with suppress(KeyboardInterrupt):
            found = self.solve(meshes, None, first=False)
            if found.success and is_better(found):
                moved = self._with_proof(found, measures.before)
                # What is left to gain is no more than before, apart from what the motion lost.
                known, lost = measures.proof.unsettled, max(0.0, found.objective - kept)
                left = lost / size_for(lost, self.goals.objective, found.phases, kept) + (
                    known if moved.proof is None else min(moved.proof.unsettled, known)
                )
                if moved.proof is not None and moved.proof.motion_holds and left <= max(known, self.goals.objective):
                    self.solution = replace(moved, proof=replace(moved.proof, unsettled=left))
                    return
                self.steps.pop()
        self.measures = measures

    @property
    def _warm_solver(self) -> Solver:
        """The solver of a solve that starts from a solution on another mesh."""
        if self.sticking and self.solution is None:
            # The solution with soft friction is that of another problem.
            return self.solver
        # Limits of rates are active nearly everywhere in least time. Lower and upper ones alternate with the mesh,
        # as the signs of powers do.
        warm = self.solver.from_nearby(altered=self.kinked or any(phase.rows.rates for phase in self.problem.phases))
        if self.has_sticking_powers and isinstance(warm, InteriorPoint):
            return replace(warm, initial_barrier=BARRIER_OF_POWERS)
        return warm

    def _is_settled(self, solution: Solution) -> bool:
        """Whether the mesh of a solution is fine enough for limits to be imposed between its points."""
        measures = self._measures_of(solution, self.measures)
        self._unchecked = solution.phases, measures
        proof = measures.proof
        self.limits_between = proof.error <= self.goals.error and measures.growth <= 1.0 and proof.excess <= BEYOND
        return self.limits_between

    def _with_proof(self, solution: Solution, before: Measured | None) -> Solution:
        """Measure a solution between its points, and compare it with the solutions ``before``."""
        known, self._unchecked = self._unchecked, None
        if known is not None and known[0] is solution.phases and known[1].before is before:
            self.measures = known[1].with_violations(solution)
        else:
            self.measures = self._measures_of(solution, before)
        proof, parts = self.measures.proof, solution.phases
        points, intervals = sum(len(part.points) for part in parts), sum(part.mesh.count for part in parts)
        step = MeshStep(intervals, points, proof.error, solution.objective, solution.iterations, solution.seconds)
        self.steps.append(step)
        return replace(solution, proof=proof)

    def _measures_of(self, solution: Solution, before: Measured | None) -> Measured:
        """Measure a solution; without a coarser mesh, its objective still has to gain what the neighbour's had."""
        expected = np.inf if self.neighbour is None else self.neighbour.unsettled
        return measured(solution, before, self.goals, self.sticking, expected)
