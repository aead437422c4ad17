"""Tighter tolerances of solvers that stop too far from the optimum of a mesh."""

from __future__ import annotations

import numpy as np

from robotraj.solution.solution import Solution
from robotraj.solvers.base import Solver
from robotraj.transcription.refinement.equidistribution import SAFETY

MARGIN = 0.1
"""Ratio of the duality gap of the next solver to that limit."""


class SolverAccuracy:
    """The solver of a refinement, with a smaller duality gap where its solutions need it.

    Parameters
    ----------
    solver : Solver
        Solver of the settings.

    Attributes
    ----------
    solver : Solver
        Solver of the next solve.
    """

    def __init__(self, solver: Solver) -> None:
        self._own = self.solver = solver
        self._factor = 1.0

    @property
    def tightened(self) -> bool:
        """Whether the solver has a smaller gap than that of the settings."""
        return self.solver is not self._own

    def revert(self) -> None:
        """Return to the solver of the settings, and tighten it no more."""
        self.solver, self._factor = self._own, 0.0

    def tighten_if_needed(self, solution: Solution, allowed: float) -> bool:
        """Reduce the gap of the solver if that of a solution is too large; return whether it was.

        Parameters
        ----------
        solution : Solution
        allowed : float
            Allowed error of the objective, in its unit. The gap may be ``SAFETY`` of it.
        """
        own, factor = self._own, self._factor
        # A solver at its smallest gap returns itself.
        if not solution.success or not factor or own.with_smaller_gap(factor) == own.with_smaller_gap(MARGIN * factor):
            return False
        ratio = duality_gap(solution) / (SAFETY * allowed)
        if ratio <= 1.0:
            return False
        self._factor *= MARGIN / ratio
        self.solver = own.with_smaller_gap(self._factor)
        return True


def duality_gap(solution: Solution) -> float:
    """Return the duality gap: multipliers times the distances of rows and variables from their bounds.

    For a convex program it bounds the distance of the objective from the optimum. Source: Nocedal & Wright,
    Numerical Optimization (2006), section 14.1.
    """
    multipliers = solution.multipliers
    if multipliers is None or multipliers.origin is None:
        return 0.0
    nlp, w = multipliers.origin.nlp, multipliers.origin.w
    gap = 0.0
    for own, scalars, values in (
        (multipliers.rows, nlp.rows, nlp.values(w)),
        (multipliers.bounds, nlp.variables, w),
    ):
        distance = np.where(own > 0, scalars.upper - values, values - scalars.lower)
        gap += float(np.abs(own) @ np.where(np.isfinite(distance), np.maximum(distance, 0.0), 0.0))
    return gap
