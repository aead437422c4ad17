"""The contacts and impacts of a report as text."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj.witness.contacts.failures import Allowed
from robotraj.witness.contacts.foot_order import FootOrder
from robotraj.witness.contacts.ground import SwingingFoot
from robotraj.witness.contacts.impact import Impact
from robotraj.witness.contacts.links_over_ground import LinkDepth
from robotraj.witness.contacts.slip_and_friction import Holding, part_of
from robotraj.witness.plants.plant import Landing
from robotraj.witness.report_tables import table, worst_of, wrapped


def contacts(
    holdings: Sequence[Holding], impacts: Sequence[Impact], landings: Sequence[Landing], tolerances: Allowed
) -> list[str]:
    """Lay out how far every contact moves, which limits its forces violate, and the impacts.

    Parameters
    ----------
    tolerances : Tolerances
        Thresholds ``contact`` and ``forces``.
    """
    weight = max(holding.weight for holding in holdings)
    rows, others = worst_of(holdings, lambda h: max(h.slip.value, h.sink.value, h.turn.value))
    titles = [
        f"  contacts between the knots, for a weight of {weight:.4g} N{others}",
        "  (down: distance of the place where the open-loop simulation sets it down)",
    ]
    down = {(landing.contact, landing.phase): landing.distance for landing in landings}
    cells = []
    for h in rows:
        most = max(h.slip.value, h.sink.value, h.turn.value)
        mark = " !" if tolerances.contact is not None and most > tolerances.contact else ""
        where = down.get((h.contact, h.phase))
        moved = (f"{peak.value:.1e}" for peak in (h.slip, h.sink, h.turn))
        cells.append([h.contact + mark, *moved, "" if where is None else f"{where:.1e}", h.phase])
    lines = table(("contact", "slip [m]", "sink [m]", "turn [rad]", "down [m]", "phase"), cells, (0, 5))
    furthest = max(landings, key=lambda landing: landing.moved, default=None)
    if furthest is not None:
        lines += wrapped(f"in the simulation a contact moves by {furthest.moved:.1e} m at most while it holds")
    lines += _forces(holdings, impacts, tolerances.forces)
    return [*titles, *lines, *_differences(holdings), *(line for impact in impacts for line in _impact(impact))]


def _forces(holdings: Sequence[Holding], impacts: Sequence[Impact], allowed: float | None) -> list[str]:
    """Lay out the limits that forces of contacts and impulses of impacts violate."""
    broken = [(v, part_of(v, h.weight)) for h in holdings for v in (*h.planned, *h.solved)]
    broken += [(v, part_of(v, impact.scale)) for impact in impacts for v in impact.broken]
    if not broken:
        return ["  normal force, friction and centre of pressure: none violated"]
    rows, others = worst_of(broken, lambda pair: pair[1])
    title = f"  limits of forces violated, as a part of the weight or of the impulse{others}"
    cells = []
    for v, part in rows:
        mark = " !" if allowed is not None and part > allowed else ""
        cells.append([f"{v.label}{mark}", f"{v.amount:.2e}", v.unit, f"{part:.1e}", f"{v.time:.4f}", v.phase])
    return [title, *table(("row", "by", "unit", "part", "at t [s]", "phase"), cells, (0, 5))]


def _differences(holdings: Sequence[Holding]) -> list[str]:
    known = [(h, h.difference) for h in holdings if h.difference is not None]
    shared = sorted({h.contact for h in holdings if h.difference is None or h.shared})
    lines = []
    if known:
        holding, peak = max(known, key=lambda pair: pair[1].value)
        lines += wrapped(
            f"planned forces and those of the equations differ by {peak.value:.1e} N, {holding.contact}, "
            f"t = {peak.time:.4g} s"
        )
    if shared:
        lines += wrapped(f"forces that the equations do not determine alone, as planned: {', '.join(shared)}")
    return lines


def order_lines(orders: Sequence[FootOrder]) -> list[str]:
    """Return the pair of feet that comes nearest to crossing."""
    if not orders:
        return []
    low = min(orders, key=lambda order: order.distance)
    return wrapped(
        f"{low.first} and {low.second} are {low.distance:.3g} m apart at least, {low.neutral:.3g} m in the neutral "
        f"configuration (t = {low.time:.4g} s)"
    )


def swing_lines(swings: Sequence[SwingingFoot]) -> list[str]:
    """Return the lowest swinging foot of those that must stay above the ground, and those that need not."""
    if not swings:
        return []
    judged = [swing for swing in swings if not swing.free]
    lines = []
    if judged:
        low = max(judged, key=lambda swing: swing.depth)
        at = f" ({low.frame}, t = {low.time:.4g} s)" if low.depth else ""
        fast = max(judged, key=lambda swing: swing.rise)
        up = f", {fast.frame} lands from below at {fast.rise:.1e} m/s" if fast.rise else ""
        lines += wrapped(f"swinging feet are {low.depth:.1e} m below the ground at most{at}{up}")
    free = sorted({swing.frame for swing in swings if swing.free})
    if free:
        depth = max(swing.depth for swing in swings if swing.free)
        lines += wrapped(f"not judged: {', '.join(free)} may pass through the ground, by {depth:.1e} m here")
    return lines


def link_lines(depths: Sequence[LinkDepth]) -> list[str]:
    """Return the link that comes nearest to the ground, or is deepest below it."""
    low = max(depths, key=lambda each: each.depth, default=None)
    if low is None:
        return []
    over = f"{-low.depth:.3g} m above" if low.depth <= 0.0 else f"{low.depth:.1e} m below"
    return wrapped(f"the lowest link is {over} the ground of the feet's shapes ({low.link}, t = {low.time:.4g} s)")


def _impact(impact: Impact) -> list[str]:
    sizes = ", ".join(f"{name.removeprefix('impulse.')} {value:.4g}" for name, value in impact.impulses.items())
    return [
        *wrapped(f"{impact.link} at t = {impact.time:.4g} s loses {impact.lost:.4g} J, impulses: {sizes} N s"),
        f"    residual of momentum {impact.momentum.value:.1e} N s, of rest {impact.rest.value:.1e} {impact.rest.unit}",
    ]
