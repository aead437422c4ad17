"""A phase as text and as HTML, with every row, bound and unit."""

from __future__ import annotations

import html
from collections.abc import Sequence

import numpy as np

from robotraj._util.printing import OneLine, table, wrapped
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import Design
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import Where
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.feasibility import Ends
from robotraj.problem.rows import RowTable

Cells = tuple[str, str, str, str, str]
"""Quantity, joint or variable, time, bounds and unit."""

LABELS = 24
"""Most characters of names that share a line; more names are counted."""
HEADINGS = ("quantity", "joint or variable", "when", "bounds", "unit")


@dataclass(frozen=True, eq=False)
class PhaseTable(OneLine):
    """Two headlines and a table of quantity, joint or variable, time, bounds and unit.

    Attributes
    ----------
    title : str
        ``"phase 'swing' of cartpole: 4 states, 2 algebraic, 1 controls"``.
    objective : str
        The objective as text.
    cells : tuple of Cells
    """

    title: str
    objective: str
    cells: tuple[Cells, ...]

    def __str__(self) -> str:
        return self._text(self.cells)

    @property
    def grouped(self) -> str:
        """The text in which rows of one quantity, time and bounds share a line."""
        groups: dict[tuple[str, ...], list[Cells]] = {}
        for cell in self.cells:
            quantity, _, when, bounds, unit = cell
            # Zero is the same in every unit.
            groups.setdefault((quantity, when, bounds, "" if bounds == "= 0" else unit), []).append(cell)
        return self._text([_shared(alike) for alike in groups.values()])

    def _text(self, cells: Sequence[Cells]) -> str:
        return "\n".join([*wrapped(self.title), *wrapped(f"minimise {self.objective}"), *table(cells)])

    @property
    def html(self) -> str:
        """The table for a notebook."""
        head = "".join(f"<th>{heading}</th>" for heading in HEADINGS)
        body = "".join(
            "<tr>" + "".join(f"<td style='text-align:left'>{html.escape(cell)}</td>" for cell in row) + "</tr>"
            for row in self.cells
        )
        return (
            f"<div><b>{html.escape(self.title)}</b><br>minimise {html.escape(self.objective)}"
            f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
        )


def phase_table(
    rows: RowTable, subject: str, objective: str, duration: tuple[float, float], ends: Ends, more: Sequence[Row]
) -> PhaseTable:
    """Tabulate a phase.

    Parameters
    ----------
    rows : RowTable
    subject : str
        Name of the robot or System.
    objective : str
        The objective as text.
    duration : (float, float)
        Least and greatest duration [s].
    ends : mapping of Where to Bounds
        Bounds of the state at the start and at the end.
    more : sequence of Row
        One row for each parameter and for each obstacle.
    """
    dae = rows.dae
    cells: list[Cells] = [("duration", "", "", interval_text(*duration), "s")]
    cells += [line for end, bounds in ends.items() for line in _end(rows, end, bounds)]
    for row in rows:
        interval = interval_text(row.shown(row.lower), row.shown(row.upper))
        cells.append((row.name, row.joint or "", row.where.value, interval, row.shown_unit))
    cells += [(r.quantity, r.label, "throughout", "= 0", r.unit) for r in dae.residuals]
    cells += [("defect", s.name, "throughout", "= 0", s.unit) for s in dae.states]
    cells += [(r.name, r.joint or "", "", interval_text(r.lower, r.upper), r.unit) for r in more]
    sizes = f"{len(dae.states)} states, {len(dae.algebraic)} algebraic, {len(dae.controls)} controls"
    return PhaseTable(f"phase {rows.phase!r} of {subject}: {sizes}", objective, tuple(cells))


def parameter_rows(names: Sequence[str], bounds: Bounds, design: Design | None) -> list[Row]:
    """Return one row for each parameter; a parameter of the design is described by the quantities that it sets."""
    rows = []
    for name, low, high in zip(names, *bounds, strict=True):
        what, unit = design.describe(name) if design is not None else ("", "")
        rows.append(Row("parameter", unit, low, high, f"{name} ({what})" if what else name))
    return rows


def duration_text(low: float, high: float) -> str:
    """Return ``"2 s"`` or ``"0.5 to 3 s"``."""
    return f"{_number(low)} s" if low == high else f"{_number(low)} to {_number(high)} s"


def interval_text(low: float, high: float) -> str:
    """Return ``"= 0"``, ``"0 .. 1"``, ``"<= 1"``, ``">= 0"`` or ``"free"``."""
    if low == high:
        return f"= {_number(low)}"
    if np.isinf(low) and np.isinf(high):
        return "free"
    if np.isinf(low):
        return f"<= {_number(high)}"
    if np.isinf(high):
        return f">= {_number(low)}"
    return f"{_number(low)} .. {_number(high)}"


def _end(table: RowTable, end: Where, bounds: Bounds) -> list[Cells]:
    """List the bounds of the state at one end."""
    return [
        (variable.quantity, variable.label, end.value, interval_text(lower, upper), variable.unit)
        for variable, lower, upper in zip(table.dae.states, bounds.lower, bounds.upper, strict=True)
    ]


def _shared(alike: Sequence[Cells]) -> Cells:
    """Return one line for rows that differ in their joint or variable alone, or in the unit of a zero."""
    quantity, _, when, bounds, _ = alike[0]
    names = list(dict.fromkeys(cell[1] for cell in alike))
    label = ", ".join(names)
    if len(label) > LABELS:
        label = names[0] + (f" (+{len(names) - 1})" if len(names) > 1 else "")
    units = {cell[4] for cell in alike}
    return quantity, label, when, bounds, units.pop() if len(units) == 1 else ""


def _number(value: float) -> str:
    return f"{value + 0.0:.6g}"  # no negative zero
