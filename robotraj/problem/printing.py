"""A phase as text: every row, bound and unit that it imposes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj.problem.constraints.base import Row, Where
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.feasibility import Ends
from robotraj.problem.rows import RowTable

Line = tuple[str, str, str, str, str]
"""Quantity, what has it, when, bounds and unit."""


def phase_text(
    table: RowTable, subject: str, objective: str, duration: tuple[float, float], ends: Ends, parameters: Sequence[Row]
) -> str:
    """Write a phase as two headlines and a table of quantity, joint or variable, time, bounds and unit.

    Parameters
    ----------
    table : RowTable
    subject : str
        Name of what moves.
    objective : str
        What is minimised.
    duration : (float, float)
        Least and greatest duration [s].
    ends : mapping of Where to Bounds
        Bounds of the state at the start and at the end.
    parameters : sequence of Row
        One row a parameter.
    """
    dae = table.dae
    lines: list[Line] = [("duration", "", "", _interval(*duration), "s")]
    lines += [line for end, bounds in ends.items() for line in _end(table, end, bounds)]
    lines += [(r.name, r.joint or "", r.where.value, _interval(r.lower, r.upper), r.unit) for r in table]
    lines += [(r.quantity, r.label, "throughout", "= 0", r.unit) for r in dae.residuals]
    lines += [("defect", s.name, "throughout", "= 0", s.unit) for s in dae.states]
    lines += [(r.name, r.joint or "", "", _interval(r.lower, r.upper), r.unit) for r in parameters]
    widths = [max(len(line[i]) for line in lines) for i in range(5)]
    written = [
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines
    ]
    sizes = f"{len(dae.states)} states, {len(dae.algebraic)} algebraic, {len(dae.controls)} controls"
    return "\n".join([f"phase {table.phase!r} of {subject}: {sizes}", f"minimise {objective}", *written])


def _end(table: RowTable, end: Where, bounds: Bounds) -> list[Line]:
    """Write the bounds of the state at one end."""
    return [
        (variable.quantity, variable.label, end.value, _interval(lower, upper), variable.unit)
        for variable, lower, upper in zip(table.dae.states, bounds.lower, bounds.upper, strict=True)
    ]


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


def _number(value: float) -> str:
    return f"{value:.6g}"
