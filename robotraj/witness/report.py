"""The report of a validation: figures with a verdict, which prints as text."""

from __future__ import annotations

import html
from dataclasses import fields, replace

from robotraj._util.errors import ValidationFailed, unknown_name
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import plain
from robotraj._util.values import dataclass
from robotraj.solution.claims.claim import Claim, Judgement
from robotraj.witness.claims.contract import claims_of
from robotraj.witness.colours import coloured
from robotraj.witness.figures import Figures, Tolerances
from robotraj.witness.report_text import render


@dataclass(frozen=True, repr=False)
class Report(Figures):
    """The result of a validation; see ``Figures`` for its attributes."""

    @property
    def passed(self) -> bool:
        """Whether no claim fails, and every figure with a threshold was computed.

        Claims that were not judged do not count; ``not_judged`` names them.
        """
        return not self.failures(self.tolerances)

    def failures(self, tolerances: Tolerances) -> tuple[str, ...]:
        """Return one sentence for each kind of figure that exceeds its tolerance, about the worst violation."""
        return failures_of(self, tolerances)

    def check(self, **allowed: float | None) -> None:
        """Raise an error unless the plan passes.

        Parameters
        ----------
        **allowed : float or None
            Thresholds by the names of ``Tolerances``: ``check(local=1e-4, contact=1e-5)``. Others are those of the
            report.

        Raises
        ------
        ValidationFailed
            States the worst violation of each kind with its joint and time; holds this report.
        """
        names = [entry.name for entry in fields(Tolerances)]
        for name in allowed:
            if name not in names:
                raise unknown_name("threshold", name, names)
        failures = self.failures(replace(self.tolerances, **{k: v for k, v in allowed.items() if v is not None}))
        if failures:
            raise ValidationFailed(" ".join(failures), self)

    @cached_property
    def claims(self) -> tuple[Claim, ...]:
        """Every claim of the contract that applies, with its judgement, its figure and its judge."""
        return claims_of(self, self.tolerances)

    @property
    def not_judged(self) -> tuple[str, ...]:
        """Names of the claims that were not judged."""
        return tuple(claim.name for claim in self.claims if claim.judgement is Judgement.NOT_JUDGED)

    @property
    def verdict(self) -> str:
        """``"PASSED"`` or ``"FAILED"``."""
        return "PASSED" if self.passed else "FAILED"

    def __repr__(self) -> str:
        local = "unknown" if self.local is None else f"{self.local.worst.relative:.1e}"
        loop = None if self.closed_loop is None else self.closed_loop.error
        tracking = "not simulated" if loop is None else f"{loop.worst.relative:.1e}"
        return (
            f"<Report {self.verdict}: local error {local}, tracking {tracking}, {len(self.violations)} violations, "
            f"{self.duration:.4g} s>"
        )

    def __str__(self) -> str:
        text = plain(render(self, self.failures(self.tolerances), self.verdict))
        return text.replace(self.verdict, coloured(self.verdict), 1)

    def _repr_html_(self) -> str:
        """Show the report in a notebook: the verdict in green or red above the figures."""
        colour = "#1a7f37" if self.passed else "#cf222e"
        text = html.escape(render(self, self.failures(self.tolerances), self.verdict))
        return f'<div><b style="color:{colour}">{self.verdict}</b><pre style="line-height:1.2">{text}</pre></div>'


def failures_of(figures: Figures, tolerances: Tolerances) -> tuple[str, ...]:
    """Return the sentences of all claims that fail, and of checks that could not be made."""
    found = [f"Not checked: {'; '.join(figures.unchecked)}."] if figures.unchecked else []
    for claim in claims_of(figures, tolerances):
        if claim.judgement is Judgement.FAILS:
            found += claim.notes
    return tuple(found)
