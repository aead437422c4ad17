"""No finer mesh gains more than the goal: the plan is a local optimum, as far as the planner measured it."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.witness.claims.judged import Scope
from robotraj.witness.figures import Figures, Tolerances

SCOPE = Scope(
    "optimum",
    "the planner's own solves on several meshes",
    "the objective of this local optimum has settled: meshes as fine or finer gain no more than the goal",
    "other local optima, which another guess or rt.multistart may find",
)


def optimum(figures: Figures, tolerances: Tolerances) -> Claim:
    """Return the claim on the optimum."""
    proof = figures.proof
    if proof is None:
        return SCOPE.unknown(
            "The plan is that of a given mesh or tolerance, whose objective was compared with no other."
        )
    goal = proof.goals.objective
    if not proof.unsettled <= goal:
        why = f"Finer meshes are expected to gain {proof.unsettled:.1e} of the objective; {goal:.0e} is the goal."
        return SCOPE.unknown(why, proof.unsettled, goal)
    return SCOPE.judged([], proof.unsettled, goal)
