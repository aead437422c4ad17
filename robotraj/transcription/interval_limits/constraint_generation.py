"""Guards: rows imposed between the collocation points, on the polynomial that was collocated.

Limits hold at collocation points; between them a polynomial may bulge over. A guard holds one row of a constraint at
one more place tau of one interval, where the state is x(tau) = x_0 + d sum_k (T f_k) int_0^tau l_k: linear in the
stage outputs. Guards are placed where a dense look at a solution finds a row broken (an exchange method for
semi-infinite programs). Source: Hettich and Kortanek, Semi-infinite programming, SIAM Review 35 (1993), section 7.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import casadi as ca
import numpy as np

from robotraj._util.polynomials import integrals
from robotraj._util.values import dataclass
from robotraj.dynamics.rows import as_rows
from robotraj.problem.constraints.base import BoundConstraint, Row, Where, symbols_of
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.collocation.collocation import interval_scalars, point_symbols
from robotraj.transcription.collocation.ends import repeated
from robotraj.transcription.extract import PhaseTrajectory, correction_basis
from robotraj.transcription.interval_limits.methods import limited_algebraic
from robotraj.transcription.layout import IntervalLayout, PhaseLayout, entries_of
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.table import Entry, Indices, ScalarTable

if TYPE_CHECKING:
    from robotraj.dynamics.variable import Variable
    from robotraj.problem.phase import Phase

PLACES = np.linspace(0.0, 1.0, 49)
"""Places looked at in an interval, its ends among them: at Radau's first knot and at Gauss's none is collocated."""
SHARE = 1e-2
"""Share of its limit by which a control may exceed it between collocation points before that is told."""
EXACT_SHARE = 1e-3
"""The same for torques of exact motions, which are known at any time."""
SPREAD = 0.5 * (1.0 - np.cos(np.pi * (np.arange(6) + 0.5) / 6))
"""Places guarded inside an interval where a single one did not do."""


class Curve(Protocol):
    """A vector-valued function of time on intervals, such as a ``PiecewisePolynomial``."""

    @property
    def breaks(self) -> np.ndarray:
        """Ends of the intervals [s], (K + 1,)."""
        ...

    def __call__(self, t: Any, interval: int | None = None) -> np.ndarray:
        """Evaluate at times, (n,) or (m, n)."""
        ...

    def inside(self, tau: np.ndarray) -> np.ndarray:
        """Evaluate every interval at the same places tau in [0, 1], (m,) -> (K, m, n)."""
        ...


@dataclass(frozen=True)
class Guard:
    """One row of a phase's constraint, imposed at tau in [0, 1] of an interval.

    Attributes
    ----------
    phase, interval, constraint, row : int
        Indices; ``constraint`` into ``phase.bound_constraints``.
    tau : float
    """

    phase: int
    interval: int
    constraint: int
    row: int
    tau: float


def guardable(phase: Phase) -> list[tuple[int, int, BoundConstraint, Row]]:
    """Rows held throughout that read the state, time and parameters alone."""
    states = {s.name for s in phase.dae.states}
    found = []
    for c, constraint in enumerate(phase.bound_constraints):
        if constraint.where is not Where.THROUGHOUT:
            continue
        of_state = _read_the_state(phase, constraint) if any(r.variable is None for r in constraint.rows) else ()
        for r, row in enumerate(constraint.rows):
            if row.variable in states or r in of_state:
                found.append((c, r, constraint, row))
    return found


def _read_the_state(phase: Phase, constraint: BoundConstraint) -> list[int]:
    """Rows of an expression that reads neither algebraic variables nor controls."""
    point = symbols_of(phase.dae, phase.parameter_names)
    # By forward dynamics a robot's accelerations are expressions, not variables: its algebraic variables are none.
    z = (point.z[variable.name] for variable in phase.body.algebraic)
    inner = ca.vertcat(ca.SX(0, 1), *z, *point.u.values())
    values = as_rows(constraint.expression(point), f"expression of {constraint.name!r}")
    rows = zip(constraint.rows, values, strict=True)
    return [r for r, (row, value) in enumerate(rows) if row.variable is None and not ca.depends_on(value, inner)]


@dataclass(frozen=True)
class Bulge:
    """A row that a solution breaks between collocation points: the guard that would hold it, and by how much.

    Attributes
    ----------
    guard : Guard
    time : float
        [s].
    amount : float
        In the row's SI unit.
    upper : bool
        Whether the upper bound is violated.
    """

    guard: Guard
    time: float
    amount: float
    upper: bool

    def guards(self, again: bool) -> list[Guard]:
        """Guards to set: one at the worst place, and with ``again`` at Chebyshev points all over the interval."""
        return [self.guard, *(replace(self.guard, tau=float(tau)) for tau in SPREAD)] if again else [self.guard]


def find_bulges(phase: Phase, index: int, trajectory: PhaseTrajectory, allowed: float) -> list[Bulge]:
    """Worst place of every row on states in every interval where it is broken by more than ``allowed`` [SI unit]."""
    rows = guardable(phase)
    if not rows:
        return []
    parameters = np.array(list(trajectory.parameters.values()))

    def values(times: np.ndarray, x: np.ndarray) -> np.ndarray:
        return _values(phase, rows, times, x, parameters)

    return _peaks(index, rows, trajectory.x, values, np.full(len(rows), allowed))


def find_control_bulges(
    phase: Phase, index: int, trajectory: PhaseTrajectory, torques: Curve | None = None
) -> list[Bulge]:
    """Worst place in every interval of every bound on a control, or on an acceleration, that is exceeded there.

    Parameters
    ----------
    phase : Phase
    index : int
        Of the phase.
    trajectory : PhaseTrajectory
    torques : Curve, optional
        Torques of the robot at any time, where they are known better than from their polynomials; their limits may be
        exceeded by ``EXACT_SHARE``, all others by ``SHARE``.
    """
    bulges = []
    curves: list[tuple[Sequence[Variable], Curve, float]] = [(limited_algebraic(phase), trajectory.z, SHARE)]
    if torques is not None:
        curves.append((phase.body.controls, torques, EXACT_SHARE))
    if torques is None or phase.dae.controls != phase.body.controls:
        curves.append((phase.dae.controls, trajectory.u, SHARE))
    for variables, curve, share in curves:
        names = [variable.name for variable in variables]
        rows = [
            (c, r, constraint, row)
            for c, constraint in enumerate(phase.bound_constraints)
            for r, row in enumerate(constraint.rows)
            if constraint.where is Where.THROUGHOUT and row.variable in names
        ]
        if not rows:
            continue
        limits = [max((abs(b) for b in (row.lower, row.upper) if np.isfinite(b)), default=0.0) for *_, row in rows]
        columns = [names.index(str(row.variable)) for *_, row in rows]
        bulges += _peaks(index, rows, curve, partial(_chosen, columns), share * np.array(limits))
    return bulges


def _chosen(columns: list[int], times: np.ndarray, values: np.ndarray) -> np.ndarray:
    return values[:, columns]


def _peaks(
    phase: int,
    rows: list[tuple[int, int, BoundConstraint, Row]],
    curve: Curve,
    values: Callable[[np.ndarray, np.ndarray], np.ndarray],
    allowed: np.ndarray,
) -> list[Bulge]:
    """Find where rows rise above their bounds: at the places, and where parabolas through three of them peak.

    ``values`` gives (m, rows) at times (m,) and points (m, n) of the curve.
    """
    lower, upper = (np.array([getattr(row, side) for *_, row in rows]) for side in ("lower", "upper"))

    def over(times: np.ndarray, points: np.ndarray) -> np.ndarray:
        found = values(times, points)
        return np.maximum(lower - found, found - upper)

    times = curve.breaks[:-1, None] + np.diff(curve.breaks)[:, None] * PLACES
    found = values(times.ravel(), curve.inside(PLACES).reshape(times.size, -1)).reshape(*times.shape, len(rows))
    seen = np.maximum(lower - found, found - upper)
    worst = seen.argmax(axis=1)
    extreme = np.take_along_axis(found, worst[:, None], axis=1)[:, 0]
    amount, place = np.take_along_axis(seen, worst[:, None], axis=1)[:, 0], PLACES[worst]
    inner = np.clip(worst, 1, len(PLACES) - 2)
    before, here, after = (np.take_along_axis(seen, (inner + i)[:, None], axis=1)[:, 0] for i in (-1, 0, 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        bend = before - 2 * here + after
        aside = 0.5 * (before - after) / bend
        peak = here - 0.25 * (before - after) * aside
        high = (bend < 0) & (np.abs(aside) <= 1) & (peak > np.maximum(amount, allowed))
    k, r = np.nonzero(high)
    if k.size:
        tau = PLACES[inner[k, r]] + aside[k, r] * PLACES[1]
        at = times[k, 0] + (times[k, -1] - times[k, 0]) * tau
        points = np.array([curve(t, interval) for t, interval in zip(at.tolist(), k.tolist(), strict=True)])
        exact = over(at, points)[np.arange(k.size), r]
        better = exact > amount[k, r]
        k, r = k[better], r[better]
        amount[k, r], place[k, r] = exact[better], tau[better]
    # A knot is looked at once, as the beginning of the interval on its right.
    amount[:-1][place[:-1] == 1.0] = -np.inf
    bulges = []
    for k_, r_ in np.argwhere(amount > allowed).tolist():
        guard = Guard(phase, k_, rows[r_][0], rows[r_][1], float(place[k_, r_]))
        time = float(times[k_, 0] + (times[k_, -1] - times[k_, 0]) * guard.tau)
        above = bool(extreme[k_, r_] - upper[r_] >= lower[r_] - extreme[k_, r_])
        bulges.append(Bulge(guard, time, float(amount[k_, r_]), above))
    return bulges


def _values(
    phase: Phase, rows: list[tuple[int, int, BoundConstraint, Row]], t: np.ndarray, x: np.ndarray, p: np.ndarray
) -> np.ndarray:
    names = [s.name for s in phase.dae.states]
    values = np.empty((len(t), len(rows)))
    for i, (*_, row) in enumerate(rows):
        if row.variable is not None:
            values[:, i] = x[:, names.index(row.variable)]
    path = [i for i, (*_, row) in enumerate(rows) if row.variable is None]
    if not path:
        return values
    time, state, parameters = ca.SX.sym("t"), ca.SX.sym("x", len(names)), ca.SX.sym("p", len(p))
    z, u = ca.SX.sym("z", len(phase.dae.algebraic)), ca.SX.sym("u", len(phase.dae.controls))
    point = phase.dae.point(time, state, z, u, parameters, phase.parameter_names)
    computed: dict[int, list[ca.SX]] = {}
    for i in path:
        c, _, constraint, _ = rows[i]
        if c not in computed:
            computed[c] = as_rows(constraint.expression(point), f"expression of {constraint.name!r}")
    entries = ca.vertcat(*(computed[rows[i][0]][rows[i][1]] for i in path))
    function = ca.Function("rows", [time, state, parameters], [ca.densify(entries)])
    evaluated = function.map(len(t))(t[None, :], x.T, np.tile(p[:, None], len(t)))
    values[:, path] = np.array(evaluated).reshape(len(path), len(t)).T
    return values


def add_guards(
    guards: Sequence[Guard],
    phases: Sequence[Phase],
    layouts: Sequence[PhaseLayout],
    columns: ScalarTable,
    rows: ScalarTable,
    linear: Triplets,
    scatters: Sequence[Triplets],
    outputs: Sequence[int],
) -> list[Block]:
    """Add the guards' rows, and states for path rows; ``scatters`` and ``outputs`` are of the phases' blocks."""
    # A row's places are those of one block: a block for each would be differentiated and called one by one.
    alike: dict[tuple[Any, ...], list[tuple[Guard, _Place]]] = {}
    for guard in guards:
        phase, layout = phases[guard.phase], layouts[guard.phase]
        constraint = phase.bound_constraints[guard.constraint]
        row = constraint.rows[guard.row]
        if isinstance(layout.scheme, OneStep):
            continue
        interval = layout.intervals[guard.interval]
        fraction = np.array([interval.start + interval.length * guard.tau])
        entry = Entry(guard.phase, row.name, row.joint or "", row.unit)
        tau = interval.clock.start + interval.clock.length * guard.tau
        scatter, width = scatters[guard.phase], outputs[guard.phase]
        if row.variable is not None:
            component = [s.name for s in phase.dae.states].index(row.variable)
            at = rows.add([entry], fraction, row.lower, row.upper)[0]
            _polynomial(at, np.array([component]), phase, interval, guard.tau, linear, scatter, width)
            continue
        states = columns.add(entries_of(guard.phase, phase.dae.states), fraction)[0]
        defects = [Entry(guard.phase, "state between collocation points", s.label, s.unit) for s in phase.dae.states]
        at = rows.add(defects, fraction, 0.0, 0.0)[0]
        linear.add(at, states, -1.0)
        _polynomial(at, np.arange(len(states)), phase, interval, guard.tau, linear, scatter, width)
        shared = interval_scalars(layout, guard.interval)
        free = np.array([c.column for c in shared if c.column is not None], dtype=int)
        fixed = [c.value for c in shared if c.column is None]
        path = rows.add([entry], fraction, row.lower, row.upper)[0]
        place = _Place(np.concatenate([states, free]), np.array([tau, *fixed]), path)
        kind = guard.phase, guard.constraint, guard.row, tuple(c.column is None for c in shared)
        alike.setdefault(kind, []).append((guard, place))
    blocks = [_path_block(group[0][0], phases, layouts, [place for _, place in group]) for group in alike.values()]
    for i, (phase, layout) in enumerate(zip(phases, layouts, strict=True)):
        shot = [(g.interval, g.tau, g.constraint, g.row) for g in guards if g.phase == i]
        if shot and isinstance(layout.scheme, OneStep):
            from robotraj.transcription.shooting.constraint_generation import shot_guards

            blocks += shot_guards(phase, i, layout, shot, rows)
    return blocks


class _Place(NamedTuple):
    """Columns and constants that a path row reads at a guard, and the row."""

    columns: Indices
    constants: np.ndarray
    row: Indices


def _path_block(guard: Guard, phases: Sequence[Phase], layouts: Sequence[PhaseLayout], places: list[_Place]) -> Block:
    """Block of a path row at the guards that are like ``guard`` in all but their interval and tau."""
    phase = phases[guard.phase]
    constraint = phase.bound_constraints[guard.constraint]
    s = point_symbols(phase, interval_scalars(layouts[guard.phase], guard.interval))
    point = phase.dae.point(s.t, s.x, s.z, s.u, s.p, phase.parameter_names)
    value = as_rows(constraint.expression(point), f"expression of {constraint.name!r}")[guard.row]
    kept = ca.vertcat(s.x, s.unknowns[s.x.numel() + s.z.numel() + s.u.numel() :])
    columns, constants, rows = (np.array(part) for part in zip(*places, strict=True))
    return repeated(kept, s.constants, value, columns, constants, rows)


def _polynomial(
    at: Indices,
    components: Indices,
    phase: Phase,
    interval: IntervalLayout,
    tau: float,
    linear: Triplets,
    scatter: Triplets,
    width: int,
) -> None:
    """Add x(tau) of the interval's polynomial to rows ``at``."""
    linear.add(at, interval.left[components], 1.0)
    weights = integrals(interval.scheme.nodes, np.array([tau]))[0]
    for place, weight in zip(interval.places, weights, strict=True):
        scatter.add(at, place * width + components, interval.clock.length * weight)
    held, nodes = len(phase.dae.invariants), interval.scheme.nodes
    if held:
        first = width - held - len(phase.dae.states)
        shares = correction_basis(nodes, np.array([tau]))[0]
        for place, share in zip(interval.places[nodes > 0.0], shares, strict=True):
            scatter.add(at, place * width + first + components, share)
