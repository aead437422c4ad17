"""Plan until the plan is proved: solve, measure between the points, and go straight to what is missing.

A first, coarse mesh finds the course of the motion, a second one its optimum. What the second gained tells by the
order of the scheme what a third would. Limits of torques that the motion exceeds between the points are lowered there
by the excess, on the same mesh.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robotraj.guess.base import InitialGuess
from robotraj.planning.proving.first_mesh import FINE, graded
from robotraj.planning.solve import solve
from robotraj.problem.problem import Problem
from robotraj.solution.proof import Proof
from robotraj.solution.records import MeshStep, added_times
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status
from robotraj.transcription.interval_limits.interval_violations import variable_violations
from robotraj.transcription.interval_limits.margins import LimitedInterval, Margins
from robotraj.transcription.refinement.assess import broken_rows, errors_of
from robotraj.transcription.refinement.objective_quadrature import quadrature_errors
from robotraj.transcription.schemes.mesh import Mesh

MOST_MESHES = 4
"""Meshes tried before a plan is given back as it is."""
PATIENCE = 200
"""Iterations of a solve that may improve an objective and nothing else."""
MOST_MARGINS = 4
"""Times that limits are lowered on one mesh."""
FINEST = 160
"""Intervals of a phase beyond which a mesh is not refined."""
LEAST_GROWTH, MOST_GROWTH = 1.5, 4.0
"""How many times as many intervals the next mesh has."""
ORDER = 2.0
"""Power of the number of intervals by which the objective nears its optimum where limits are active."""
MORE = 1.1
"""Margins are this many times the excess: what they change moves the motion, and its excess with it."""
SMALL = 1e-2
"""Objectives below this settle to the goal times this, not to the goal times themselves."""


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
        self.known: tuple[int, float] | None = None
        """Intervals and true objective of the mesh before."""

    def plan(self, guess: InitialGuess | Solution | None) -> Solution:
        """Solve on one mesh after the other."""
        mesh = self.settings.mesh
        meshes = (mesh,) * len(self.problem.phases) if isinstance(mesh, Mesh) else tuple(mesh)
        for number in range(MOST_MESHES):
            first = number == 0
            try:
                last = self._on(meshes, self.best or guess, first)
            except KeyboardInterrupt:
                if self.best is None:
                    raise
                return self._concluded(replace(self.best, status=Status.INTERRUPTED))
            if last.status is Status.INTERRUPTED:
                return self._concluded(replace(self.best or last, status=Status.INTERRUPTED))
            if last.success:
                self.best = last = self._measured(last)
            elif not first:
                break
            count = max(mesh.count for mesh in meshes)
            if count >= FINEST or (not first and last.proof is not None and last.proof.holds):
                break
            meshes = (graded(max(FINE, count) if first else self._next(count)),) * len(meshes)
        return self._concluded(self.best or last)

    def _on(self, meshes: tuple[Mesh, ...], start: InitialGuess | Solution | None, first: bool) -> Solution:
        """Solve on meshes; where torques exceed their limits between the points, lower the limits there.

        The first meshes only find a start: a failure there is met on the next, and so is what exceeds limits.
        """
        settings = replace(self.settings, mesh=meshes)
        if self.best is not None:
            settings = replace(settings, solver=settings.solver.from_nearby())
        if len(self.steps) > 1:
            # The motion is known by now, and only its objective is left to settle.
            settings = replace(settings, solver=settings.solver.at_most(PATIENCE), restarts=Restarts(0))
        if first:
            return self._solve(start, replace(settings, restarts=Restarts(0)), {})
        found = self._solve(start, settings, {})
        nearby = replace(settings, solver=settings.solver.from_nearby(), restarts=Restarts(0))
        margins: dict[LimitedInterval, float] = {}
        for _ in range(MOST_MARGINS):
            if not found.success or not found.control_interval_violations:
                break
            for i, part in enumerate(found.phases):
                for violation in variable_violations(part.phase, i, part.trajectory, part.torques):
                    place = LimitedInterval(i, violation.interval, violation.row.number)
                    margins[place] = margins.get(place, 0.0) + MORE * violation.amount
            again = self._solve(found, nearby, margins)
            if not again.success:
                break
            found = again
        return found

    def _solve(self, start: InitialGuess | Solution | None, settings: Settings, margins: Margins) -> Solution:
        found = solve(self.problem, start, settings, self.progress, margins=margins)
        self.times = added_times(self.times, found.times)
        self.iterations += found.iterations
        return found

    def _measured(self, solution: Solution) -> Solution:
        """Measure between the points, and what a finer mesh may gain."""
        parts = solution.phases
        count = max(part.mesh.count for part in parts)
        left = [quadrature_errors(p.phase, p.trajectory, p.mesh.schemes, p.torques) for p in parts]
        true = solution.objective - float(sum(errors.sum() for errors in left))
        size = max(abs(true), SMALL)
        unsettled = np.inf
        if self.known is not None:
            before, objective = self.known
            unsettled = abs(objective - true) / size / ((count / before) ** ORDER - 1.0)
        self.known = count, true
        broken = [v.relative for v in (*solution.interval_violations, *solution.control_interval_violations)]
        broken += [float(broken_rows(p.phase, p.trajectory, p.torques).max()) for p in parts]
        proof = Proof(
            max(float(errors_of(p.phase, p.trajectory, p.mesh).max()) for p in parts),
            max(0.0, *broken),
            abs(solution.objective - true) / size,
            unsettled,
            self.goals,
        )
        points = sum(len(part.points) for part in parts)
        intervals = sum(part.mesh.count for part in parts)
        step = MeshStep(intervals, points, proof.error, solution.objective, solution.iterations, solution.seconds)
        self.steps.append(step)
        return replace(solution, proof=proof)

    def _next(self, count: int) -> int:
        """Intervals with which the objective should be settled."""
        proof = self.best.proof if self.best is not None else None
        left = np.inf if proof is None else max(proof.quadrature, proof.unsettled) / self.goals.objective
        growth = np.clip(MORE * left ** (1.0 / ORDER), LEAST_GROWTH, MOST_GROWTH) if np.isfinite(left) else LEAST_GROWTH
        return min(FINEST, int(np.ceil(growth * count)))

    def _concluded(self, solution: Solution) -> Solution:
        """Say how the whole plan ended: a motion beyond its limits is no success, an early optimum is one."""
        status = solution.status
        if status is Status.SOLVED and (solution.proof is None or not solution.proof.motion_holds):
            status = Status.NOT_PROVED
        history = tuple(self.steps)
        return replace(solution, status=status, refinement=history, times=self.times, iterations=self.iterations)
