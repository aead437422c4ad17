"""A built-in problem with its meshes, guess and options."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from robotraj._util.values import dataclass
from robotraj.applications.many.multistart import multistart
from robotraj.planning.plan import plan
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.solution import Solution
from robotraj.transcription.schemes.mesh import Mesh

if TYPE_CHECKING:
    from robotraj.planning.continuation import ContinuationStep
    from robotraj.transcription.interval_limits.methods import ConstraintGeneration


@dataclass(frozen=True, eq=False)
class Demo:
    """A problem with the meshes and the guess that solve it.

    Attributes
    ----------
    problem : Phase or Problem
    meshes : tuple of Mesh or of lists of Mesh
        Meshes that are solved one after the other, each from the solution before; without any, the default call.
    guess : InitialGuess or None
        Guess of the first mesh; None for the default.
    tolerance : float or None
        Relative error between knots to which the last mesh is refined; None keeps the mesh.
    periods : int
        Number of periods of a gait that the page shows.
    starts : int
        Number of random initial guesses, of which the best solution is kept; 0 for the one guess.
    continuation, interval_limits
        See ``rt.plan``.
    analysis : callable or None
        ``analysis(solution)`` returns text that is printed below the solution.
    """

    problem: Phase | Problem
    meshes: tuple[Mesh | list[Mesh], ...] = ()
    guess: InitialGuess | None = None
    tolerance: float | None = None
    periods: int = 1
    starts: int = 0
    continuation: Sequence[ContinuationStep] = ()
    interval_limits: ConstraintGeneration | None = None
    analysis: Callable[[Solution], object] | None = None

    def plan(self) -> Solution:
        """Plan on one mesh after the other."""
        if self.starts:
            return multistart(self.problem, starts=self.starts, seed=0, mesh=self.meshes[-1]).best
        known: InitialGuess | Solution | None = self.guess
        for mesh in self.meshes or (None,):
            known = solution = plan(
                self.problem,
                mesh,
                known,
                tolerance=self.tolerance,
                continuation=self.continuation,
                interval_limits=self.interval_limits,
            )
        return solution
