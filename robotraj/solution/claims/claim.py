"""Claims about a plan: what a proof states, who judges it, and what it leaves out.

What is not on the list is not claimed. A claim that could not be judged is ``NOT_JUDGED``, never ``HOLDS``.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass


class Judgement(Enum):
    """The result of judging a claim."""

    HOLDS = "holds"
    FAILS = "fails"
    NOT_JUDGED = "not judged"


@dataclass(frozen=True)
class Claim(OneLine):
    """One claim about a plan.

    Attributes
    ----------
    name : str
        Such as ``"motion"``, ``"torques"``, ``"own body"``.
    judgement : Judgement
    judge : str
        By what the claim is judged.
    covers, leaves_out : str
        What the claim states, and what it does not state.
    figure, bound : float or None
        The worst figure, and the largest one that is allowed [unit]; None where the claim has none.
    unit : str
        Empty for relative figures.
    notes : tuple of str
        Sentences: why the claim fails or was not judged, else remarks.
    """

    name: str
    judgement: Judgement
    judge: str
    covers: str
    leaves_out: str
    figure: float | None = None
    bound: float | None = None
    unit: str = ""
    notes: tuple[str, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether the claim was judged and holds."""
        return self.judgement is Judgement.HOLDS

    def __str__(self) -> str:
        figure = "" if self.figure is None else f" {self.figure:.1e} {self.unit}".rstrip()
        bound = "" if self.bound is None else f" (allowed {self.bound:.0e})"
        return f"{self.name}: {self.judgement.value}{figure}{bound}"


def as_data(claims: Sequence[Claim]) -> list[dict[str, object]]:
    """Return claims as plain data, for JSON and the page."""
    return [
        {
            "name": claim.name,
            "judgement": claim.judgement.value,
            "judge": claim.judge,
            "covers": claim.covers,
            "leaves_out": claim.leaves_out,
            "figure": _finite(claim.figure),
            "bound": _finite(claim.bound),
            "unit": claim.unit,
            "notes": list(claim.notes),
        }
        for claim in claims
    ]


def _finite(value: float | None) -> float | None:
    """Return a finite number, else None: JSON holds no infinity."""
    return float(value) if value is not None and abs(value) < float("inf") else None
