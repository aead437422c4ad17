"""What a plan to a tolerance knows and solves next, and the errors that a solve has left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robotraj._util.values import dataclass
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.records import Lack, MeshStep
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Solver
from robotraj.transcription.refinement.base import Assessment
from robotraj.transcription.schemes.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of a solution between its knots, and of its objective.

    Attributes
    ----------
    assessments : tuple of Assessment
        One for each phase.
    tolerance : float
        Allowed error of an interval.
    left, allowed : float
        Estimated error of the objective, and the allowed one, in its unit.
    """

    assessments: tuple[Assessment, ...]
    tolerance: float
    left: float
    allowed: float

    @property
    def worst(self) -> float:
        """Largest error of an interval."""
        return max(float(each.errors.max()) for each in self.assessments)

    @property
    def excess(self) -> float:
        """Largest relative violation of a path row between the points."""
        return max(float(each.broken.max()) for each in self.assessments)

    @property
    def lacks(self) -> tuple[Lack, ...]:
        """The errors beyond what is allowed."""
        both = (
            Lack("error between knots", self.worst, self.tolerance),
            Lack("change of the objective", self.left, self.allowed),
        )
        return tuple(each for each in both if each.amount > each.allowed)


@dataclass(frozen=True, eq=False)
class ToleranceState:
    """What a plan to a tolerance knows, and what it solves next.

    Attributes
    ----------
    problem, settings
        The problem, and settings with a tolerance and a refinement.
    guess : InitialGuess, Solution or None
        Guess of the plan, until there is a solution.
    meshes : tuple of Mesh
        Meshes of the next solve.
    best, failed : Solution or None
        The last solution, and the last solve that failed.
    steps : tuple of MeshStep
    first : int
        Number of the mesh with which later ones are compared: the first one, or the first with lines.
    limited : bool
        Whether limits are imposed between the points. Rows added on a coarse mesh would have to be found again on the
        next one, so a mesh has them once it meets the tolerance without, or is no better than an earlier one.
    excess : float
        Largest violation of a path row on the last mesh that met the tolerance.
    gap : float
        Factor on the duality gap of the solver; 0 where a solve with a smaller gap failed.
    is_last : bool
        Whether the tolerance is not reached, and the next solve only imposes limits between the points.
    why : str
        The response that led to this state.
    """

    problem: Problem
    settings: Settings
    guess: InitialGuess | Solution | None
    meshes: tuple[Mesh, ...]
    best: Solution | None = None
    failed: Solution | None = None
    steps: tuple[MeshStep, ...] = ()
    first: int = 0
    limited: bool = False
    excess: float = np.inf
    gap: float = 1.0
    is_last: bool = False
    why: str = ""

    @property
    def tolerance(self) -> float:
        """Allowed relative error."""
        assert self.settings.tolerance is not None
        return self.settings.tolerance

    @property
    def compared(self) -> tuple[MeshStep, ...]:
        """The meshes whose errors and objectives are compared."""
        return self.steps[self.first :]

    @property
    def has_smaller_gap(self) -> bool:
        """Whether the solver has a smaller gap than that of the settings."""
        return 0.0 < self.gap < 1.0

    @property
    def solver(self) -> Solver:
        """Solver of the next solve."""
        own = self.settings.solver
        own = own.with_smaller_gap(self.gap) if self.has_smaller_gap else own
        return own if self.best is None else own.from_nearby()

    @property
    def kept(self) -> Solution:
        """The last solution, or else the last solve."""
        known = self.best or self.failed
        assert known is not None
        return replace(known, refinement=self.steps)
