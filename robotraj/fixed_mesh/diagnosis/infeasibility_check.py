"""A check during a long solve whether limits exclude every motion.

A callback of the solver looks at its first iteration for conflicts with momentum, gravity and energy. Motions with
contacts take hundreds of iterations, and then as many of another solver, until a failure is certain. Of these it also
looks once for a conflict of limits: after many iterations, or where iterations begin again. It stops the solve where a
conflict excludes every motion, or where two searches agree that no motion is near. The first search of configurations
at the ends starts from the iterate. Where no conflict is found, and a solve goes on for hundreds of iterations, speed
limits are narrowed step by step (``narrowed_speeds``). A motion that is found so stops the solve, which begins again
from it.
"""

from __future__ import annotations

from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.explain import against_balances, conflicts_of
from robotraj.fixed_mesh.diagnosis.relaxation.narrowed_speeds import narrowed_speeds
from robotraj.fixed_mesh.warm_start import NEAR
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict, are_clear
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Iteration, Progress
from robotraj.transcription.extract import extract

ITERATIONS = 100
"""Number of iterations after which conflicts are looked for; half as many where an iterate violates a row by ``NEAR``.

After three times as many speed limits are narrowed. Solves that converge mostly take less, and several solves with
wider limits take longer than a hundred iterations. Of those that converge, the iterates of walks and trots violate rows
by less than 1e-2 after 50.
"""


class Excluded(KeyboardInterrupt):
    """Raised where limits conflict, or where a motion is known. The solver returns its iterate, as after Ctrl-C."""


class InfeasibilityCheck:
    """A progress callback that stops the solve of an infeasible problem.

    Parameters
    ----------
    problem : Problem
    coarse : CoarseSolves
    show : callable or None
        A further callback.

    Attributes
    ----------
    conflicts : tuple of Conflict
        Conflicts that ended the solve; empty until they are found.
    motion : Solution or None
        Motion on a coarse mesh from which the solve should begin again.
    """

    def __init__(self, problem: Problem, coarse: CoarseSolves, show: Progress | None) -> None:
        self._problem, self._coarse, self._show = problem, coarse, show
        self._contacts = any(phase.contacts for phase in problem.phases)
        self._last, self._count, self._searched = -1, 0, False
        self.conflicts: tuple[Conflict, ...] = ()
        self.motion: Solution | None = None

    def __call__(self, iteration: Iteration) -> None:
        """Show an iteration, and look for conflicts of balances at first and for one of limits once.

        Raises
        ------
        Excluded
            Limits conflict, or a motion is known.
        """
        if self._show is not None:
            self._show(iteration)
        if self._last < 0:
            self._exclude(against_balances(self._problem))
        self._count += 1
        again = iteration.number < self._last
        self._last = iteration.number
        if not self._contacts:
            return
        longest = ITERATIONS // 2 if iteration.infeasibility > NEAR else ITERATIONS
        if not self._searched and (again or iteration.number >= longest):
            self._searched = True
            origin = None if iteration.read is None else iteration.read()
            near = () if origin is None else extract(origin.nlp, origin.w)
            self._exclude(conflicts_of(self._problem, self._coarse, near))
        if self._count == 3 * ITERATIONS:
            self._narrow()

    def _narrow(self) -> None:
        if not self._problem.has_footholds:
            # The solver finds the contacts. Wider limits lead to others.
            return
        conflicts, self.motion = narrowed_speeds(self._problem, self._coarse)
        self._exclude(conflicts)
        if self.motion is not None:
            raise Excluded("A motion is known.")

    def _exclude(self, found: tuple[Conflict, ...]) -> None:
        if are_clear(found):
            self.conflicts = found
            raise Excluded("Limits conflict.")
