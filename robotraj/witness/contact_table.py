"""The contacts and impacts of a report as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Group

from robotraj.witness.holding import Holding, part_of
from robotraj.witness.impact import Impact
from robotraj.witness.layout import columns_of, worst_of

if TYPE_CHECKING:
    from robotraj.witness.report import Report


def contacts(report: Report) -> Group:
    """Lay out how far every contact moves, which rows its forces break, and the impacts."""
    weight = max(holding.weight for holding in report.holdings)
    rows, left_out = worst_of(report.holdings, lambda h: max(h.slip.value, h.sink.value, h.turn.value))
    title = (
        f"  contacts between the knots, forces as parts of the weight of {weight:.4g} N{left_out}\n"
        "  (down: where the simulation through all phases set the contact down, from the planned place)"
    )
    table = columns_of("contact", "phase", "slip [m]", "at t [s]", "sink [m]", "at t [s]", "turn [rad]", "down [m]")
    down = {(landing.contact, landing.phase): landing.distance for landing in report.landings}
    for h in rows:
        most = max(h.slip.value, h.sink.value, h.turn.value)
        mark = " !" if report.tolerances.contact is not None and most > report.tolerances.contact else ""
        where = down.get((h.contact, h.phase))
        table.add_row(
            h.contact + mark,
            h.phase,
            f"{h.slip.value:.2e}",
            f"{h.slip.time:.4f}",
            f"{h.sink.value:.2e}",
            f"{h.sink.time:.4f}",
            f"{h.turn.value:.2e}",
            "" if where is None else f"{where:.2e}",
        )
    held = "  normal force, friction and centre of pressure: none broken, at or between the knots"
    rows_of_forces = _forces(report) or held
    impacts = [line for impact in report.impacts for line in _impact(impact)]
    moved = max(report.landings, key=lambda landing: landing.moved, default=None)
    kept = "" if moved is None else f"  in the simulation a contact moves by {moved.moved:.1e} m at most while it holds"
    return Group(title, table, "", kept, rows_of_forces, *_differences(report.holdings), *impacts, "")


def _forces(report: Report) -> Group | None:
    """Rows that the forces of contacts and impacts break, as a table."""
    broken = [(v, part_of(v, h.weight)) for h in report.holdings for v in (*h.planned, *h.solved)]
    broken += [(v, part_of(v, impact.scale)) for impact in report.impacts for v in impact.broken]
    if not broken:
        return None
    rows, left_out = worst_of(broken, lambda pair: pair[1])
    allowed = report.tolerances.forces
    title = f"  what the ground cannot give, as a part of the weight or of the impulse{left_out}"
    table = columns_of("row", "by", "unit", "part", "at t [s]", "phase")
    for v, part in rows:
        mark = " !" if allowed is not None and part > allowed else ""
        cells = (f"{v.amount:.2e}", v.unit, f"{part:.1e}", f"{v.time:.4f}", v.phase)
        table.add_row(f"{v.name}, {v.joint}{mark}", *cells)
    return Group(title, table, "")


def _differences(holdings: tuple[Holding, ...]) -> list[str]:
    known = [(h, h.difference) for h in holdings if h.difference is not None]
    shared = sorted({h.contact for h in holdings if h.difference is None})
    lines = []
    if known:
        holding, peak = max(known, key=lambda pair: pair[1].value)
        where = f"{holding.contact}, t = {peak.time:.4g} s"
        lines.append(f"  planned forces and those the equations give differ by {peak.value:.2e} N at most, {where}")
    if shared:
        lines.append(f"  forces that the equations leave open, as planned: {', '.join(shared)}")
    return lines


def _impact(impact: Impact) -> list[str]:
    sizes = ", ".join(f"{name.removeprefix('impulse.')} {value:.4g}" for name, value in impact.impulses.items())
    return [
        f"  {impact.link} at t = {impact.time:.4g} s: {sizes} N s, takes {impact.lost:.4g} J",
        f"    momentum off by {impact.momentum.value:.1e} N s, contacts move on at {impact.rest.value:.1e} "
        f"{impact.rest.unit}",
    ]
