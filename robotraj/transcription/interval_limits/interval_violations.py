"""Rows that a solution violates between its collocation points.

Limits are imposed at collocation points, and a polynomial may exceed them in between. Every row is evaluated at dense
places of every interval. A parabola through three neighbouring places locates a peak between them. Where a row bends
sharply, as torques do where dry friction changes its sign, closer places are evaluated first. Three groups of rows
differ in their variables and in the allowed violation:

- rows of the state, evaluated along the polynomials of the state;
- bounds of controls, accelerations and other algebraic variables, and path rows that depend on them;
- path rows that depend on controls or algebraic variables, and bounds of contact forces.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.problem.augmentation import FRICTIONLESS
from robotraj.problem.constraints.motors.rates import RateLimit
from robotraj.problem.phase_row import Kind, PhaseRow
from robotraj.transcription.driven_motion import DefinedInputs, DrivenInputs, Inputs, PlannedInputs
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.interval_limits.full_friction import by_law_of_friction
from robotraj.transcription.interval_limits.methods import limited_algebraic
from robotraj.transcription.interval_limits.row_values import (
    STEP,
    Columns,
    Curve,
    DrivenCurve,
    Expressions,
    Indices,
    Rates,
    RowValues,
)

if TYPE_CHECKING:
    from robotraj.dynamics.variable import Variable
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]

PLACES = np.linspace(0.0, 1.0, 49)
"""Places of an interval at which rows are evaluated.

They include its ends: Radau's schemes have no point at the start, and Gauss's none at either end.
"""
CLOSER = np.linspace(-1.0, 1.0, 33)
"""Places around a sharp bend, in steps of ``PLACES``."""
ONE_SIDED = np.clip(PLACES, STEP, 1.0 - STEP)
"""Places for rates, controls and accelerations, which may jump at the knots."""
SHARE = 1e-2
"""Largest relative excess of a control over its limit that is not reported."""
EXACT = 1e-9
"""Largest violation of a state that is not reported [SI unit]; solvers stop with errors of this size."""
ROUNDING = 1e-9
"""Relative difference of equal values on both sides of a knot."""
EXACT_SHARE = 1e-3
"""Largest relative excess that is not reported for torques of exact motions and for path rows."""
RATE_SHARE = 1e-5
"""The same for jerks and rates of torques on a path, which are lines or nearly so between the knots."""


@dataclass(frozen=True)
class IntervalViolation:
    """A row that a solution violates between collocation points: its worst place on one interval.

    Attributes
    ----------
    phase, interval : int
        Indices.
    row : PhaseRow
    tau : float
        Fraction of the interval, in [0, 1].
    time : float
        Time of the worst place [s].
    amount : float
        Excess over the bound, in the row's SI unit.
    upper : bool
        Whether the upper bound is violated.
    """

    phase: int
    interval: int
    row: PhaseRow
    tau: float
    time: float
    amount: float
    upper: bool

    @property
    def limit(self) -> float:
        """The violated bound, in the row's SI unit."""
        return self.row.upper if self.upper else self.row.lower


def state_violations(phase: Phase, index: int, trajectory: PhaseTrajectory, allowed: float) -> list[IntervalViolation]:
    """Find rows of the state that are violated by more than ``allowed`` [SI unit], in every interval.

    For bounds below 1 SI unit, such as 0.05 rad/s, and rows of a smaller ``Row.size``, ``allowed`` is relative.
    """
    rows = phase.rows.of_state
    bounds = np.array([row.greatest_bound if row.kind is Kind.BOUND else 1.0 for row in rows])
    sizes = np.array([row.size for row in rows])
    shares = np.minimum(np.where(bounds > 0.0, bounds, 1.0), np.minimum(sizes, 1.0))
    return _violations(
        index, rows, Expressions(phase.rows, rows, trajectory, None), PLACES, np.maximum(allowed * shares, EXACT)
    )


