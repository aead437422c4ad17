"""Making a claim from a figure and the sentences on what is wrong."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj._util.values import dataclass
from robotraj.solution.claims.claim import Claim, Judgement


@dataclass(frozen=True)
class Scope:
    """What never changes of a claim: its name, its judge, what it covers and what it leaves out."""

    name: str
    judge: str
    covers: str
    leaves_out: str

    def judged(
        self, wrong: Sequence[str], figure: float | None = None, bound: float | None = None, unit: str = ""
    ) -> Claim:
        """Return the claim, which holds where nothing is ``wrong``."""
        judgement = Judgement.FAILS if wrong else Judgement.HOLDS
        return self._claim(judgement, figure, bound, unit, tuple(wrong))

    def unknown(self, why: str, figure: float | None = None, bound: float | None = None, unit: str = "") -> Claim:
        """Return the claim as not judged, with the reason."""
        return self._claim(Judgement.NOT_JUDGED, figure, bound, unit, (why,))

    def _claim(
        self, judgement: Judgement, figure: float | None, bound: float | None, unit: str, notes: tuple[str, ...]
    ) -> Claim:
        return Claim(self.name, judgement, self.judge, self.covers, self.leaves_out, figure, bound, unit, notes)


LATE = "The time limit was reached before."
