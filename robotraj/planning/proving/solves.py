"""The solves of one plan, with their times and iterations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from robotraj.planning.proving.measures import is_motion
from robotraj.planning.solve import solve
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.records import MeshStep, added_times
from robotraj.solution.settings import RESTARTED_FROM, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Outcome, Progress
from robotraj.solvers.status import Status


class Solves:
    """Solves problems and adds up what that takes.

    Attributes
    ----------
    times : dict of str to float
        Seconds of all solves together, by part.
    iterations : int
        Iterations of all solves together.
    restart : str
        Description of the restart that led to a solution; empty where the guess did.
    """

    def __init__(self, progress: Progress | None) -> None:
        self.progress = progress
        self.times: dict[str, float] = {}
        self.iterations = 0
        self.restart = ""

    def solve(
        self,
        problem: Problem,
        start: InitialGuess | Solution | None,
        settings: Settings,
        lower: bool = False,
        hold: Callable[[Solution], bool] | None = None,
    ) -> Solution:
        """Solve a problem on one mesh; see ``planning.solve``."""
        found = solve(problem, start, settings, self.progress, hold, lower)
        self.add(found)
        _, _, restart = found.message.partition(RESTARTED_FROM)
        self.restart = restart or self.restart
        return found

    def add(self, found: Solution | Outcome) -> None:
        """Add the times and iterations of a solve."""
        self.times = added_times(self.times, found.times)
        self.iterations += found.iterations

    def concluded(self, solution: Solution, steps: Sequence[MeshStep]) -> Solution:
        """Return the solution with the status and records of the whole plan.

        A motion beyond its limits has ``Status.NOT_PROVED``. A motion whose objective has not settled counts as solved.
        """
        status = solution.status
        if status is Status.SOLVED and not is_motion(solution):
            status = Status.NOT_PROVED
        message = solution.message
        if self.restart and RESTARTED_FROM not in message:
            message += RESTARTED_FROM + self.restart
        return replace(
            solution,
            status=status,
            message=message,
            refinement=tuple(steps),
            times=self.times,
            iterations=self.iterations,
        )
