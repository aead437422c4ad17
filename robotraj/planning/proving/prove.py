"""Plan until the plan is proved: solve, measure between the points, and go straight to what is missing.

A first, coarse mesh finds the course of the motion, a second one its optimum. The order of the scheme predicts from the
errors of the intervals, and from what the objective changed by, which mesh is needed. Limits of torques that an exact
motion exceeds between the points are lowered there by the excess, on the same mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from robotraj.guess.base import InitialGuess
from robotraj.planning.diagnosis.explain import are_sure
from robotraj.planning.progress import PlanLimits
from robotraj.planning.proving.measures import Measured, measured
from robotraj.planning.proving.soft_friction import SPEEDS, needs_softening, softened
from robotraj.planning.restarts import WHENCE
from robotraj.planning.solve import solve
from robotraj.problem.problem import Problem
from robotraj.solution.records import MeshStep, added_times
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress, Solver
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.equidistribution import Equidistribute, evenly_finer
from robotraj.transcription.schemes.mesh import Mesh

MOST_MESHES = 8
"""Meshes tried before a plan is given back as it is."""
ENOUGH = 4
"""The same for a motion that is proved, whose objective has not settled; joints that stick and slide go on."""
PATIENCE, PATIENCE_STICKING = 150, 300
"""Iterations of a solve that may improve an objective, or the start of another solve, and nothing else."""
SOFTER = 1.25
"""Least growth from the mesh of one friction to that of the next, less soft one."""
LIMITS_OF_THE_USER = (Status.ITERATION_LIMIT, Status.TIME_LIMIT, Status.MEMORY_LIMIT)
"""Ends of a solve after which no other mesh is tried."""
SECOND = 1.5
"""Growth from a first mesh that could not be solved to the second one."""
STUCK = 0.7
"""Share of the error of one mesh that is left on the next, beyond which the one after has ``DOUBLED`` intervals.

