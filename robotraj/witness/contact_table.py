"""The contacts and impacts of a report as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Group

from robotraj.witness.holding import Holding, part_of
from robotraj.witness.impact import Impact
from robotraj.witness.layout import grid, worst_rows
from robotraj.witness.violations import Violation

if TYPE_CHECKING:
    from robotraj.witness.report import Report


def contacts(report: Report) -> Group:
    """Lay out how far every contact moves, which rows its forces break, and the impacts."""
    weight = max(holding.weight for holding in report.holdings)
    rows, left_out = worst_rows(report.holdings, lambda h: max(h.slip.value, h.sink.value, h.turn.value))
    title = (
        f"  contacts between the knots, forces as parts of the weight of {weight:.4g} N{left_out}\n"
        "  (down: where the simulation through all phases set the contact down, from the planned place)"
    )
    table = grid("contact", "phase", "slip [m]", "at t [s]", "sink [m]", "at t [s]", "turn [rad]", "down [m]")
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
    forces = [line for h in report.holdings for line in _forces(h)]
    lines = forces or ["  forces: in their cones, pushing, centre of pressure inside, at and between the knots"]
    lines += [_differences(report.holdings)]
    lines += [_impact(impact) for impact in report.impacts]
    return Group(title, table, "", *lines, "")


def _forces(holding: Holding) -> list[str]:
    return [f"  {_broken(v, holding.weight)}" for v in (*holding.planned, *holding.solved)]


def _broken(violation: Violation, scale: float) -> str:
    return f"{violation}, {part_of(violation, scale):.1e} of the weight"


def _differences(holdings: tuple[Holding, ...]) -> str:
    known = [(h, h.difference) for h in holdings if h.difference is not None]
    shared = sorted({h.contact for h in holdings if h.difference is None})
    parts = []
    if known:
        holding, peak = max(known, key=lambda pair: pair[1].value)
        parts.append(
            f"planned and solved forces differ by {peak.value:.2e} N at most, {holding.contact}, t = {peak.time:.4g} s"
        )
    if shared:
        parts.append(f"not unique, not solved for: {', '.join(shared)}")
    return "  " + "; ".join(parts)


def _impact(impact: Impact) -> str:
    sizes = ", ".join(f"{name.removeprefix('impulse.')} {value:.4g}" for name, value in impact.impulses.items())
    lines = [
        f"  {impact.link} at t = {impact.time:.4g} s: {sizes} N s, takes {impact.lost:.4g} J; momentum off by "
        f"{impact.momentum.value:.1e} N s, contacts move on at {impact.rest.value:.1e} {impact.rest.unit}"
    ]
    lines += [f"    {v}, {part_of(v, impact.scale):.1e} of the impulse" for v in impact.broken]
    return "\n".join(lines)
