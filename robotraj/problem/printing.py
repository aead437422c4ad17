"""Phases as tables: every row, bound and unit that will be imposed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase


def _number(value: float) -> str:
    return f"{value:.6g}"


def _interval(low: float, high: float) -> str:
    if low == high:
        return f"= {_number(low)}"
    if np.isinf(low) and np.isinf(high):
        return "free"
    if np.isinf(low):
        return f"<= {_number(high)}"
    if np.isinf(high):
        return f">= {_number(low)}"
    return f"{_number(low)} .. {_number(high)}"


def _parameter(phase: Phase, name: str, lower: float, upper: float) -> tuple[str, str, str, str, str]:
    """Row of a parameter, with what it is of the robot."""
    what, unit = phase.bound_design.describe(name) if phase.bound_design is not None else ("", "")
    return "parameter", f"{name} ({what})" if what else name, "", _interval(lower, upper), unit


def phase_table(phase: Phase) -> str:
    """Write the phase as a table of what, of whom, when, bounds and unit."""
    dae = phase.dae
    subject = phase.robot.name if phase.robot is not None else phase.subject.name
    low, high = phase.duration_bounds
    rows: list[tuple[str, str, str, str, str]] = [("duration", "", "", _interval(low, high), "s")]
    for when, bounds in (("start", phase.start_bounds), ("end", phase.end_bounds)):
        rows += [
            (variable.quantity, variable.label, when, _interval(lower, upper), variable.unit)
            for variable, lower, upper in zip(dae.states, bounds.lower, bounds.upper, strict=True)
        ]
    rows += [
        (row.name, row.joint or "", constraint.where.value, _interval(row.lower, row.upper), row.unit)
        for constraint in phase.bound_constraints
        for row in constraint.rows
    ]
    rows += [(r.quantity, r.label, "throughout", "= 0", r.unit) for r in dae.residuals]
    rows += [("defect", s.name, "throughout", "= 0", s.unit) for s in dae.states]
    bounds = phase.parameter_bounds
    rows += [
        _parameter(phase, name, lower, upper)
        for name, lower, upper in zip(phase.parameter_names, bounds.lower, bounds.upper, strict=True)
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(5)]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    sizes = f"{len(dae.states)} states, {len(dae.algebraic)} algebraic, {len(dae.controls)} controls"
    objective = str(phase.objective) if phase.objective is not None else "none: any feasible motion"
    return "\n".join([f"phase {phase.name!r} of {subject}: {sizes}", f"minimise {objective}", *lines])
