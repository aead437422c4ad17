"""Another simulator's robot follows the plan, on its own ground and with the limits of its motors."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.figures import Figures, Tolerances
from robotraj.witness.robustness.followed import worst_joint

SCOPE = Scope(
    "followed",
    "MuJoCo's simulation of the robot under rt.witness.LinearQuadratic(), with soft ground and saturated motors",
    "the robot completes the motion, three periods of one that repeats, without a fall and near the plan",
    "pushes, delays, sensor noise, and ground that is not as the plan's",
)


def followed(figures: Figures, tolerances: Tolerances) -> Claim | None:
    """Return the claim on following; None where ``followed=`` was not asked for."""
    if tolerances.followed is None:
        return None
    found = figures.followed
    if found is None:
        return SCOPE.unknown(LATE)
    worst = None if found.opinion is None else worst_joint(found.opinion)
    figure = None if worst is None else worst.largest
    unit = "" if worst is None else worst.unit
    if found.holds is None:
        return SCOPE.unknown(f"Not judged: {found.reason}.")
    wrong = [] if found.holds else [f"MuJoCo's robot does not follow the plan: {found.reason}."]
    return SCOPE.judged(wrong, figure, tolerances.followed, unit)
