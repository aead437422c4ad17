"""The contacts and impacts of a report as text."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Protocol

from rich.console import Group

from robotraj.witness.contacts.holding import Holding, part_of
from robotraj.witness.contacts.impact import Impact
from robotraj.witness.layout import WIDTH, columns_of, worst_of
from robotraj.witness.plants.plant import Landing


class Allowed(Protocol):
    """Thresholds that concern contacts; None does not judge."""

    @property
    def contact(self) -> float | None:
        """Largest slip [m], sink [m] and turn [rad]."""

    @property
    def forces(self) -> float | None:
        """Largest part of the weight or of an impulse."""


def contacts(
    holdings: Sequence[Holding], impacts: Sequence[Impact], landings: Sequence[Landing], tolerances: Allowed
) -> Group:
    """Lay out how far every contact moves, which rows its forces break, and the impacts.

    Parameters
    ----------
    tolerances : Tolerances
        Thresholds ``contact`` and ``forces``.
    """
    weight = max(holding.weight for holding in holdings)
    rows, left_out = worst_of(holdings, lambda h: max(h.slip.value, h.sink.value, h.turn.value))
    title = (
        f"  contacts between the knots, for a weight of {weight:.4g} N{left_out}\n"
        "  (down: where the open-loop simulation set it down, from the planned place)"
    )
    table = columns_of("contact", "slip [m]", "sink [m]", "turn [rad]", "down [m]", "phase")
    down = {(landing.contact, landing.phase): landing.distance for landing in landings}
    for h in rows:
        most = max(h.slip.value, h.sink.value, h.turn.value)
        mark = " !" if tolerances.contact is not None and most > tolerances.contact else ""
        where = down.get((h.contact, h.phase))
        table.add_row(
            h.contact + mark,
            f"{h.slip.value:.1e}",
            f"{h.sink.value:.1e}",
            f"{h.turn.value:.1e}",
            "" if where is None else f"{where:.1e}",
            h.phase,
        )
    held = "  normal force, friction and centre of pressure: none broken"
    rows_of_forces = _forces(holdings, impacts, tolerances.forces) or held
    struck = [line for impact in impacts for line in _impact(impact)]
    moved = max(landings, key=lambda landing: landing.moved, default=None)
    kept = "" if moved is None else f"  in the simulation a contact moves by {moved.moved:.1e} m at most while it holds"
    return Group(title, table, "", kept, rows_of_forces, *_differences(holdings), *struck, "")


def _forces(holdings: Sequence[Holding], impacts: Sequence[Impact], allowed: float | None) -> Group | None:
    """Rows that the forces of contacts and impacts break, as a table."""
    broken = [(v, part_of(v, h.weight)) for h in holdings for v in (*h.planned, *h.solved)]
    broken += [(v, part_of(v, impact.scale)) for impact in impacts for v in impact.broken]
    if not broken:
        return None
    rows, left_out = worst_of(broken, lambda pair: pair[1])
    title = f"  what the ground cannot give, as a part of the weight or of the impulse{left_out}"
    table = columns_of("row", "by", "unit", "part", "at t [s]", "phase")
    for v, part in rows:
        mark = " !" if allowed is not None and part > allowed else ""
        cells = (f"{v.amount:.2e}", v.unit, f"{part:.1e}", f"{v.time:.4f}", v.phase)
        table.add_row(f"{v.name}, {v.joint}{mark}", *cells)
    return Group(title, table, "")


def _differences(holdings: Sequence[Holding]) -> list[str]:
    known = [(h, h.difference) for h in holdings if h.difference is not None]
    shared = sorted({h.contact for h in holdings if h.difference is None})
    lines = []
    if known:
        holding, peak = max(known, key=lambda pair: pair[1].value)
        where = f"{holding.contact}, t = {peak.time:.4g} s"
        lines.append(f"  planned forces and those of the equations differ by {peak.value:.1e} N, {where}")
    if shared:
        lines.append(f"  forces that the equations leave open, as planned: {', '.join(shared)}")
    return lines


def _impact(impact: Impact) -> list[str]:
    sizes = ", ".join(f"{name.removeprefix('impulse.')} {value:.4g}" for name, value in impact.impulses.items())
    what = f"  {impact.link} at t = {impact.time:.4g} s takes {impact.lost:.4g} J: {sizes} N s"
    return [
        textwrap.fill(what, WIDTH, subsequent_indent="    "),
        f"    momentum off by {impact.momentum.value:.1e} N s, contacts move on at {impact.rest.value:.1e} "
        f"{impact.rest.unit}",
    ]
