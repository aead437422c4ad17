"""The solves of one plan, with their times and iterations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from robotraj.planning.proving.measures import is_motion
from robotraj.planning.solve import solve
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.records import MeshStep, Round, added_times, answered, started_from
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Outcome, Progress
from robotraj.solvers.status import Status

if TYPE_CHECKING:
    from robotraj.transcription.clearance.surface_rows import NearSurfaces


class Solves:
    """Solves problems and adds up what that takes.

    Attributes
    ----------
    times : dict of str to float
        Seconds of all solves together, by part.
    iterations : int
        Iterations of all solves together.
    rounds : tuple of Round
        All solves in their order.
    """

    def __init__(self, progress: Progress | None, surfaces: Sequence[NearSurfaces | None] = ()) -> None:
        self.progress, self.surfaces = progress, surfaces
        self.times: dict[str, float] = {}
        self.iterations = 0
        self.rounds: tuple[Round, ...] = ()

    def solve(
        self,
        problem: Problem,
        start: InitialGuess | Solution | None,
        settings: Settings,
        lower: bool = False,
        hold: Callable[[Solution], bool] | None = None,
        name: str = "",
    ) -> Solution:
        """Solve a problem on one mesh; see ``planning.solve``. ``name`` is that of the start in the history."""
        found = solve(problem, start, settings, self.progress, hold, lower, self.surfaces)
        self.add(found, started_from(found.rounds, name))
        return found

    def add(self, found: Solution | Outcome, rounds: Sequence[Round]) -> None:
        """Add the times, iterations and rounds of a solve."""
        self.rounds += tuple(rounds)
        self.times = added_times(self.times, found.times)
        self.iterations += found.iterations

    def answered(self, lacked: str, response: str) -> None:
        """Note what the last solution lacked, and what follows."""
        self.rounds = answered(self.rounds, lacked, response)

    def concluded(self, solution: Solution, steps: Sequence[MeshStep]) -> Solution:
        """Return the solution with the status and records of the whole plan.

        A motion beyond its limits has ``Status.NOT_PROVED``. A motion whose objective has not settled counts as solved.
        """
        status = solution.status
        if status is Status.SOLVED and not is_motion(solution):
            status = Status.NOT_PROVED
        return replace(
            solution,
            status=status,
            rounds=self.rounds,
            refinement=tuple(steps),
            times=self.times,
            iterations=self.iterations,
        )
