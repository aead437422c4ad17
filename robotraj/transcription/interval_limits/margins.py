"""Margins: limits tightened on single intervals by the excess of a motion between the points.

Torques of an exact motion follow from inverse dynamics at every time. Between the collocation points they differ from
the planned polynomial, whose Bernstein coefficients are bounded. Where they exceed a limit, the limit of the polynomial
is lowered by the excess. Only bounds change, so that the transcription and its compiled program are used again.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robotraj.problem.phase_row import Kind
from robotraj.transcription.interval_limits.row_places import Margins
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Entry, Scalars


def with_margins(nlp: Nlp, margins: Margins) -> Nlp:
    """Return the NLP with tighter bounds of variables and of their Bernstein coefficients; functions are shared."""
    if not margins:
        return nlp
    loose = nlp.loose_rows or nlp.rows
    rows, variables = _Tightened(loose), _Tightened(nlp.variables)
    numbers = {entry: number for number, entry in enumerate(loose.entries)}
    for place, amount in margins.items():
        phase, layout = nlp.problem.phases[place.phase], nlp.layouts[place.phase]
        row = phase.rows.rows[place.row]
        lower, upper = row.lower + amount, row.upper - amount
        if lower >= upper:
            continue
        for bound, control in phase.rows.bounds_of(phase.dae.controls):
            if bound.number == place.row:
                variables.tighten(_controls(layout, place.interval)[:, control], lower, upper)
        for bound, state in phase.rows.bounds_of(phase.dae.states):
            if bound.number == place.row:
                # Near a knot the value there decides, more than the inner coefficients. Given ends stay as they are.
                variables.tighten(layout.knots[place.interval : place.interval + 2, state], lower, upper)
        number = numbers.get(Entry.of(place.phase, row))
        first, last = layout.fractions[place.interval : place.interval + 2]
        inside = (loose.fraction >= first) & (loose.fraction <= last)
        chosen = np.flatnonzero((loose.meaning == number) & inside)
        if row.kind is Kind.RATE:
            # Rows of rates are one-sided, and those of a free duration are multiplied by it.
            rows.shift(chosen, amount * (1.0 if layout.duration.column is None else layout.duration.of(nlp.guess)))
        else:
            rows.tighten(chosen, lower, upper)
    again = replace(nlp, rows=rows.finish(), variables=variables.finish(), loose_rows=loose, margins=dict(margins))
    again = replace(again, guess=np.clip(nlp.guess, again.variables.lower, again.variables.upper))
    if "functions" in nlp.__dict__:
        again.__dict__["functions"] = replace(nlp.functions, preparing=0.0)
    return again


def _controls(layout: PhaseLayout, interval: int) -> np.ndarray:
    run = next(run for run in layout.runs if interval <= run.which[-1])
    return np.asarray(run.controls[interval - int(run.which[0])])


class _Tightened:
    """Scalars with bounds to tighten."""

    def __init__(self, scalars: Scalars) -> None:
        self.scalars = scalars
        self.lower, self.upper = scalars.lower.copy(), scalars.upper.copy()

    def tighten(self, at: np.ndarray, lower: float, upper: float) -> None:
        """Tighten finite bounds only, since a new finite bound would need a new program.

        Columns without bounds have rows on coefficients.
        """
        low, high = at[np.isfinite(self.lower[at])], at[np.isfinite(self.upper[at])]
        self.lower[low] = np.maximum(self.lower[low], np.minimum(lower, self.upper[low]))
        self.upper[high] = np.minimum(self.upper[high], np.maximum(upper, self.lower[high]))

    def shift(self, at: np.ndarray, amount: float) -> None:
        self.lower[at] += amount
        self.upper[at] -= amount

    def finish(self) -> Scalars:
        return replace(self.scalars, lower=self.lower, upper=self.upper)
