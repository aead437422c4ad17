"""One solve from one guess: a solution at the collocation points, without limits between the points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotraj._util.system.interrupts import stop_if_noted
from robotraj._util.time_left import used_time
from robotraj.fixed_mesh.checked_solution import checked_solution
from robotraj.fixed_mesh.plan_limits import PlanLimits
from robotraj.fixed_mesh.posed import Posed, posed_problem
from robotraj.fixed_mesh.solve_nlp import guess_of, solve_nlp
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.records import with_effort_of
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status
from robotraj.transcription.clearance.surface_rows import NearSurfaces


class AtPoints(NamedTuple):
    """A solution at the collocation points, and what is needed to impose limits between them.

    Attributes
    ----------
    posed : Posed
    solution : Solution
        Checked outside the solver.
    w : ndarray (n,)
        Its decision vector.
    """

    posed: Posed
    solution: Solution
    w: NDArray[np.float64]

    @property
    def is_over(self) -> bool:
        """Whether nothing else is tried: it is solved or was interrupted."""
        return self.solution.success or self.solution.status is Status.INTERRUPTED

    def after(self, spent: Solution) -> AtPoints:
        """Return the same with the effort of an earlier solve, too."""
        return self._replace(solution=with_effort_of(spent, self.solution))

    def changed(self, **changes: object) -> AtPoints:
        """Return the same with changes of its solution."""
        return self._replace(solution=replace(self.solution, **changes))  # type: ignore[arg-type]


def solved_once(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
    surfaces: Sequence[NearSurfaces | None] = (),
    watch: Progress | None = None,
) -> AtPoints:
    """Transcribe a problem, solve it from one guess, and evaluate every row again.

    Parameters
    ----------
    problem : Problem
    guess : InitialGuess, Solution or None
    settings : Settings
    progress : callable, optional
        Called once an iteration; a ``PlanLimits`` also before the solve.
    surfaces : sequence of NearSurfaces or None
        For each phase, links of the robot that rows keep apart.
    watch : callable, optional
        Called in place of ``progress`` at every iteration.
    """
    stop_if_noted()
    if isinstance(progress, PlanLimits):
        progress.before_solve(problem, settings.mesh)
    began = used_time()
    posed, multipliers = posed_problem(problem, guess, settings, surfaces)
    solution, w = solve_nlp(posed.nlp, guess, multipliers, settings.solver, watch or progress, began)
    return AtPoints(posed, solution, w)


def excluded_guess(problem: Problem, guess: InitialGuess | Solution | None, settings: Settings) -> Solution:
    """Return the guess of a problem that is known to have no solution, with its rows evaluated; nothing is solved."""
    began = used_time()
    nlp = posed_problem(problem, guess, settings, ())[0].nlp
    outcome = guess_of(nlp, Status.INFEASIBLE, "not begun, since no motion exists")
    return checked_solution(nlp, outcome, {"build": used_time() - began - nlp.compiling, "compile": nlp.compiling})
