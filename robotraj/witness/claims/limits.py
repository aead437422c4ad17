"""Limits, constraints, links and end states hold, at and between the knots."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.solution.violation import Violation
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.figures import DISTANCE, Figures, Tolerances

SCOPE = Scope(
    "limits and constraints",
    "evaluation of every row on numeric points, at and between the knots",
    "limits that the problem imposes, constraints, links between phases, end states and durations",
    "limits that the problem does not state, such as acceleration and jerk where the robot has none",
)


def limits(figures: Figures, tolerances: Tolerances) -> Claim:
    """Return the claim on limits and constraints."""
    if figures.was_late("limits and constraints"):
        return SCOPE.unknown(LATE)
    rows = [violation for violation in figures.breaches if violation.name != DISTANCE]
    worst = max((violation.relative for violation in rows), default=0.0)
    return SCOPE.judged(broken_bounds(rows, tolerances.limits), worst, tolerances.limits)


def broken_bounds(rows: list[Violation], tolerance: float) -> list[str]:
    """Return a sentence about the worst violated bound."""
    broken = [v for v in rows if v.relative > tolerance]
    if not broken:
        return []
    others = f", and {len(broken) - 1} more" if len(broken) > 1 else ""
    return [
        f"A bound is violated: {broken[0]} in phase {broken[0].phase!r}{others}; "
        f"{tolerance * broken[0].size:.3g} is allowed."
    ]
