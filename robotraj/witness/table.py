"""A report as text that a person reads, 80 columns wide, the verdict last."""

from __future__ import annotations

import io
import os
import sys
import textwrap
from collections.abc import Sequence

from rich.console import Console, Group

from robotraj.witness.contacts.table import contacts
from robotraj.witness.figures import Figures
from robotraj.witness.layout import WIDTH, columns_of, worst_of
from robotraj.witness.peak import Peak
from robotraj.witness.simulation.drift import Drift, DriftRow

COLOURS = {"PASSED": "\x1b[32m", "FAILED": "\x1b[31m"}


def coloured(verdict: str) -> str:
    """Colour a verdict where standard output is a terminal; the variable NO_COLOR forbids it."""
    if not sys.stdout.isatty() or os.environ.get("NO_COLOR"):
        return verdict
    return f"{COLOURS[verdict]}{verdict}\x1b[0m"


def render(figures: Figures, complaints: Sequence[str], verdict: str) -> str:
    """Lay out the motion by state, broken bounds, contacts, residuals and energy, then what is wrong, and the verdict.

    Parameters
    ----------
    complaints : sequence of str
        What is wrong, in sentences.
    verdict : str
        As it is to be printed.
    """
    stream = io.StringIO()
    console = Console(file=stream, width=WIDTH, color_system=None, highlight=False, markup=False)
    phases = ", ".join(repr(name) for name in figures.phases)
    console.print(f"Validation of {phases}: {figures.duration:.6g} s, {figures.intervals} intervals")
    console.print(_motion(figures))
    console.print(_violations(figures) or "  limits and constraints: none broken, at or between the knots\n")
    if figures.holdings:
        console.print(contacts(figures.holdings, figures.impacts, figures.landings, figures.tolerances))
    console.print(_residual(figures))
    for line in (*_energy(figures), *_unseen(figures)):
        console.print(line)
    for complaint in complaints:
        console.print(textwrap.fill(complaint, WIDTH, initial_indent="  ! ", subsequent_indent="    "))
    lines = [line.rstrip() for line in stream.getvalue().rstrip().splitlines()]
    return "\n".join([*lines, f"{verdict} in {figures.seconds:.2g} s of processor time"])


def _motion(figures: Figures) -> Group:
    """Local error, deviation with feedback and open-loop drift of every state, side by side."""
    loop = figures.closed_loop
    tracked = None if loop is None else loop.error
    parts = ((figures.local, figures.tolerances.local), (tracked, figures.tolerances.tracking), (figures.drift, None))
    shown = next((drift for drift, _ in parts if drift is not None), None)
    notes = _notes(figures)
    if shown is None:
        return Group(*notes, "")
    rows, left_out = worst_of(
        shown.rows, lambda row: max(_share(drift, row.name, tolerance) for drift, tolerance in parts)
    )
    table = columns_of("state", "local", "allowed", "tracking", "allowed", "open loop", "unit")
    for row in rows:
        cells = [cell for drift, tolerance in parts[:2] for cell in _cells_of(drift, row.name, tolerance)]
        table.add_row(row.name, *cells, _cells_of(figures.drift, row.name, figures.tolerances.drift)[0], row.unit)
    title = f"  largest |simulated - planned|{left_out}, for short parts alone (local),"
    return Group(title, "  with feedback by solution.gains (tracking) and without it (open loop)", table, *notes, "")


def _row(drift: Drift | None, name: str) -> DriftRow | None:
    return drift[name] if drift is not None and name in drift else None


def _share(drift: Drift | None, name: str, tolerance: float | None) -> float:
    """Part of its tolerance that a state uses; what is not judged is compared as it is."""
    row = _row(drift, name)
    return 0.0 if row is None else row.relative / (1.0 if tolerance is None else tolerance)


def _cells_of(drift: Drift | None, name: str, tolerance: float | None) -> tuple[str, str]:
    row = _row(drift, name)
    if row is None:
        return "", ""
    if tolerance is None:
        return f"{row.largest:.1e}", ""
    mark = "" if row.relative <= tolerance else " !"
    return f"{row.largest:.1e}{mark}", f"{tolerance * row.scale:.1e}"


def _notes(figures: Figures) -> list[str]:
    loop = figures.closed_loop
    notes = []
    if loop is not None and loop.reason is not None:
        notes.append(f"tracking was not simulated to the end: {loop.reason}")
    if loop is not None and loop.growth is not None:
        notes.append(f"without feedback a small error grows by a factor of up to {loop.growth:.2g}: that is drift")
    if figures.stiff is not None:
        notes.append(f"the motion is stiff: implicit steps simulate it from t = {figures.stiff:.4g} s on")
    if figures.failure is not None:
        notes.append(f"open loop, the simulation stopped: {figures.failure}")
    return [textwrap.fill(note, WIDTH, initial_indent="  ", subsequent_indent="    ") for note in notes]


def _violations(figures: Figures) -> Group | None:
    if not figures.violations:
        return None
    rows, left_out = worst_of(figures.violations, lambda v: v.relative)
    title = f"  limits and constraints broken, {figures.tolerances.limits:.1e} of their range is allowed{left_out}"
    table = columns_of("row", "by", "limit", "unit", "at t [s]", "phase")
    for v in rows:
        about = f"{v.name}, {v.joint}" if v.joint else v.name
        table.add_row(f"{about} !", f"{v.amount:.2e}", f"{v.limit:.6g}", v.unit, f"{v.time:.4f}", v.phase)
    return Group(title, table, "")


def _residual(figures: Figures) -> Group:
    dynamics, rate = figures.residual.dynamics, figures.residual.rate
    names = list(dict.fromkeys([*dynamics, *rate]))
    shown, left_out = worst_of(names, lambda name: max(_value(dynamics.get(name)), _value(rate.get(name))))
    jump = max(figures.residual.jumps.values(), key=lambda peak: peak.value, default=None)
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


def _energy(figures: Figures) -> list[str]:
    energy = figures.energy
    if energy is None:
        return []
    return [
        f"  energy: work in {energy.work:.6g} J - dissipated {energy.dissipated:.6g} J",
        f"          - change {energy.change:.6g} J = {energy.imbalance:.2e} J, "
        f"{energy.relative:.1e} of the energy that moved",
    ]


def _unseen(figures: Figures) -> list[str]:
    if not figures.unseen:
        return []
    return [textwrap.fill(f"  no time for: {', '.join(figures.unseen)}", WIDTH, subsequent_indent="    ")]
