"""A machine with dry friction by Coulomb's law, which may stick, follows the plan with its motors' limits."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.claims.motion import off
from robotraj.witness.figures import Figures, Tolerances

SCOPE = Scope(
    "model",
    "time-stepping simulation of Coulomb's law with sticking, under solution.gains and the limits of effort",
    "dry friction, which the plan smooths near zero speed, lets the machine follow each phase from its planned state",
    "masses, inertias, damping and friction of the file; backlash, flexible joints, cables",
)


def model(figures: Figures, tolerances: Tolerances) -> Claim | None:
    """Return the claim on the model of dry friction; None without dry friction."""
    if not figures.has_friction:
        return None
    found = figures.friction
    if found is None:
        return SCOPE.unknown(LATE)
    if isinstance(found, str):
        return SCOPE.unknown(f"There is no simulation: {found}.")
    row = found.worst
    if tolerances.friction is None:
        return SCOPE.unknown("No threshold was given.", row.relative)
    wide = "the plan smooths dry friction too widely."
    sharper = "the robot a friction_speed smaller by as much, with dataclasses.replace(robot, friction_speed=...)."
    if figures.keeps_smooth_law:
        advice = f"{wide} Plans of robots with a free root keep the smooth law: give {sharper}"
    else:
        advice = f"{wide} Plan without mesh=, or give {sharper}"
    wrong = off("With Coulomb's friction, the robot leaves the plan:", row, tolerances.friction, advice)
    if wrong and figures.keeps_smooth_law:
        return SCOPE.unknown(wrong[0], row.relative, tolerances.friction)
    return SCOPE.judged(wrong, row.relative, tolerances.friction)
