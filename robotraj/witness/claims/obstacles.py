"""The robot's exact shapes keep their distance from the obstacles of every ``CollisionFree``."""

from __future__ import annotations

from robotraj.robot.collision.unguarded import not_every_link
from robotraj.solution.claims.claim import Claim
from robotraj.witness.checks.clearance import NO_MARGIN
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.claims.limits import broken_bounds
from robotraj.witness.figures import DISTANCE, Figures, Tolerances

SCOPE = Scope(
    "obstacles",
    "coal's distances of the exact shapes, by bounds on their speed between evaluations",
    "links keep the margin of every CollisionFree from its obstacles and from each other",
    "links without a collision shape, and things that the problem does not state",
)


def obstacles(figures: Figures, tolerances: Tolerances) -> Claim | None:
    """Return the claim on distances; None without a ``CollisionFree``."""
    short = [violation for violation in figures.breaches if violation.name == DISTANCE]
    if not figures.avoids_collisions:
        return None
    if figures.was_late("distances"):
        return SCOPE.unknown(LATE)
    nearest = min((each.distance - each.margin for each in figures.clearances), default=None)
    unkept = [each for each in figures.left_out if each.endswith(NO_MARGIN)]
    if not short and unkept:
        return SCOPE.unknown(f"Not judged: {'; '.join(unkept)}.", nearest, None, "m beyond the margin")
    if not short and figures.unguarded:
        return SCOPE.unknown(not_every_link(figures.unguarded), nearest, None, "m beyond the margin")
    return SCOPE.judged(broken_bounds(short, tolerances.limits), nearest, None, "m beyond the margin")
