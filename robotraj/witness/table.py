"""A report as text that a person reads."""

from __future__ import annotations

import io
import textwrap
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console, Group

from robotraj.witness.contact_table import contacts
from robotraj.witness.layout import WIDTH, columns_of, worst_of
from robotraj.witness.peak import Peak

if TYPE_CHECKING:
    from robotraj.witness.report import Report


def render(report: Report) -> str:
    """Lay out the verdict, the drift, the broken bounds, the residuals and the energy balance."""
    stream = io.StringIO()
    console = Console(file=stream, width=WIDTH, color_system=None, highlight=False, markup=False)
    verdict = "PASSED" if report.passed else "FAILED"
    phases = ", ".join(repr(name) for name in report.phases)
    method = "DOP853" if report.stiff is None else f"DOP853; LSODA from t = {report.stiff:.4g} s on, where it is stiff"
    console.print(
        f"Forward simulation of {phases}: {verdict}\n"
        f"  {report.duration:.6g} s, {report.intervals} intervals, open loop under the planned controls "
        f"({method}, rtol {report.rtol:.0e}, restarted at knots)"
    )
    for complaint in report.complaints(report.tolerances):
        console.print(textwrap.fill(complaint, WIDTH, initial_indent="  ! ", subsequent_indent="    "))
    console.print(_drift(report))
    if report.restarted is not None:
        row = report.restarted.worst
        console.print(
            f"  each phase from its own first state: {row.name} by {row.largest:.2e} {row.unit} in {row.phase!r},"
            f" t = {row.time:.4g} s\n"
        )
    console.print(_violations(report) or "  limits and constraints: none broken, at or between the knots\n")
    if report.holdings:
        console.print(contacts(report))
    console.print(_residual(report))
    console.print(_closing(report))
    return "\n".join(line.rstrip() for line in stream.getvalue().rstrip().splitlines())


def _drift(report: Report) -> Group:
    rows, left_out = worst_of(report.drift.rows, lambda row: row.relative)
    title = f"  drift: |simulated - planned|{left_out}"
    table = columns_of("state", "final", "largest", "at t [s]", "allowed", "unit")
    for row in rows:
        allowed = np.inf if report.tolerances.drift is None else report.tolerances.drift * row.scale
        mark = " !" if row.largest > allowed else ""
        table.add_row(
            row.name + mark,
            f"{row.final:.2e}",
            f"{row.largest:.2e}",
            f"{row.time:.4f}",
            f"{allowed:.1e}",
            row.unit,
        )
    return Group(title, table, "")


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
    title = (
        f"  largest jump of the planned polynomials at a knot: {most}\n"
        f"  largest defect of the equations along the planned polynomials{left_out}"
    )
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
    tolerances = report.tolerances
    judged = [] if tolerances.drift is None else [f"drift {tolerances.drift:.1e}"]
    judged += [f"limits {tolerances.limits:.1e}"]
    if report.restarted is not None:
        judged += [] if tolerances.phase_drift is None else [f"drift of a phase {tolerances.phase_drift:.1e}"]
        judged += [] if tolerances.contact is None else [f"contact {tolerances.contact:.1e} m"]
        judged += [] if tolerances.forces is None else [f"forces {tolerances.forces:.1e} of the weight"]
    judged += [f"energy {tolerances.energy:.1e}"] if tolerances.energy is not None else []
    judged += [f"residual {tolerances.residual:.1e}"] if tolerances.residual is not None else []
    lines.append(textwrap.fill(f"  judged by: {', '.join(judged)}", WIDTH, subsequent_indent="    "))
    return "\n".join(lines)
