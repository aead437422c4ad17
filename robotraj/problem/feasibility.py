"""What cannot hold is refused before solving, by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj.problem.constraints.base import BoundConstraint, Row, Where, symbols_of
from robotraj.problem.constraints.bounds import Bounds
from robotraj.robot.limits import Limits

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase

SLACK = 1e-6
"""How far a given end may lie outside a bound before it is refused: round-off, not an error [SI]."""


def check_phase(phase: Phase) -> None:
    """Raise InputError for the first thing that makes the phase impossible."""
    if isinstance(phase.limits, Limits):
        complaints = _complaints(phase, phase.limits)
        if complaints:
            raise InputError(f"Phase {phase.name!r}: " + " ".join(complaints))
    _ = phase.parameter_bounds, phase.duration_bounds
    if phase.system is not None:
        _check_equations(phase)
    held = {which: _rows_on_states(phase, when) for which, when in (("start", Where.START), ("end", Where.END))}
    _check_against_each_other(phase, held)
    for which, bounds in (("start", phase.start_bounds), ("end", phase.end_bounds)):
        crossed = np.flatnonzero(bounds.lower > bounds.upper)
        if crossed.size:
            name = phase.dae.states[crossed[0]].label
            raise InputError(f"Phase {phase.name!r}: the {which} of {name!r} has its lower bound above its upper one.")
        _check_against_limits(phase, which, bounds, held[which])
        _check_expressions(phase, which, bounds)
    _check_contacts(phase)
    _check_duration(phase)


def _check_equations(phase: Phase) -> None:
    """Evaluate the equations of a System once; those that a file could not keep are not there."""
    from robotraj.dynamics.missing import MissingEquations

    assert phase.system is not None
    if not isinstance(phase.system.dynamics, MissingEquations):
        point = symbols_of(phase.dae, phase.parameter_names)
        _ = phase.dae.rates(point), phase.dae.residual(point)


def _complaints(phase: Phase, limits: Limits) -> list[str]:
    """List the limits' own complaints about joints that must move: a joint without a motor may have no effort."""
    return list(limits.complaints(phase.robot.actuated)) if phase.robot else []


def _rows_on_states(phase: Phase, when: Where) -> dict[str, list[Row]]:
    """Rows that are single variables, by variable: those held throughout and those held at ``when``."""
    rows: dict[str, list[Row]] = {}
    for constraint in phase.bound_constraints:
        for row in constraint.rows:
            if row.lower > row.upper:
                raise InputError(
                    f"Phase {phase.name!r}: {row.label} has its lower bound {row.lower:g} above its upper bound "
                    f"{_with(f'{row.upper:g}', row.unit)}."
                )
            if row.variable is not None and constraint.where in (Where.THROUGHOUT, when):
                rows.setdefault(row.variable, []).append(row)
    return rows


def _range(row: Row) -> str:
    """Write the bounds of a row, with its unit."""
    return _with(f"[{row.lower:g}, {row.upper:g}]", row.unit)


def _with(value: str, unit: str) -> str:
    """Write a value with its unit, where it has one."""
    return f"{value} {unit}" if unit else value


def _check_against_each_other(phase: Phase, held: Mapping[str, Mapping[str, list[Row]]]) -> None:
    """Two rows on one variable must leave it a value."""
    for rows in (rows for at in held.values() for rows in at.values() if len(rows) > 1):
        lowest = max(rows, key=lambda row: row.lower)
        highest = min(rows, key=lambda row: row.upper)
        if lowest.lower > highest.upper:
            raise InputError(
                f"Phase {phase.name!r}: {lowest.label} {_range(lowest)} and {highest.label} {_range(highest)} "
                "contradict each other; relax one of them."
            )


def _check_against_limits(phase: Phase, which: str, bounds: Bounds, rows: Mapping[str, list[Row]]) -> None:
    for variable, low, high in zip(phase.dae.states, bounds.lower, bounds.upper, strict=True):
        for row in rows.get(variable.name, ()):
            slack = SLACK * max(1.0, abs(row.lower) if np.isfinite(row.lower) else 1.0)
            if low > row.upper + slack or high < row.lower - slack:
                value = f"{low:g}" if low == high else f"[{low:g}, {high:g}]"
                raise InputError(
                    f"Phase {phase.name!r}: the {which} {variable.quantity} of {variable.label!r} is "
                    f"{_with(value, variable.unit)}, outside its {row.name} {_range(row)}. "
                    f"Move the {which}, or give other limits."
                )


