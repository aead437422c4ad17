"""A problem with a trusted optimum, and the result of a plan to a tolerance."""

from __future__ import annotations

import time
from dataclasses import dataclass

import robotraj as rt
from robotraj.problem.initial_guess import InitialGuess
from robotraj.transcription.schemes.collocation import Collocation

TOLERANCE = 1e-6


@dataclass(frozen=True)
class Case:
    """A problem, where to start, and its optimum.

    Attributes
    ----------
    name : str
    problem : Problem or Phase
    guess : InitialGuess
    exact : float
        The optimum of the continuous problem.
    accuracy : float
        Relative accuracy of ``exact`` itself; 0 for closed forms.
    source : str
        Where the optimum comes from.
    """

    name: str
    problem: rt.Problem | rt.Phase
    guess: InitialGuess
    exact: float
    accuracy: float
    source: str


@dataclass(frozen=True)
class Result:
    """One line of the table."""

    case: Case
    solution: rt.Solution
    seconds: float

    @property
    def error(self) -> float:
        """Relative error of the objective."""
        return abs(self.solution.objective - self.case.exact) / abs(self.case.exact)

    @property
    def allowed(self) -> float:
        """The tolerance, or the accuracy of the reference where that is coarser."""
        return max(TOLERANCE, self.case.accuracy)

    @property
    def reached(self) -> bool:
        """Whether the plan holds its tolerance and its objective is the trusted one."""
        return self.solution.success and self.error <= self.allowed

    @property
    def intervals(self) -> int:
        """Intervals of all phases."""
        return sum(part.mesh.count for part in self.solution.phases)

    @property
    def points(self) -> int:
        """Collocation points of all phases."""
        return sum(len(part.points) for part in self.solution.phases)

    @property
    def orders(self) -> tuple[int, int]:
        """Fewest and most collocation points of an interval."""
        counts = [
            len(scheme.nodes)
            for part in self.solution.phases
            for scheme in part.mesh.schemes
            if isinstance(scheme, Collocation)
        ]
        return min(counts), max(counts)

    @property
    def meshes(self) -> int:
        """Meshes that were solved."""
        return len(self.solution.refinement)

    @property
    def iterations(self) -> int:
        """Iterations of the solver on all meshes."""
        return sum(step.iterations for step in self.solution.refinement)


def run(case: Case) -> Result:
    """Plan the case to the tolerance from its guess, without a given mesh."""
    began = time.perf_counter()
    solution = rt.plan(case.problem, guess=case.guess, tolerance=TOLERANCE, check=False, progress=False)
    return Result(case, solution, time.perf_counter() - began)
