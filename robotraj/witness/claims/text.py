"""The list of claims as text."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj.solution.claims.claim import Claim, Judgement
from robotraj.witness.report_tables import table, wrapped


def claims_text(claims: Sequence[Claim]) -> list[str]:
    """Return a table of the claims, and the reasons of those that were not judged."""
    cells = [
        [
            claim.name,
            claim.judgement.value,
            "" if claim.figure is None else f"{claim.figure:.1e} {claim.unit}".rstrip(),
            "" if claim.bound is None else f"{claim.bound:.0e}",
        ]
        for claim in claims
    ]
    lines = table(("claim", "judgement", "worst", "allowed"), cells, (0, 1))
    for claim in claims:
        if claim.judgement is Judgement.NOT_JUDGED:
            lines += [line for note in claim.notes for line in wrapped(f"{claim.name}: {note}", "  ? ", "    ")]
    return [*lines, ""]
