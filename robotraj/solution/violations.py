"""Rows and bounds evaluated again, outside the solver, and what of them is broken."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.table import Scalars

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Violation:
    """One broken row or bound.

    Attributes
    ----------
    phase : str
        Name of the phase.
    name : str
        ``"effort limit, elbow"``.
    time : float
        [s].
    amount : float
        How far beyond the bound, in ``unit``.
    unit : str
    relative : float
        The amount relative to the scale of the row, by which violations are ranked.
    """

    phase: str
    name: str
    time: float
    amount: float
    unit: str
    relative: float

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.name}, t = {self.time:.4g} s: {self.amount:.3g}{unit} over"


def violations(nlp: Nlp, w: Array, tolerance: float, outputs: Sequence[Array] | None = None) -> tuple[Violation, ...]:
    """Every row and bound broken by more than ``tolerance`` relative to its scale, worst first.

    Parameters
    ----------
    nlp : Nlp
    w : ndarray (n_w,)
        In physical units.
    tolerance : float
        On scaled rows and scaled variables.
    outputs : sequence of ndarray, optional
        ``nlp.outputs(w)``, where they are known.
    """
    found = _broken(nlp, nlp.rows, nlp.values(w, outputs), nlp.row_scale, w, tolerance)
    found += _broken(nlp, nlp.variables, w, 1.0 / nlp.scale, w, tolerance)
    return tuple(sorted(found, key=lambda violation: -violation.relative))


def _broken(nlp: Nlp, scalars: Scalars, values: Array, factor: Array, w: Array, tolerance: float) -> list[Violation]:
    below, above = scalars.lower - values, values - scalars.upper
    amount = np.maximum(below, above)
    # NaN is a violation of everything.
    relative = np.where(np.isnan(amount), np.inf, amount * factor)
    chosen = np.flatnonzero(relative > tolerance)
    if not chosen.size:
        return []
    times = nlp.times(scalars, w)
    found = []
    for i in chosen:
        meaning = scalars.lower_meaning[i] if below[i] > above[i] else scalars.upper_meaning[i]
        entry = scalars.entries[meaning]
        phase = nlp.problem.phases[entry.phase].name
        found.append(Violation(phase, str(entry), float(times[i]), float(amount[i]), entry.unit, float(relative[i])))
    return found