def variable_violations(
    phase: Phase, index: int, trajectory: PhaseTrajectory, inputs: Inputs | None = None
) -> list[IntervalViolation]:
    """Find limits of controls and accelerations that are exceeded by more than a share of them, in every interval.

    They are bounds of these variables and of their rates, and path rows of the phase that depend on them.

    Parameters
    ----------
    phase : Phase
    index : int
        Number of the phase.
    trajectory : PhaseTrajectory
    inputs : Inputs, optional
        Inputs along the motion; the polynomials by default. Limits of torques that drive the motion and path rows may
        be exceeded by ``EXACT_SHARE``, all others by ``SHARE``.
    """
    curves: list[tuple[Sequence[Variable], Curve, float]] = [(limited_algebraic(phase), trajectory.z, SHARE)]
    if isinstance(inputs, DrivenInputs):
        curves += [(phase.body.controls, DrivenCurve(each, 1), EXACT_SHARE) for each in by_law_of_friction(inputs)]
    if not isinstance(inputs, DrivenInputs) or phase.dae.controls != phase.body.controls:
        curves.append((phase.dae.controls, trajectory.u, SHARE))
    found = []
    for variables, curve, share in curves:
        bounds = phase.rows.bounds_of(variables)
        if not bounds:
            continue
        rows, columns = [row for row, _ in bounds], [column for _, column in bounds]
        allowed = share * np.array([row.size for row in rows])
        found += _violations(index, rows, Columns(curve, columns), PLACES, allowed)
    found = _worst(found)
    if isinstance(inputs, DrivenInputs | DefinedInputs):
        # Accelerations are the planned polynomials, whose rates are bounded everywhere.
        algebraic = phase.dae.algebraic
        rates = [pair for pair in phase.rows.rates_of(algebraic) if algebraic[pair[1]].quantity == FRICTIONLESS]
        rows, columns = [row for row, _ in rates], [column for _, column in rates]
        allowed = EXACT_SHARE * np.array([row.size for row in rows])
        found += _violations(index, rows, Rates(DrivenCurve(inputs, 0), columns), ONE_SIDED, allowed)
    rows = [row for row in phase.rows.of_inputs if not row.is_equality and _is_given(phase, row)]
    reader = Expressions(phase.rows, rows, trajectory, inputs or PlannedInputs(trajectory))
    allowed = np.array([row.size * (RATE_SHARE if _limits_rate(phase, row) else EXACT_SHARE) for row in rows])
    return found + _violations(index, rows, reader, ONE_SIDED, allowed)


def _worst(found: Sequence[IntervalViolation]) -> list[IntervalViolation]:
    """Return the worst violation of every row and interval: torques may exceed one limit by both laws of friction."""
    worst: dict[tuple[int, int], IntervalViolation] = {}
    for each in found:
        known = worst.setdefault((each.row.number, each.interval), each)
        if each.amount > known.amount:
            worst[each.row.number, each.interval] = each
    return list(worst.values())


def _is_given(phase: Phase, row: PhaseRow) -> bool:
    """Whether a row is a constraint of the user; rows of contacts are measured against the weight."""
    return phase.rows.constraints[row.constraint].source is not None


def _limits_rate(phase: Phase, row: PhaseRow) -> bool:
    return isinstance(phase.rows.constraints[row.constraint].source, RateLimit)


def input_violations(
    phase: Phase,
    index: int,
    trajectory: PhaseTrajectory,
    inputs: Inputs | None = None,
    leaving: Collection[PhaseRow] = (),
) -> list[IntervalViolation]:
    """Find violated path rows of controls or algebraic variables, and bounds of contact forces, in every interval.

    Parameters
    ----------
    phase, index, trajectory, inputs
        See ``variable_violations``.
    leaving : collection of PhaseRow
        Rows that are left out.
    """
    forces = (force for contact in phase.bound_contacts for force in contact.forces)
    bounds = (row for row, _ in phase.rows.bounds_of(forces))
    rows = [row for row in (*phase.rows.of_inputs, *bounds) if row not in leaving]
    reader = Expressions(phase.rows, rows, trajectory, inputs or PlannedInputs(trajectory))
    return _violations(index, rows, reader, ONE_SIDED, np.zeros(len(rows)))


