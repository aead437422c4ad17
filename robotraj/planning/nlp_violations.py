"""The rows and bounds of the NLP, evaluated again outside the solver, and those that are violated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotraj.solution.violation import Violation, violated
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.table import Scalars

Array = NDArray[np.float64]


def violations(nlp: Nlp, w: Array, tolerance: float, outputs: Sequence[Array] | None = None) -> tuple[Violation, ...]:
    """Return every row and bound violated by more than ``tolerance`` relative to its scale, the worst first.

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
    amount = np.maximum(scalars.lower - values, values - scalars.upper)
    # A value that is not a number violates its bounds.
    chosen = np.flatnonzero(~(amount * factor <= tolerance))
    if not chosen.size:
        return []
    times = nlp.times(scalars, w)
    found = []
    for i in chosen:
        beyond, limit, side = violated(float(values[i]), float(scalars.lower[i]), float(scalars.upper[i]))
        entry = scalars.entries[(scalars.lower_meaning if side == "under" else scalars.upper_meaning)[i]]
        phase, size = nlp.problem.phases[entry.phase].name, 1.0 / float(factor[i])
        joint = entry.label or None
        found.append(Violation(phase, entry.name, joint, float(times[i]), beyond, entry.unit, limit, side, size))
    return found
