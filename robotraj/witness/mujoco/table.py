"""A second opinion as text that a person reads."""

from __future__ import annotations

import io
import textwrap
from typing import TYPE_CHECKING

from rich.console import Console

from robotraj.witness.layout import WIDTH, columns_of, worst_of
from robotraj.witness.protocols import Array

if TYPE_CHECKING:
    from robotraj.witness.mujoco.report import SecondOpinion


def render(report: SecondOpinion) -> str:
    """Lay out the verdict, the deviation, the feet and the effort of the feedback."""
    stream = io.StringIO()
    console = Console(file=stream, width=WIDTH, color_system=None, highlight=False, markup=False)
    times = "once" if report.periods == 1 else f"{report.periods} times"
    console.print(f"MuJoCo follows the plan {times}, {report.duration:.6g} s: {_verdict(report)}")
    for line in (report.feedback, f"{report.simulator}, steps of {report.step:.2g} s"):
        console.print(textwrap.fill(line, WIDTH, initial_indent="  ", subsequent_indent="    "))
    if report.lag:
        console.print(
            f"  touchdowns set the clock: {abs(report.lag):.2g} s {'later' if report.lag > 0 else 'sooner'} in all"
        )
    rows, left_out = worst_of(report.deviation.rows, lambda row: row.relative)
    console.print(f"  deviation: |simulated - planned|{left_out}")
    table = columns_of("state", "final", "largest", "at t [s]", "unit")
    for row in rows:
        table.add_row(row.name, f"{row.final:.2e}", f"{row.largest:.2e}", f"{row.time:.4f}", row.unit)
    console.print(table)
    if report.feet:
        table = columns_of("foot", "slip [m]", "sink [m]", "on ground", "stances", "mean force [N]", "planned")
        for foot in report.feet:
            planned = "" if foot.planned is None else _vector(foot.planned)
            table.add_row(
                foot.name,
                f"{foot.slip:.1e}",
                f"{foot.sink:.1e}",
                f"{100 * foot.loaded:.0f} %",
                str(foot.stances),
                _vector(foot.force),
                planned,
            )
        console.print("\n", table, sep="")
    peaks = sorted(report.effort.values(), key=lambda peak: -peak.value)[:3]
    added = ", ".join(f"{p.name} {p.value:.3g} {p.unit}" for p in peaks)
    console.print(
        f"\n  feedback added at most {added}; a motor was at its limit {100 * report.saturated:.1f} % of the time"
    )
    return "\n".join(line.rstrip() for line in stream.getvalue().rstrip().splitlines())


def _verdict(report: SecondOpinion) -> str:
    if report.failure is not None:
        return f"STOPPED: {report.failure}"
    if report.fell is not None:
        return f"FELL at t = {report.fell:.4g} s"
    return "COMPLETED, upright" if report.feet else "COMPLETED"


def _vector(values: Array) -> str:
    return " ".join(f"{value:.1f}" for value in values)