def _violations(
    phase: int, rows: Sequence[PhaseRow], reader: RowValues, places: Array, allowed: Array
) -> list[IntervalViolation]:
    """Find the worst place of every row and interval where the excess is above ``allowed`` (rows,)."""
    if not rows:
        return []
    lower, upper = (np.array([getattr(row, side) for row in rows]) for side in ("lower", "upper"))

    starts, lengths = reader.breaks[:-1], np.diff(reader.breaks)
    values = reader.grid(places)
    seen = np.maximum(lower - values, values - upper)
    with np.errstate(invalid="ignore"):
        bends = np.abs(seen[:, :-2] - 2.0 * seen[:, 1:-1] + seen[:, 2:])
    # A parabola through three places exceeds the middle one by at most half of its bend.
    near = np.any(seen[:, 1:-1] + bends > allowed, axis=1) | np.any(seen[:, (0, -1)] > allowed, axis=1)
    k, r = np.nonzero(near)
    if not k.size:
        return []
    # From here on, pairs of an interval and a row: (p, m) at the places, (p,) at the worst one.
    each, own, low, high, most = np.arange(k.size), seen[k, :, r], lower[r], upper[r], allowed[r]
    worst = own.argmax(axis=1)
    excess, tau = own[each, worst], places[worst]
    extreme = values[k, worst, r]
    beyond = extreme - high >= low - extreme
    inner = np.clip(worst, 1, len(places) - 2)
    before, here, after = (own[each, inner + i] for i in (-1, 0, 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        bend = before - 2 * here + after
        aside = 0.5 * (before - after) / bend
        peak = here - 0.25 * (before - after) * aside
        peaks = np.flatnonzero((bend < 0) & (np.abs(aside) <= 1) & (peak > np.maximum(excess, most)))
    at_peaks = places[inner[peaks]] + aside[peaks] * (places[1] - places[0])
    sharp, at_bends = _sharp_bends(own, bends[k, :, r], places, most, excess)
    p, closer = np.append(peaks, sharp), np.append(at_peaks, at_bends)
    if p.size:
        exact = reader.at(starts[k[p]] + lengths[k[p]] * closer, k[p])[np.arange(p.size), r[p]]
        over = np.maximum(low[p] - exact, exact - high[p])
        for i in np.argsort(over, kind="stable").tolist():
            if over[i] > excess[p[i]]:
                excess[p[i]], tau[p[i]], beyond[p[i]] = over[i], closer[i], exact[i] > high[p[i]]
    amount, place, above = np.full(near.shape, -np.inf), np.zeros(near.shape), np.zeros(near.shape, dtype=bool)
    amount[k, r], place[k, r], above[k, r] = excess, tau, beyond
    # A violation at a knot is counted once, in the interval on its right. It is kept on the left in two cases. The
    # worst place of the right interval is its own right knot, or a curve jumps to a value within its limits.
    shared = (place[:-1] == 1.0) & (place[1:] < 1.0) & (seen[1:, 0] >= amount[:-1] * (1.0 - ROUNDING))
    amount[:-1][shared] = -np.inf
    times = starts[:, None] + lengths[:, None] * place
    found = []
    for interval, row in np.argwhere(amount > allowed).tolist():
        at, time, by = (float(side[interval, row]) for side in (place, times, amount))
        found.append(IntervalViolation(phase, interval, rows[row], at, time, by, bool(above[interval, row])))
    return found


def _sharp_bends(seen: Array, bend: Array, places: Array, allowed: Array, known: Array) -> tuple[Indices, Array]:
    """Return closer places (p, tau) where a row bends so much that its excess may be above the known one.

    Parameters
    ----------
    seen : ndarray (P, m)
        Excess over the bound at the places (m,), for pairs p of an interval and a row.
    bend : ndarray (P, m - 2)
        Absolute second differences.
    places, allowed : ndarray
    known : ndarray (P,)
        Largest excess at the places.
    """
    near = (bend > allowed[:, None]) & (seen[:, 1:-1] + bend > np.maximum(known, allowed)[:, None])
    p, i = (np.repeat(each, len(CLOSER)) for each in np.nonzero(near))
    steps = np.tile(CLOSER, len(p) // len(CLOSER)) * (places[1] - places[0])
    return p, np.clip(places[i + 1] + steps, places[0], places[-1])
