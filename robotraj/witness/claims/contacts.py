"""Contacts hold where they are, with forces inside their limits, and impacts conserve momentum."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.contacts.failures import contact_failures, crossed_legs, link_failures, swing_failures
from robotraj.witness.figures import Figures, Tolerances

SCOPE = Scope(
    "ground and contacts",
    "Pinocchio's constrained dynamics, and positions of the contacts' frames between the knots",
    "contacts neither slip nor sink, forces stay in their cones and are those that hold the contacts, impacts conserve "
    "momentum, swinging feet stay above the ground and land from above, each foot on its own side, and all other links "
    "stay above the ground on which the feet's shapes stand, or the lowest of several",
    "compliance of the ground; walls, for links without a contact on them",
)
CHECKS = ("contacts", "impacts", "swinging feet", "links over the ground", "lateral order of the feet")
"""Checks of the validation that the claim needs."""


def contacts(figures: Figures, tolerances: Tolerances) -> Claim | None:
    """Return the claim on ground and contacts; None for a motion without contacts."""
    if any(map(figures.was_late, CHECKS)):
        return SCOPE.unknown(LATE)
    if not (figures.holdings or figures.impacts or figures.swings or figures.foot_orders):
        return None
    wrong = [
        *contact_failures(figures.holdings, figures.impacts, tolerances),
        *swing_failures(figures.swings, tolerances.ground),
        *link_failures(figures.link_depths, tolerances.ground),
        *crossed_legs(figures.foot_orders),
    ]
    moved = max((max(h.slip.value, h.sink.value) for h in figures.holdings), default=0.0)
    return SCOPE.judged(wrong, moved, tolerances.contact, "m")
