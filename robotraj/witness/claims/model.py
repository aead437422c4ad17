"""The plan's model of dry friction is near Coulomb's law with sticking."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.figures import Figures, Tolerances

SCOPE = Scope(
    "model",
    "Coulomb's law on the planned speeds, in the mean over each phase",
    "dry friction, which the plan smooths near zero speed, is that of Coulomb's law to a share of the joint's load",
    "masses, inertias, damping and friction of the file; backlash, flexible joints, cables",
)


def model(figures: Figures, tolerances: Tolerances) -> Claim | None:
    """Return the claim on the model of dry friction; None without dry friction."""
    if not figures.has_friction:
        return None
    gap = figures.friction
    if gap is None:
        return SCOPE.unknown(LATE)
    if tolerances.friction is None:
        return SCOPE.unknown("No threshold was given.", gap.relative)
    if gap.relative > tolerances.friction:
        why = (
            f"A joint moves so slowly that the plan smooths its dry friction away: {gap}, in phase {gap.phase!r}; "
            f"{100 * tolerances.friction:.2g} percent are allowed. Give the robot a smaller friction_speed with "
            "dataclasses.replace(robot, friction_speed=...)."
        )
        return SCOPE.unknown(why, gap.relative, tolerances.friction)
    return SCOPE.judged([], gap.relative, tolerances.friction)
