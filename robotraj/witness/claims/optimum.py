"""No motion nearby costs less than the plan by more than the goal."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.figures import Figures, Tolerances

SCOPE = Scope(
    "optimum",
    "the planner's own solves on several meshes, and a second solve from the plan on meshes twice as fine",
    "this local optimum has settled: no motion nearby costs less by more than the bound",
    "other local optima, which another guess or rt.multistart may find",
)


def optimum(figures: Figures, tolerances: Tolerances) -> Claim:
    """Return the claim on the optimum."""
    proof, found, allowed = figures.proof, figures.second, tolerances.optimum
    if proof is None:
        return SCOPE.unknown(
            "The plan is that of a given mesh or tolerance, whose objective was compared with no other."
        )
    goal = proof.goals.objective
    if not proof.unsettled <= goal:
        why = f"Finer meshes are expected to gain {proof.unsettled:.1e} of the objective; {goal:.0e} is the goal."
        return SCOPE.unknown(why, proof.unsettled, goal)
    if allowed is None:
        return SCOPE.unknown("No threshold was given.", proof.unsettled, goal)
    if found is None:
        return SCOPE.unknown(LATE)
    if found.reason:
        return SCOPE.unknown(f"Not judged: {found.reason}.")
    bound = max(allowed, goal)
    if found.gain <= bound:
        return SCOPE.judged([], found.gain, bound)
    less = f"A second solve from the plan finds a motion that costs {found.after:.6g} instead of {found.before:.6g}"
    if found.faults:
        return SCOPE.unknown(f"{less}, but it is none that may be used: {found.faults[0]}", found.gain, bound)
    return SCOPE.judged([f"{less}: the plan is no optimum."], found.gain, bound)
