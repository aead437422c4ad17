"""A solve that goes on for long is doubted once: limits may exclude every motion.

Motions with contacts take hundreds of iterations, and then as many of another solver, until a failure is certain. A
callback of the solver therefore looks for a conflict of limits when a solve has taken many iterations or begins again,
and stops it where one excludes every motion. Of configurations at the ends, two searches must agree that none exists.
"""

from __future__ import annotations

from collections.abc import Callable

from robotraj.planning.diagnosis.elastic import Solve
from robotraj.planning.diagnosis.explain import are_sure, conflicts_of
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict
from robotraj.solvers.base import Iteration, Progress

MANY = 100
"""Iterations after which a solve is doubted."""


class Excluded(KeyboardInterrupt):
    """Raised where limits exclude every motion. It ends a solve as Ctrl-C does: the iterate is kept."""


class Doubt:
    """A progress callback that stops a solve of a problem without a solution.

    Parameters
    ----------
    problem : Problem
    coarsely : callable
        Solves on a coarse mesh, for the relaxed problem.
    show : callable or None
        A further callback.

    Attributes
    ----------
    conflicts : tuple of Conflict
        Those that exclude every motion; empty until they are found.
    """

    def __init__(self, problem: Problem, coarsely: Solve, show: Progress | None) -> None:
        self._find: Callable[[], tuple[Conflict, ...]] | None = lambda: conflicts_of(problem, coarsely, agreed=True)
        self._show, self._last = show, -1
        self.conflicts: tuple[Conflict, ...] = ()

    def __call__(self, iteration: Iteration) -> None:
        """Show an iteration, and look for a conflict once.

        Raises
        ------
        Excluded
        """
        if self._show is not None:
            self._show(iteration)
        again = iteration.number < self._last
        self._last = iteration.number
        if self._find is None or not (again or iteration.number >= MANY):
            return
        find, self._find = self._find, None
        found = find()
        if are_sure(found):
            self.conflicts = found
            raise Excluded("Limits exclude every motion.")
