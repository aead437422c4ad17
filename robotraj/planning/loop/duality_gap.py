"""The duality gap that a solver has left, which bounds how far an objective is from the optimum of its mesh."""

from __future__ import annotations

import numpy as np

from robotraj.solution.solution import Solution


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
