"""Solvers that stop nearer to the optimum of a mesh, where what they leave counts beside a tolerance."""

from __future__ import annotations

import numpy as np

from robotraj.solution.solution import Solution
from robotraj.solvers.base import Solver

SHARE = 0.25
"""Of the tolerance, that a solver may leave of the objective before it is made sharper."""
MARGIN = 0.1
"""How much less than that share a sharper solver is asked to leave."""


class Sharpening:
    """The solver of a refinement, made sharper as its solutions ask for it.

    Parameters
    ----------
    solver : Solver
        The user's own.

    Attributes
    ----------
    solver : Solver
        The one to solve with next.
    """

    def __init__(self, solver: Solver) -> None:
        self._own = self.solver = solver
        self._factor = 1.0

    @property
    def sharpened(self) -> bool:
        """Whether the solver is another than the user's own."""
        return self.solver is not self._own

    def give_up(self) -> None:
        """Go back to the user's own solver, for good."""
        self.solver, self._factor = self._own, 0.0

    def is_blunt(self, solution: Solution, allowed: float) -> bool:
        """Whether a solution leaves too much of the objective; then the solver is sharper from now on.

        Parameters
        ----------
        solution : Solution
        allowed : float
            Error of the objective, in its own unit, of which a solver may leave a share.
        """
        own, factor = self._own, self._factor
        # A solver at its sharpest gives itself again.
        if not solution.success or not factor or own.sharper(factor) == own.sharper(MARGIN * factor):
            return False
        blunt = left_open(solution) / (SHARE * allowed)
        if blunt <= 1.0:
            return False
        self._factor *= MARGIN / blunt
        self.solver = own.sharper(self._factor)
        return True


def left_open(solution: Solution) -> float:
    """Give what a solver left of the objective: multipliers times distances of rows and columns from their bounds.

    Of a convex program it is the duality gap, which bounds the distance from the optimum. Source: Nocedal & Wright,
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
