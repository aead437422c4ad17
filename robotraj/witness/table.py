"""A report as text that a person reads."""

from __future__ import annotations

import io
import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console, Group

from robotraj.witness.contact_table import contacts
from robotraj.witness.drift import Drift
from robotraj.witness.layout import WIDTH, columns_of, worst_of
from robotraj.witness.peak import Peak

if TYPE_CHECKING:
    from robotraj.witness.report import Report


def render(report: Report) -> str:
    """Lay out the local error, tracking, drift, broken bounds, residuals and energy, and the verdict."""
    stream = io.StringIO()
    console = Console(file=stream, width=WIDTH, color_system=None, highlight=False, markup=False)
    phases = ", ".join(repr(name) for name in report.phases)
    console.print(f"Validation of {phases}: {report.duration:.6g} s, {report.intervals} intervals")
    if report.local is not None:
        title = "  local error: parts of the plan simulated one by one"
        console.print(_drift(title, report.local, report.tolerances.local))
    if report.closed_loop is not None:
        console.print(_tracking(report))
    if report.drift is not None:
        stiff = "" if report.stiff is None else f"; LSODA from t = {report.stiff:.4g} s on, where it is stiff"
        console.print(_drift(f"  open-loop drift{stiff}", report.drift, report.tolerances.drift))
    console.print(_violations(report) or "  limits and constraints: none broken, at or between the knots\n")
    if report.holdings:
        console.print(contacts(report))
    console.print(_residual(report))
    console.print(_closing(report))
    return "\n".join(line.rstrip() for line in stream.getvalue().rstrip().splitlines())


def _tracking(report: Report) -> Group:
    loop = report.closed_loop
    assert loop is not None
    lines: list[Any] = []
    if loop.error is None:
        lines.append(textwrap.fill(f"  tracking was not simulated: {loop.reason}", WIDTH, subsequent_indent="    "))
    else:
        lines.append(_drift("  deviation with feedback (solution.gains)", loop.error, report.tolerances.tracking))
    if loop.growth is not None:
        lines.append(f"  without feedback a small error grows by a factor of {loop.growth:.2g}")
    return Group(*lines, "")


def _drift(title: str, drift: Drift, tolerance: float | None) -> Group:
    rows, left_out = worst_of(drift.rows, lambda row: row.relative)
    table = columns_of("state", "final", "largest", "at t [s]", "allowed", "unit")
    for row in rows:
        allowed = np.inf if tolerance is None else tolerance * row.scale
        mark = " !" if row.largest > allowed else ""
        table.add_row(
            row.name + mark,
            f"{row.final:.2e}",
            f"{row.largest:.2e}",
            f"{row.time:.4f}",
            "" if tolerance is None else f"{allowed:.1e}",
            row.unit,
        )
    return Group(title + left_out, table, "")


def _violations(report: Report) -> Group | None:
    if not report.violations:
        return None
    rows, left_out = worst_of(report.violations, lambda v: v.amount)
    title = f"  limits and constraints broken, {report.tolerances.limits:.1e} allowed{left_out}"
    table = columns_of("row", "by", "limit", "unit", "at t [s]", "phase")
    for v in rows:
        mark = " !" if v.amount > report.tolerances.limits else ""
        about = f"{v.name}, {v.joint}" if v.joint else v.name
        table.add_row(about + mark, f"{v.amount:.2e}", f"{v.limit:.6g}", v.unit, f"{v.time:.4f}", v.phase)
    return Group(title, table, "")


def _residual(report: Report) -> Group:
    dynamics, rate = report.residual.dynamics, report.residual.rate
    names = list(dict.fromkeys([*dynamics, *rate]))
    shown, left_out = worst_of(names, lambda name: max(_value(dynamics.get(name)), _value(rate.get(name))))
    jump = max(report.residual.jumps.values(), key=lambda peak: peak.value, default=None)
    most = (
        "none" if jump is None else f"{jump.value:.1e} {jump.unit}".rstrip() + f", {jump.name}, t = {jump.time:.4g} s"
    )
    title = f"  largest jump at a knot: {most}\n  largest defect of the equations{left_out}"
    table = columns_of("of", "dynamics", "unit", "at t [s]", "rate", "unit", "at t [s]")
    for name in shown:
        table.add_row(name, *_cells(dynamics.get(name)), *_cells(rate.get(name)))
    return Group(title, table, "")


def _value(peak: Peak | None) -> float:
    return 0.0 if peak is None else peak.value


def _cells(peak: Peak | None) -> tuple[str, str, str]:
    return ("", "", "") if peak is None else (f"{peak.value:.2e}", peak.unit, f"{peak.time:.4f}")


def _closing(report: Report) -> str:
    lines = []
    energy = report.energy
    if energy is not None:
        lines.append(
            f"  energy: work in {energy.work:.6g} J - dissipated {energy.dissipated:.6g} J - "
            f"change {energy.change:.6g} J = {energy.imbalance:.2e} J"
            f"\n          ({energy.relative:.1e} of the energy that moved)"
        )
    verdict = "PASSED" if report.passed else "FAILED"
    lines += [
        textwrap.fill(complaint, WIDTH, initial_indent="  ! ", subsequent_indent="    ")
        for complaint in report.complaints(report.tolerances)
    ]
    lines.append(f"{verdict} in {report.seconds:.2g} s of processor time")
    return "\n".join(lines)
