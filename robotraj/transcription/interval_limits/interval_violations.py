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

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array, Indices
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Variable
from robotraj.problem.augmentation import FRICTIONLESS
from robotraj.problem.constraints.motors.rates import RateLimit
from robotraj.problem.phase import Phase
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
    Rates,
    RowValues,
)

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
"""Largest violation of a state that is not reported [SI unit], relative to sizes below 1; solvers stop with these."""
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
    size : float
        Excess that counts as 1 there, in the row's SI unit (``Row.size_in``).
    """

    phase: int
    interval: int
    row: PhaseRow
    tau: float
    time: float
    amount: float
    upper: bool
    size: float

    @property
    def relative(self) -> float:
        """``amount`` / ``size``."""
        return self.amount / self.size

    @property
    def limit(self) -> float:
        """The violated bound, in the row's SI unit."""
        return self.row.upper if self.upper else self.row.lower


def state_violations(
    phase: Phase, index: int, trajectory: PhaseTrajectory, allowed: float, alike: Sequence[PhaseTrajectory] = ()
) -> list[IntervalViolation]:
    """Find rows of the state that are violated by more than ``allowed`` [SI unit], in every interval.

    For bounds below 1 SI unit, such as 0.05 rad/s, and rows of a smaller size, ``allowed`` is relative.
    Trajectories of other phases with the same variables are ``alike``; sizes are those of the whole motion.
    """
    rows = phase.rows.of_state
    bounds = np.array([row.greatest_bound if row.kind is Kind.BOUND else 1.0 for row in rows])
    greatest = np.minimum(1.0, np.where(bounds > 0.0, bounds, 1.0))
    reader = Expressions(phase.rows, rows, trajectory, None, alike)
    return _violations(index, rows, reader, PLACES, allowed, greatest, EXACT)


def variable_violations(
    phase: Phase,
    index: int,
    trajectory: PhaseTrajectory,
    inputs: Inputs | None = None,
    alike: Sequence[PhaseTrajectory] = (),
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
    alike : sequence of PhaseTrajectory
        See ``state_violations``.
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
        found += _violations(index, rows, Columns(curve, columns), PLACES, share)
    found = _worst(found)
    if isinstance(inputs, DrivenInputs | DefinedInputs):
        # Accelerations are the planned polynomials, whose rates are bounded everywhere.
        algebraic = phase.dae.algebraic
        rates = [pair for pair in phase.rows.rates_of(algebraic) if algebraic[pair[1]].quantity == FRICTIONLESS]
        rows, columns = [row for row, _ in rates], [column for _, column in rates]
        found += _violations(index, rows, Rates(DrivenCurve(inputs, 0), columns), ONE_SIDED, EXACT_SHARE)
    rows = [row for row in phase.rows.of_inputs if not row.is_equality and _is_given(phase, row)]
    reader = Expressions(phase.rows, rows, trajectory, inputs or PlannedInputs(trajectory), alike)
    shares = np.array([RATE_SHARE if _limits_rate(phase, row) else EXACT_SHARE for row in rows])
    return found + _violations(index, rows, reader, ONE_SIDED, shares)


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
    alike: Sequence[PhaseTrajectory] = (),
) -> list[IntervalViolation]:
    """Find violated path rows of controls or algebraic variables, and bounds of contact forces, in every interval.

    Parameters
    ----------
    phase, index, trajectory, inputs, alike
        See ``variable_violations``.
    leaving : collection of PhaseRow
        Rows that are left out.
    """
    forces = (force for contact in phase.bound_contacts for force in contact.forces)
    bounds = (row for row, _ in phase.rows.bounds_of(forces))
    rows = [row for row in (*phase.rows.of_inputs, *bounds) if row not in leaving]
    reader = Expressions(phase.rows, rows, trajectory, inputs or PlannedInputs(trajectory), alike)
    return _violations(index, rows, reader, ONE_SIDED, 0.0)


def _violations(
    phase: int,
    rows: Sequence[PhaseRow],
    reader: RowValues,
    places: Array,
    share: float | Array,
    greatest: float | Array = np.inf,
    rounding: float = 0.0,
) -> list[IntervalViolation]:
    """Find the worst place of every row and interval where the excess is above a share of the row's size.

    Parameters
    ----------
    share : float or ndarray (rows,)
        Allowed excess relative to the size of the row.
    greatest : float or ndarray (rows,)
        Greatest size to which it is relative.
    rounding : float
        Excess that is always allowed [SI unit], relative to sizes below 1.
    """
    if not rows:
        return []
    lower, upper = (np.array([getattr(row, side) for row in rows]) for side in ("lower", "upper"))

    starts, lengths = reader.breaks[:-1], np.diff(reader.breaks)
    values = reader.grid(places)
    seen = np.maximum(lower - values, values - upper)
    with np.errstate(invalid="ignore"):
        bends = np.abs(seen[:, :-2] - 2.0 * seen[:, 1:-1] + seen[:, 2:])
    sizes = _sizes(rows, reader, places, values, seen, bends)
    allowed = np.maximum(share * np.minimum(sizes, greatest), rounding * np.minimum(sizes, 1.0))
    # A parabola through three places exceeds the middle one by at most half of its bend.
    near = _may_exceed(seen, bends, allowed)
    k, r = np.nonzero(near)
    if not k.size:
        return []
    # From here on, pairs of an interval and a row: (p, m) at the places, (p,) at the worst one.
    each, own, low, high, most = np.arange(k.size), seen[k, :, r], lower[r], upper[r], allowed[k, r]
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
        upwards, size = bool(above[interval, row]), float(sizes[interval, row])
        found.append(IntervalViolation(phase, interval, rows[row], at, time, by, upwards, size))
    return found


def _may_exceed(seen: Array, bends: Array, allowed: Array) -> NDArray[np.bool_]:
    """Whether the excess over the bounds may be above the allowed one on an interval (K, rows), bends included."""
    inside = np.any(seen[:, 1:-1] + bends > allowed[:, None], axis=1)
    return np.asarray(inside | np.any(seen[:, (0, -1)] > allowed[:, None], axis=1))


def _sizes(
    rows: Sequence[PhaseRow], reader: RowValues, places: Array, values: Array, seen: Array, bends: Array
) -> Array:
    """Return the sizes (K, rows) of rows: variables by their largest value, expressions by what the motion changes.

    Expressions are measured at the worst place of intervals on which they may exceed their bounds.
    """
    peaks = np.abs(values).max(axis=(0, 1))
    if not isinstance(reader, Expressions):
        own = np.array([row.size_in(float(peak)) for row, peak in zip(rows, peaks, strict=True)])
        return np.broadcast_to(own, (len(values), len(rows)))
    sizes = np.tile([row.size for row in rows], (len(values), 1))
    near = _may_exceed(seen, bends, np.broadcast_to(ROUNDING * peaks, sizes.shape)) & reader.given
    k, r = np.nonzero(near)
    if k.size:
        # Each place is evaluated once for all rows that are near a bound anywhere.
        at, which = np.unique(seen.argmax(axis=1)[k, r] * len(values) + k, return_inverse=True)
        intervals, chosen = at % len(values), np.unique(r)
        times = reader.breaks[intervals] + np.diff(reader.breaks)[intervals] * places[at // len(values)]
        found = reader.sizes([rows[i] for i in chosen], times, intervals)
        sizes[k, r] = found[which, np.searchsorted(chosen, r)]
    return sizes


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
