"""Links of the robot do not pass through each other."""

from __future__ import annotations

from robotraj.robot.collision.unguarded import not_every_link
from robotraj.solution.claims.claim import Claim
from robotraj.witness.checks.self_collision import SWITCHED_OFF
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.figures import Figures, Tolerances

SCOPE = Scope(
    "own body",
    "coal on the exact shapes of links, by bounds on their speed between evaluations",
    "links that are neither neighbours nor overlap by construction stay apart",
    "links without a collision shape; cables, tools and loads that the file does not contain",
)


def own_body(figures: Figures, tolerances: Tolerances) -> Claim | None:
    """Return the claim on the robot's own body; None for Systems."""
    if not figures.moves_robot:
        return None
    if figures.was_late("self-collision") or "self-collision" in figures.unseen:
        return SCOPE.unknown(LATE)
    if figures.self_collisions:
        worst = min(figures.self_collisions, key=lambda each: each.distance)
        count = len(figures.self_collisions) - 1
        others = f", and {count} more pair{'s' * (count > 1)} do" if count else ""
        wrong = (
            f"Links of the robot overlap: {worst.label} by {-worst.distance:.3g} m at t = {worst.time:.4g} s in phase "
            f"{worst.phase!r}{others}."
        )
        return SCOPE.judged([wrong], worst.distance, None, "m")
    nearest = min((each.distance for each in figures.own_distances), default=None)
    switched_off = [each for each in figures.left_out if each.endswith(SWITCHED_OFF)]
    if switched_off:
        return SCOPE.unknown(f"Not judged: {switched_off[0]}.", nearest, None, "m")
    if figures.unguarded:
        return SCOPE.unknown(not_every_link(figures.unguarded), nearest, None, "m")
    return SCOPE.judged([], nearest, None, "m")
