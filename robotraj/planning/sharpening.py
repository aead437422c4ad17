"""Tighter tolerances of solvers that stop too far from the optimum of a mesh."""

from __future__ import annotations

import numpy as np

from robotraj.solution.solution import Solution
from robotraj.solvers.base import Solver

SHARE = 0.25
"""Share of the tolerance that the duality gap of a solver may reach before its own tolerance is reduced."""
MARGIN = 0.1
"""Factor below that share at which a tighter solver aims."""


class Sharpening:
    """The solver of a refinement, tightened where its solutions need it.

    Parameters
    ----------
    solver : Solver
        That of the settings.

    Attributes
    ----------
    solver : Solver
        The one for the next solve.
    """

    def __init__(self, solver: Solver) -> None:
        self._own = self.solver = solver
        self._factor = 1.0

    @property
    def sharpened(self) -> bool:
        """Whether the solver is tighter than that of the settings."""
        return self.solver is not self._own

    def give_up(self) -> None:
        """Return to the solver of the settings, for good."""
        self.solver, self._factor = self._own, 0.0

    def is_blunt(self, solution: Solution, allowed: float) -> bool:
        """Whether the duality gap of a solution is too large; then the solver is tighter from now on.

        Parameters
        ----------
        solution : Solution
        allowed : float
            Error of the objective, in its unit; a share of it is left to the solver.
        """
        own, factor = self._own, self._factor
        # A solver at its tightest returns itself.
        if not solution.success or not factor or own.sharper(factor) == own.sharper(MARGIN * factor):
            return False
        blunt = left_open(solution) / (SHARE * allowed)
        if blunt <= 1.0:
            return False
        self._factor *= MARGIN / blunt
        self.solver = own.sharper(self._factor)
        return True


def left_open(solution: Solution) -> float:
    """Return the duality gap: multipliers times the distances of rows and variables from their bounds.

    For a convex program it bounds the distance of the objective from the optimum. Source: Nocedal & Wright,
    Numerical Optimization (2006), section 14.1.
    """
    multipliers = solution.multipliers
    if multipliers is None or multipliers.origin is None:
        return 0.0
    nlp, w = multipliers.origin.nlp, multipliers.origin.w
    left = 0.0
    for own, scalars, values in (
        (multipliers.rows, nlp.rows, nlp.values(w)),
        (multipliers.bounds, nlp.variables, w),
    ):
        away = np.where(own > 0, scalars.upper - values, values - scalars.lower)
        left += float(np.abs(own) @ np.where(np.isfinite(away), np.maximum(away, 0.0), 0.0))
    return left
