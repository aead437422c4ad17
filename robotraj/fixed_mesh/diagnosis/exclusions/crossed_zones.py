"""Zones that one state must cross: a row of that state alone forbids values between its start and its end.

A state is continuous. Between x_0 and x_1 it takes every value, so that no motion meets l <= c(x) <= u if one of these
values violates it. Between the points of a mesh a motion may seem to jump over the zone.
"""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca
import numpy as np

from robotraj._util.precision import MET
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import Kind, PhaseRow
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict

VALUES = 2001
"""Number of values between the start and the end at which rows are evaluated."""


def crossed_zones(problem: Problem) -> tuple[Conflict, ...]:
    """Return the rows that forbid values which a state must take, the largest relative violation first."""
    found = [
        conflict
        for phase in problem.phases
        for row, state in _rows_of_one_state(phase)
        if (conflict := _crossing(phase, row, state)) is not None
    ]
    return tuple(sorted(found, key=lambda conflict: -conflict.relative))


def _rows_of_one_state(phase: Phase) -> Iterator[tuple[PhaseRow, int]]:
    """Yield the path rows that depend on a single state and on nothing else, with the state's index."""
    t, x, z, u, p = phase.rows.symbols
    others, size = ca.vertcat(t, z, u, p), len(phase.body.states)
    rows = [row for row in phase.rows.of_state if row.kind is not Kind.BOUND]
    if not rows:
        return
    column = ca.vertcat(*phase.rows.expressions(rows))
    of_states, of_others = (ca.DM.ones(ca.jacobian_sparsity(column, each)).full() for each in (x, others))
    for k, row in enumerate(rows):
        read = np.flatnonzero(of_states[k])
        if len(read) == 1 and read[0] < size and not of_others[k].any():
            yield row, int(read[0])


def _crossing(phase: Phase, row: PhaseRow, state: int) -> Conflict | None:
    """Return the worst violation of a row between the ends of a state; None where there is none."""
    (low, high), (start, end) = ([float(b) for b in each[:, state]] for each in _ends(phase))
    first, last = (high, start) if high < start else (end, low)
    if not (high < start or end < low):
        return None
    table = phase.rows
    values = np.linspace(first, last, VALUES)
    sizes = (len(table.dae.states), len(table.dae.algebraic), len(table.dae.controls))
    x, z, u = (np.zeros((VALUES, size)) for size in sizes)
    x[:, state] = values
    found = table.sample((row,), np.zeros(VALUES), x, z, u, np.zeros(len(table.parameters)))[:, 0]
    excess = np.maximum(row.lower - found, found - row.upper)
    worst = int(np.argmax(np.where(np.isfinite(excess), excess, -np.inf)))
    size = row.size_in(float(np.ptp(found)))
    if not excess[worst] > MET * size:
        return None
    variable = phase.body.states[state]
    bound = row.upper if found[worst] > row.upper else row.lower
    reason = (
        f"{variable.label} must pass {values[worst]:.4g} {variable.unit}".rstrip()
        + f" on its way between {first:.4g} and {last:.4g}"
    )
    return Conflict(
        phase.name,
        row.label,
        np.nan,
        row.shown(bound),
        row.shown(float(found[worst])),
        row.shown_unit,
        float(excess[worst]) / size,
        False,
        reason,
        True,
    )


def _ends(phase: Phase) -> tuple[np.ndarray, np.ndarray]:
    """Return the bounds (2, n) of the states at the start and at the end."""
    return tuple(np.array([each.lower, each.upper]) for each in (phase.start_bounds, phase.end_bounds))  # type: ignore[return-value]
