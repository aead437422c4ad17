"""The list of claims. What is not on it is not claimed."""

from __future__ import annotations

from collections.abc import Callable

from robotraj.solution.claims.claim import Claim
from robotraj.witness.claims.contacts import contacts
from robotraj.witness.claims.followed import followed
from robotraj.witness.claims.limits import limits
from robotraj.witness.claims.model import model
from robotraj.witness.claims.motion import motion
from robotraj.witness.claims.objective import objective
from robotraj.witness.claims.obstacles import obstacles
from robotraj.witness.claims.optimum import optimum
from robotraj.witness.claims.own_body import own_body
from robotraj.witness.claims.smoothness import smoothness
from robotraj.witness.claims.torques import torques
from robotraj.witness.claims.tracking import tracking
from robotraj.witness.figures import Figures, Tolerances

CONTRACT: tuple[Callable[[Figures, Tolerances], Claim | None], ...] = (
    motion,
    torques,
    smoothness,
    tracking,
    followed,
    model,
    limits,
    contacts,
    own_body,
    obstacles,
    objective,
    optimum,
)
"""Functions of the figures and tolerances; each returns its claim, or None where it does not apply to the motion."""


def claims_of(figures: Figures, tolerances: Tolerances) -> tuple[Claim, ...]:
    """Return every claim that applies to a validated motion."""
    found = (claim(figures, tolerances) for claim in CONTRACT)
    return tuple(claim for claim in found if claim is not None)
