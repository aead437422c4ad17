"""Refinement to a tolerance: solve, estimate the error between the knots, refine the mesh, solve again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robotraj.fixed_mesh.between.limits_between import limited_between
from robotraj.fixed_mesh.solve import solved_at_points
from robotraj.planning.refining.duality_gap import SolverAccuracy
from robotraj.planning.refining.finer_meshes import finer_meshes, split_where_broken
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.claims.objective_size import objective_size
from robotraj.solution.records import Lack, MeshStep, Round, added_times, answered
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.assess import assess
from robotraj.transcription.refinement.base import Assessment
from robotraj.transcription.refinement.equidistribution import LEAST_GROWTH, SAFETY, Equidistribute
from robotraj.transcription.refinement.linear_controls import HARDLY, on_lines
from robotraj.transcription.refinement.objective_quadrature import quadrature_errors
from robotraj.transcription.refinement.split_and_merge import SplitAndMerge
from robotraj.transcription.schemes.mesh import Mesh

MOST_MESHES = 25
"""Largest number of meshes."""
MOST_INTERVALS = 10_000
"""Largest number of intervals of all phases; errors of more are round-off or need a higher order."""
PATIENCE = 4
"""Number of successive meshes without a smaller error after which refinement stops."""
LESS = 0.8
"""Share of the least error so far below which an error counts as smaller."""
ALIKE = 2.0
"""Largest ratio of the errors of successive meshes that count as alike."""
FAR_MORE = Equidistribute.second
"""Ratio of the points of successive meshes whose errors show whether the error follows the mesh."""
CALM = Equidistribute(finest=MOST_INTERVALS)
"""Refinement of meshes whose controls are lines; it keeps their scheme."""
ENDING = (Status.INTERRUPTED, Status.TIME_LIMIT, Status.MEMORY_LIMIT)
"""Statuses after which nothing else is tried."""


def adapt(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
) -> Solution:
    """Refine the meshes of all phases until every interval's error is below the tolerance and the objective settled.

    Each mesh starts from the solution on the one before, with a smaller barrier. An objective has settled when it
    hardly changes on a finer mesh, and changed little on the mesh before (``SAFETY``). Controls of systems become lines
    where a mesh fails, or where its error hardly falls. Last, intervals are split on which path rows on controls
    or accelerations, or limits of torques, are violated, while that excess falls.

    Rows are added between the collocation points once a mesh meets the tolerance without them, or is no better than an
    earlier one. Rows added on a coarse mesh would have to be found again on the next one. Where the solver stops too
    far from the optimum of its mesh, its gap is reduced (``Solver.with_smaller_gap``). The status of a solution that
    misses the tolerance is ``Status.TOLERANCE_NOT_REACHED``.
    """
    return _Adaptation(problem, settings, progress).plan(guess)


class _Adaptation:
    """A plan on one mesh after the other."""

    def __init__(self, problem: Problem, settings: Settings, progress: Progress | None) -> None:
        assert settings.tolerance is not None and settings.refinement is not None
        self.problem, self.progress = problem, progress
        self.tolerance, self.refinement = settings.tolerance, settings.refinement
        # Violations below 1e-7 are round-off of the solver.
        least = min(settings.interval_limits.tolerance, max(1e-7, 0.1 * self.tolerance))
        self.settings = replace(settings, interval_limits=replace(settings.interval_limits, tolerance=least))
        mesh = settings.mesh
        self.meshes = [mesh] * len(problem.phases) if isinstance(mesh, Mesh) else list(mesh)
        self.accuracy = SolverAccuracy(settings.solver)
        self.steps: list[MeshStep] = []
        self.compared_from = 0
        """Index of the first mesh whose error and objective are compared with those of later ones."""
        self.adding_rows = False
        """Whether rows are added between the collocation points."""
        self.times: dict[str, float] = {}
        self.iterations = 0
        self.rounds: tuple[Round, ...] = ()

    def plan(self, guess: InitialGuess | Solution | None) -> Solution:
        """Solve on one mesh after the other."""
        start, excess, kept = guess, np.inf, None
        try:
            while True:
                solution = self._solved(start)
                if not solution.success and self.accuracy.tightened and solution.status is not Status.INTERRUPTED:
                    self.accuracy.revert()
                    solution = self._solved(start)
                kept = self._recorded(solution)
                assessments, worst, settled = self._assessed(solution)
                self._record(solution, worst)
                lacks = [] if worst <= self.tolerance else [str(Lack("error between knots", worst, self.tolerance))]
                self.rounds = answered(self.rounds, ", ".join([*lacks, *([] if settled else ["objective"])]), "")
                kept = solution = self._recorded(solution)
                accurate = worst <= self.tolerance and settled
                before = excess
                if accurate:
                    excess = max(float(each.broken.max()) for each in assessments)
                # An excess of a smooth control falls so far at least; one where a control switches stays.
                splitting = accurate and SplitAndMerge.path < excess < SAFETY * before
                reached = self.adding_rows and accurate and not splitting
                tighter = self.accuracy.tighten_if_needed(solution, self._allowed(solution))
                if self._onto_lines(solution, start, worst):
                    start = solution if solution.success else start
                    continue
                if not solution.success or (reached and not tighter):
                    return solution
                if reached:
                    start = solution
                    continue
                if splitting:
                    finer = split_where_broken(solution, assessments, self.refinement, self.tolerance)
                else:
                    grown = self._compared[-3:]
                    barely = len(grown) == 3 and grown[2].points < LEAST_GROWTH * grown[0].points
                    finer = finer_meshes(solution, assessments, self.refinement, self.tolerance, settled, barely)
                if self._ends_before(finer, worst):
                    return solution if accurate and self.adding_rows else self._not_reached(solution)
                self.meshes, start = finer, solution
        except KeyboardInterrupt:
            # Ctrl-C between two solves: the solution on the last mesh is kept.
            if kept is None:
                raise
            return replace(kept, status=Status.INTERRUPTED)

    @property
    def _compared(self) -> list[MeshStep]:
        return self.steps[self.compared_from :]

    def _allowed(self, solution: Solution) -> float:
        """Return the allowed error of the objective, in its unit."""
        return self.tolerance * objective_size(solution.phases, solution.objective)

    def _assessed(self, solution: Solution) -> tuple[list[Assessment], float, bool]:
        """Return the assessments of all phases, the largest error, and whether the objective has settled."""
        allowed = self._allowed(solution)
        changes = np.abs(np.diff([*(step.objective for step in self._compared), solution.objective]))
        # If each mesh halves the distance to the optimum, the remaining distance equals the last change. That change is
        # no measure of the distance if refinement left out the intervals that matter, so the one before counts too.
        settled = len(changes) > 0 and changes[-1] <= 0.5 * allowed and bool(np.all(changes[-2:] <= allowed / SAFETY))
        settled = settled and _quadrature_error(solution) <= allowed
        assessments = [assess(part.phase, part.trajectory, part.mesh, settled) for part in solution.phases]
        return assessments, max(float(a.errors.max()) for a in assessments), settled

    def _needs_rows(self, solution: Solution) -> bool:
        if not self.adding_rows and solution.success:
            _, worst, settled = self._assessed(solution)
            earlier = min((step.error for step in self._compared), default=np.inf)
            self.adding_rows = (worst <= self.tolerance and settled) or worst >= earlier
        return self.adding_rows

    def _solved(self, start: InitialGuess | Solution | None, imposed: bool = False) -> Solution:
        """Solve on the meshes, with limits between the points where they are imposed or the solution needs them."""
        solver = (
            self.accuracy.solver.from_nearby() if self.steps and isinstance(start, Solution) else self.accuracy.solver
        )
        own = replace(self.settings, mesh=tuple(self.meshes), solver=solver)
        attempt = solved_at_points(self.problem, start, own, self.progress)
        try:
            found = limited_between(attempt, own, self.progress, imposed or self._needs_rows(attempt.solution))
        except KeyboardInterrupt:
            # Ctrl-C after a solve: its solution is kept.
            found = replace(attempt.solution, status=Status.INTERRUPTED)
        self.times, self.iterations = added_times(self.times, found.times), self.iterations + found.iterations
        self.rounds += found.rounds
        return found

    def _record(self, solution: Solution, error: float) -> None:
        points, intervals = sum(len(part.points) for part in solution.phases), sum(m.count for m in self.meshes)
        step = MeshStep(intervals, points, error, solution.objective, solution.iterations, solution.seconds)
        self.steps.append(step)

    def _recorded(self, solution: Solution) -> Solution:
        """Return a solution with the records of the whole plan."""
        return replace(
            solution,
            refinement=tuple(self.steps),
            times=self.times,
            iterations=self.iterations,
            rounds=self.rounds,
        )

    def _onto_lines(self, solution: Solution, start: InitialGuess | Solution | None, worst: float) -> bool:
        """Make controls of systems lines on the next mesh where this one leads astray; return whether they are."""
        failed = not solution.success and solution.status not in ENDING
        astray = failed or (worst > self.tolerance and _hardly_falls(self.steps))
        first = len(self.steps) == 1
        if not astray or (first and solution.iterations < InteriorPoint.max_iterations) or self.refinement == CALM:
            return False
        # The program of a failed mesh leads astray from the motion on the last one.
        last = start if failed else solution
        meshes = tuple(self.meshes if first or not isinstance(last, Solution) else (part.mesh for part in last.phases))
        calmer = on_lines(self.problem, meshes)
        if calmer == tuple(self.meshes):
            return False
        self.meshes, self.refinement, self.compared_from = list(calmer), CALM, len(self.steps)
        return True

    def _ends_before(self, finer: Sequence[Mesh], worst: float) -> bool:
        """Whether the plan ends without the next meshes."""
        given_up = worst > self.tolerance and _stagnates([step.error for step in self._compared])
        return given_up or len(self.steps) == MOST_MESHES or sum(mesh.count for mesh in finer) > MOST_INTERVALS

    def _not_reached(self, solution: Solution) -> Solution:
        """Return the solution with rows between the points, and the status of a tolerance that was missed."""
        if not self.adding_rows:
            limited = self._solved(solution, True)
            if limited.status is Status.INTERRUPTED:
                return replace(self._recorded(solution), status=Status.INTERRUPTED)
            if limited.success:
                solution = limited
        return replace(self._recorded(solution), status=Status.TOLERANCE_NOT_REACHED)


def _quadrature_error(solution: Solution) -> float:
    """Return the quadrature error of the objective along exact motions, whose states have no error."""
    parts = [part for part in solution.phases if part.exact]
    return abs(
        sum(
            float(quadrature_errors(part.phase, part.trajectory, part.mesh.schemes, part.inputs).sum())
            for part in parts
        )
    )


def _hardly_falls(steps: Sequence[MeshStep]) -> bool:
    """Whether the error hardly fell although the last mesh has far more points, as on singular arcs."""
    if len(steps) < 2:
        return False
    before, last = steps[-2:]
    return last.points > FAR_MORE * before.points and last.error > HARDLY * before.error


def _stagnates(errors: list[float]) -> bool:
    """Whether the last meshes are no better than an earlier one and their errors are alike, as on singular arcs.

    Errors that vary widely belong to different motions, as without an objective. The next error may be small enough.
    """
    before, last = errors[:-PATIENCE], errors[-PATIENCE:]
    return bool(before) and min(last) > LESS * min(before) and max(last) < ALIKE * min(last)
