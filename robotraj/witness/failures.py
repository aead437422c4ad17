"""Messages about a plan: one sentence for each kind of figure that exceeds its tolerance."""

from __future__ import annotations

from robotraj.solution.claims.claim import Judgement
from robotraj.witness.claims.contract import claims_of
from robotraj.witness.figures import Figures, Tolerances


def failures_of(figures: Figures, tolerances: Tolerances) -> tuple[str, ...]:
    """Return the sentences of all claims that fail, and of checks that could not be made."""
    found = [f"Not checked: {'; '.join(figures.unchecked)}."] if figures.unchecked else []
    for claim in claims_of(figures, tolerances):
        if claim.judgement is Judgement.FAILS:
            found += claim.notes
    return tuple(found)