Where that leaves as much, the plan is given back as it is.
"""
DOUBLED = 2.0


def prove(
    problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None = None
) -> Solution:
    """Plan on finer and finer meshes until ``settings.goals`` hold.

    Returns
    -------
    Solution
        With ``proof``; its status is ``Status.NOT_PROVED`` where it is no motion within its limits. A finer mesh that
        cannot be solved does not take away what a coarser one found.
    """
    return _Refining(problem, settings, progress).plan(guess)


class _Refining:
    """The solves of one plan: what they found, and what they took."""

    def __init__(self, problem: Problem, settings: Settings, progress: Progress | None) -> None:
        assert settings.goals is not None
        self.problem, self.settings, self.progress, self.goals = problem, settings, progress, settings.goals
        self.best: Solution | None = None
        self.steps: list[MeshStep] = []
        self.times: dict[str, float] = {}
        self.iterations = 0
        self.whence = ""
        """The beginning that led to a solution, where the guess did not."""
        self.sticking = needs_softening(problem)
        """Whether joints stick and slide to save effort."""
        self.measures: Measured | None = None
        """Of the best solution so far."""
        self.seen: tuple[object, Measured] | None = None
        """Phases of the last solution that was measured before its motion was held, and these measures."""
        self.held = False
        """Whether the motion on the present mesh is held between its points."""

    def plan(self, guess: InitialGuess | Solution | None) -> Solution:
        """Solve on one mesh after the other."""
        mesh = self.settings.mesh
        meshes = (mesh,) * len(self.problem.phases) if isinstance(mesh, Mesh) else tuple(mesh)
        soft = self._with_soft_friction(guess, meshes)
        if soft is not None:
            guess, meshes = soft, self._bent(soft)
        last: Solution | None = None
        best_held, stuck = False, 0
        for number in range(MOST_MESHES):
            first = number == 0
            try:
                self.held = number == MOST_MESHES - 1 or (number >= ENOUGH - 1 and not self.sticking)
                last = self._on(meshes, self.best or guess, first, nearby=soft is not None or not first)
            except KeyboardInterrupt:
                if last is None:
                    raise
                return self._concluded(replace(self.best or last, status=Status.INTERRUPTED))
            if last.status is Status.INTERRUPTED:
                return self._concluded(replace(self.best or last, status=Status.INTERRUPTED))
            if last.success:
                self.best = last = self._measured(last, self.measures)
                best_held = self.held
            elif not first or last.status in LIMITS_OF_THE_USER or are_sure(last.conflicts):
                break
            if not first and last.proof is not None and last.proof.holds:
                break
            if number >= ENOUGH - 1 and not self.sticking and self.best is not None and _is_motion(self.best):
                break
            stuck = stuck + 1 if self._stuck() else 0
            if stuck > 1:
                break
            least = DOUBLED if stuck else 1.0 if not first else self._second if soft is None else SECOND
            finer = self._finer(meshes, least)
            if finer == meshes:
                break
            meshes = finer
        assert last is not None
        if self.best is not None and not best_held and not _is_motion(self.best):
            self._hold_best()
        return self._concluded(self.best or last)

    def _hold_best(self) -> None:
        """Hold the best motion between its points, where its mesh was to be followed by one that was not solved."""
        assert self.best is not None and self.measures is not None
        before, self.held = self.measures.before, True
        try:
            found = self._on(tuple(part.mesh for part in self.best.phases), self.best, first=False, nearby=True)
        except KeyboardInterrupt:
            return
        if found.success:
            self.steps.pop()
            self.best = self._measured(found, before)

    def _is_settled(self, solution: Solution) -> bool:
        """Whether the mesh of a solution is fine enough, so that its motion is worth holding between its points."""
        self.seen = solution.phases, measured(solution, self.measures, self.goals, bending=self.sticking)
        seen = self.seen[1]
        self.held = seen.proof.error <= self.goals.error and seen.growth <= 1.0
        return self.held

    def _stuck(self) -> bool:
        """Whether the error exceeds its goal and hardly fell on the last mesh, so that the next would not do."""
        errors = [step.error for step in self.steps[-2:]]
        return len(errors) == 2 and errors[1] > self.goals.error and errors[1] > STUCK * errors[0]

    @property
    def _second(self) -> float:
        """Growth from the first mesh to the second."""
        refinement = self.settings.refinement
        return refinement.second if isinstance(refinement, Equidistribute) else SECOND

    def _finer(self, meshes: tuple[Mesh, ...], least: float) -> tuple[Mesh, ...]:
        """Return the next meshes: of the same knots, more closely, where there is nothing to measure."""
        refinement = self.settings.refinement
        assert refinement is not None
        if self.best is None or self.measures is None:
            return tuple(evenly_finer(mesh, max(least, SECOND)) for mesh in meshes)
        return self.measures.next_meshes(self.best.phases, refinement, max(least, self.measures.growth))

    def _with_soft_friction(self, guess: InitialGuess | Solution | None, meshes: tuple[Mesh, ...]) -> Solution | None:
        """Solve with dry friction that saturates at larger speeds; None without friction, or where all that failed."""
        if not self.sticking or isinstance(guess, Solution):
            return None
        limits = replace(self.settings.interval_limits, rounds=0)
        settings = replace(self.settings, restarts=Restarts(0), interval_limits=limits)
        found: Solution | None = None
        for factor in SPEEDS:
            own = replace(settings, mesh=meshes, solver=settings.solver.at_most(PATIENCE))
            try:
                softer = self._solve(softened(self.problem, factor), found or guess, own)
            except KeyboardInterrupt:
                if not isinstance(self.progress, PlanLimits):
                    raise
                break
            if softer.success:
                found = softer
                meshes = self._bent(found)
        if isinstance(self.progress, PlanLimits):
            self.progress.begin()
        return found

    def _bent(self, soft: Solution) -> tuple[Mesh, ...]:
        """Return meshes that are finer where torques bend: with less soft friction they bend more sharply there."""
        refinement = self.settings.refinement
        assert refinement is not None
        return measured(soft, None, self.goals, bending=True).next_meshes(soft.phases, refinement, SOFTER)

    def _on(
        self, meshes: tuple[Mesh, ...], start: InitialGuess | Solution | None, first: bool, nearby: bool
    ) -> Solution:
        """Solve on meshes; where torques exceed their limits between the points, lower the limits there.

        The first meshes only find a start: a failure there is met on the next, and so is what exceeds limits. Where the
        objective needs a finer mesh, so is that, unless the motion is to be held.
        """
        settings = replace(self.settings, mesh=meshes)
        if nearby:
            settings = replace(settings, solver=self._warm)
        if self.measures is not None and self.measures.before is not None and self.measures.proof.motion_holds:
            # The motion is known by now, and only its objective is left to settle.
            patience = PATIENCE_STICKING if self.sticking else PATIENCE
            settings = replace(settings, solver=settings.solver.at_most(patience), restarts=Restarts(0))
        if first:
            plain = replace(settings.interval_limits, rounds=0)
            return self._solve(self.problem, start, replace(settings, interval_limits=plain))
        if self.best is None:
            # Other guesses were tried on the first mesh.
            settings = replace(settings, restarts=Restarts(0))
        return self._solve(self.problem, start, settings, lower=True, hold=None if self.held else self._is_settled)

    @property
    def _warm(self) -> Solver:
        """The solver of a solve that starts from a solution on another mesh."""
        solver = self.settings.solver
        if self.sticking:
            # Joints that stick and slide change places from mesh to mesh.
            return solver
        # Limits of rates are active nearly everywhere in least time, and change sides from mesh to mesh.
        return solver.from_nearby(altered=any(phase.rows.rates for phase in self.problem.phases))

    def _solve(
        self,
        problem: Problem,
        start: InitialGuess | Solution | None,
        settings: Settings,
        lower: bool = False,
        hold: Callable[[Solution], bool] | None = None,
    ) -> Solution:
        found = solve(problem, start, settings, self.progress, hold, lower)
        self.times = added_times(self.times, found.times)
        self.iterations += found.iterations
        _, _, whence = found.message.partition(WHENCE)
        self.whence = whence or self.whence
        return found

    def _measured(self, solution: Solution, before: Measured | None) -> Solution:
        """Measure between the points, and what a finer mesh than those ``before`` may gain."""
        if self.seen is not None and self.seen[0] is solution.phases and self.seen[1].before is before:
            self.measures = self.seen[1].with_violations(solution)
        else:
            self.measures = measured(solution, before, self.goals, bending=self.sticking)
        self.seen = None
        proof, parts = self.measures.proof, solution.phases
        points = sum(len(part.points) for part in parts)
        intervals = sum(part.mesh.count for part in parts)
        step = MeshStep(intervals, points, proof.error, solution.objective, solution.iterations, solution.seconds)
        self.steps.append(step)
        return replace(solution, proof=proof)

    def _concluded(self, solution: Solution) -> Solution:
        """Say how the whole plan ended: a motion beyond its limits is no success, an early optimum is one."""
        status = solution.status
        if status is Status.SOLVED and not _is_motion(solution):
            status = Status.NOT_PROVED
        message = solution.message
        if self.whence and WHENCE not in message:
            message += WHENCE + self.whence
        return replace(
            solution,
            status=status,
            message=message,
            refinement=tuple(self.steps),
            times=self.times,
            iterations=self.iterations,
        )


def _is_motion(solution: Solution) -> bool:
    """Whether a solution is a motion within its limits."""
    return solution.proof is not None and solution.proof.motion_holds