def _check_expressions(phase: Phase, which: str, bounds: Bounds) -> None:
    """Where the whole state is fixed, evaluate the rows that depend on the state alone."""
    lower, upper = (side[: len(phase.body.states)] for side in bounds)
    if not np.array_equal(lower, upper):
        return
    skipped = (Where.END if which == "start" else Where.START, Where.AT_NODES, Where.INTEGRAL)
    expressions = [
        constraint
        for constraint in phase.bound_constraints
        if constraint.where not in skipped and any(row.variable is None for row in constraint.rows)
    ]
    if not expressions:
        return
    point = symbols_of(phase.body, phase.parameter_names)
    x = ca.vertcat(*(point.x[s.name] for s in phase.body.states))
    for constraint in expressions:
        values = ca.vertcat(*(ca.SX(value) for value in constraint.expression(point)))
        _check_expression(phase, which, constraint, values, x, lower)


def _check_expression(
    phase: Phase, which: str, constraint: BoundConstraint, value: ca.SX, x: ca.SX, at: np.ndarray
) -> None:
    for row, entry in zip(constraint.rows, ca.vertsplit(value), strict=True):
        if row.variable is not None or any(not ca.depends_on(x, s) for s in ca.symvar(entry)):
            continue
        number = float(ca.Function("row", [x], [entry])(at))
        if np.isnan(number):
            raise InputError(f"Phase {phase.name!r}: {row.label} is NaN at the {which}; check its expression.")
        if not row.lower - SLACK <= number <= row.upper + SLACK:
            raise InputError(
                f"Phase {phase.name!r}: at the {which}, {row.label} is {_with(f'{number:.6g}', row.unit)}, outside "
                f"{_range(row)}. Move the {which}, or relax the constraint."
            )


def _check_contacts(phase: Phase) -> None:
    """Refuse a fixed end at which a contact does not hold; it stands where the first fixed configuration puts it."""
    held_at_all = any(contact.holds for contact in phase.bound_contacts)
    if not held_at_all or phase.robot is None or phase.bound_design is not None:
        return
    size, stands = phase.robot.nq, dict(zip(phase.parameter_names, phase.parameter_bounds.lower, strict=True))
    known = [n for n, low, up in zip(phase.parameter_names, *phase.parameter_bounds, strict=True) if low == up]
    rows = phase.body.invariants
    located = False
    for which, bounds in (("start", phase.start_bounds), ("end", phase.end_bounds)):
        fixed = (bounds.lower == bounds.upper)[: len(phase.body.states)]
        if not fixed[:size].all():
            continue
        state = np.where(fixed, bounds.lower[: fixed.size], 0.0)
        if not located:
            found = {k: v for c in phase.bound_contacts for k, v in c.locate(phase.robot, state[:size]).items()}
            stands, located = {**stands, **{k: v for k, v in found.items() if k not in known}}, True
        point = symbols_of(phase.body, phase.parameter_names)
        x, p = (ca.vertcat(ca.SX(0, 1), *named.values()) for named in (point.x, point.p))
        held = phase.body.invariant(point)
        moving = np.array(ca.DM(ca.jacobian_sparsity(held, x), 1.0).full(), dtype=bool) @ ~fixed
        values = np.array(
            ca.Function("held", [x, p], [held])(state, [stands[n] for n in phase.parameter_names])
        ).ravel()
        worst = int(np.argmax(np.where(moving, 0.0, np.abs(values))))
        if not moving[worst] and abs(values[worst]) > SLACK:
            raise InputError(
                f"Phase {phase.name!r}: at the {which}, contact {rows[worst].label!r} does not hold: its row "
                f"{rows[worst].name} is {values[worst]:.3g} {rows[worst].unit} instead of 0. Move the {which}, free "
                "some of it, or end the contact before."
            )


def _check_duration(phase: Phase) -> None:
    """Refuse a joint that must travel further than its speed limit allows in the longest duration."""
    if phase.robot is None or not isinstance(phase.limits, Limits):
        return
    longest = phase.duration_bounds[1]
    start, end = phase.start_bounds, phase.end_bounds
    positions = phase.robot.position_names
    for i, joint in enumerate(phase.robot.velocity_names):
        if joint not in positions:
            continue  # a floating root's velocities are no rates of single positions
        at = positions.index(joint)
        gap = max(end.lower[at] - start.upper[at], start.lower[at] - end.upper[at], 0.0)
        speed = phase.limits.velocity[i]
        if np.isfinite(gap) and gap > speed * longest * (1 + 1e-9):
            unit = phase.robot.units[i]
            raise InputError(
                f"Phase {phase.name!r}: joint {joint!r} must travel {gap:.4g} {unit}, but its velocity limit of "
                f"{speed:.4g} {unit}/s allows {speed * longest:.4g} {unit} in {longest:.4g} s. "
                f"Allow at least {gap / speed:.4g} s."
            )
