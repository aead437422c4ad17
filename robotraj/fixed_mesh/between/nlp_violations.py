"""Violations of rows and bounds of the NLP, evaluated outside the solver, and of rows between collocation points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj.problem.problem import Problem
from robotraj.solution.violation import Side, Violation, violated
from robotraj.transcription.interval_limits.interval_violations import IntervalViolation
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import Scalars


def violations(nlp: Nlp, w: Array, tolerance: float, outputs: Sequence[Array] | None = None) -> tuple[Violation, ...]:
    """Return every row and bound violated by more than ``tolerance`` relative to its scale, the worst first.

    Parameters
    ----------
    nlp : Nlp
    w : ndarray (n_w,)
        Decision vector in physical units.
    tolerance : float
        Tolerance on scaled rows and scaled variables.
    outputs : sequence of ndarray, optional
        ``nlp.outputs(w)``, if they are known.
    """
    found = _broken(nlp, nlp.rows, nlp.values(w, outputs), nlp.row_scale, w, tolerance)
    found += _broken(nlp, nlp.variables, w, 1.0 / nlp.scale, w, tolerance)
    return tuple(sorted(found, key=lambda violation: -violation.relative))


def between_points(problem: Problem, found: Sequence[IntervalViolation]) -> tuple[Violation, ...]:
    """Return the violations of rows between the collocation points, the largest relative to its row first."""
    listed = []
    for each in found:
        row = each.row
        side: Side = "off" if row.is_equality else "over" if each.upper else "under"
        measured = (each.time, each.amount, row.unit, each.limit, side, each.size)
        violation = Violation(problem.phases[each.phase].name, row.name, row.joint, *measured)
        listed.append(violation.measured(row.measure))
    return tuple(sorted(listed, key=lambda violation: -violation.relative))


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
        # A factor of 0 belongs to a row of infinite size, as over a duration near the least double.
        phase, size = nlp.problem.phases[entry.phase].name, 1.0 / float(factor[i]) if factor[i] else np.inf
        joint = entry.label or None
        violation = Violation(phase, entry.name, joint, float(times[i]), beyond, entry.unit, limit, side, size)
        found.append(violation.measured(entry.measure))
    return found
