"""A robot with the plan's own feedback follows the plan to its end."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.solution.feedback.gains import BANDWIDTH
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.claims.motion import advice_on, off
from robotraj.witness.figures import Figures, Tolerances

DIVERGENCE = 0.5 * BANDWIDTH
"""Rate at which feedback drives deviations away that refuses it, in the mean along a phase [1/s].

Reversed gains do so at twice the bandwidth.
"""
SCOPE = Scope(
    "tracking",
    "forward simulation of the whole motion by plain Pinocchio, with solution.gains, and the eigenvalues with feedback",
    "time-varying linear feedback keeps the modelled robot on the plan, without disturbances",
    "disturbances, delays, sensor noise and limits of torque under feedback (rt.witness.robustness has these)",
)


def tracking(figures: Figures, tolerances: Tolerances) -> Claim | None:
    """Return the claim on tracking; None where no feedback exists, such as for Systems."""
    loop = figures.closed_loop
    if loop is None:
        return SCOPE.unknown(LATE) if figures.moves_robot else None
    if loop.error is None:
        return SCOPE.unknown(f"There is no simulation: {loop.reason}.") if figures.moves_robot else None
    row = loop.error.worst
    if tolerances.tracking is None:
        return SCOPE.unknown("No threshold was given.", row.relative)
    if loop.reason is not None:
        wrong = [f"With feedback, the robot does not complete the plan: {loop.reason}."]
    else:
        advice = advice_on(figures.residual)
        wrong = off("With feedback, the robot leaves the plan:", row, tolerances.tracking, advice)
    if not loop.divergence <= DIVERGENCE:
        away = f"Feedback drives the robot away from the plan: a deviation grows at {loop.divergence:.3g} 1/s more"
        wrong = [*wrong, f"{away} than without feedback; {DIVERGENCE:g} is allowed."]
    return SCOPE.judged(wrong, row.relative, tolerances.tracking)
