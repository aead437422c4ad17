"""The stated objective is the cost of the planned motion."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.figures import Figures, Tolerances

SCOPE = Scope(
    "objective",
    "Gauss quadrature of the objective's own expressions along the motion",
    "the stated objective is what the motion costs",
    "whether another motion costs less, which is the claim on the optimum",
)


def objective(figures: Figures, tolerances: Tolerances) -> Claim:
    """Return the claim on the value of the objective."""
    found = figures.objective
    if found is None:
        return SCOPE.unknown(LATE)
    bound = tolerances.objective
    if bound is None:
        return SCOPE.unknown("No threshold was given.", found.relative)
    if found.relative <= bound:
        return SCOPE.judged([], found.relative, bound)
    stated = f"The stated objective is {found.stated:.6g}, and the motion costs {found.of_motion:.6g}"
    if figures.proof is None:
        why = f"{stated}: on a mesh of one's own the objective is a sum at its points, whose error is not bounded."
        return SCOPE.unknown(why, found.relative, bound)
    return SCOPE.judged([f"{stated}; a relative difference of {bound:.3g} is allowed."], found.relative, bound)
