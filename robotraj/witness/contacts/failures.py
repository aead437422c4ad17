"""Messages about the contacts and impacts of a plan."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from robotraj.witness.contacts.foot_order import FootOrder
from robotraj.witness.contacts.ground import SwingingFoot
from robotraj.witness.contacts.impact import Impact
from robotraj.witness.contacts.links_over_ground import LinkDepth
from robotraj.witness.contacts.slip_and_friction import Holding, part_of

MOVES = {"slip": "slips", "sink": "leaves the ground or sinks into it", "turn": "turns"}


class Allowed(Protocol):
    """Thresholds of contacts, as of ``Tolerances``; figures whose threshold is None are not judged."""

    @property
    def contact(self) -> float | None:
        """Largest slip [m], sink [m] and turn [rad]."""

    @property
    def forces(self) -> float | None:
        """Largest violation of a force limit, relative to the weight or to an impulse."""

    @property
    def force_error(self) -> float | None:
        """Largest relative difference between planned forces and those of the equations."""

    @property
    def limits(self) -> float:
        """Largest velocity [m/s, rad/s] of a contact after its impact."""


def contact_failures(holdings: Sequence[Holding], impacts: Sequence[Impact], allowed: Allowed) -> list[str]:
    """Return one sentence for each kind of figure that exceeds its tolerance, about the worst violation."""
    return [
        *([] if allowed.contact is None else _moves(holdings, allowed.contact)),
        *([] if allowed.forces is None else _forces(holdings, allowed.forces)),
        *([] if allowed.force_error is None else _differences(holdings, allowed.force_error)),
        *_impacts(impacts, allowed.forces, allowed.limits),
    ]


def swing_failures(swings: Sequence[SwingingFoot], allowed: float | None) -> list[str]:
    """Return a sentence about the foot that swings furthest below the ground, where that is too far."""
    worst = max((swing for swing in swings if not swing.free), key=lambda swing: swing.part, default=None)
    if allowed is None or worst is None or worst.part <= allowed:
        return []
    where = f"in phase {worst.phase!r}"
    if worst.depth * worst.rise == 0.0 and worst.rise:
        return [
            f"Foot {worst.frame!r} lands from below: it rises at {worst.rise:.3g} m/s before its touchdown at "
            f"t = {worst.end:.4g} s {where}."
        ]
    return [
        f"Foot {worst.frame!r} is below the ground while it swings: by {worst.depth:.3g} m at t = {worst.time:.4g} s "
        f"{where}. Use a finer mesh, or rt.GroundClearance({worst.frame!r}, None) for a foot that may pass through it."
    ]


def link_failures(depths: Sequence[LinkDepth], allowed: float | None) -> list[str]:
    """Return a sentence about the link that is furthest below the ground, where that is too far."""
    worst = max(depths, key=lambda each: each.part, default=None)
    if allowed is None or worst is None or worst.part <= allowed:
        return []
    return [
        f"Link {worst.link!r} is below the ground: by {worst.depth:.3g} m at t = {worst.time:.4g} s in phase "
        f"{worst.phase!r}. rt.GroundClearance(rt.constraints.CollisionShapes({worst.link!r})) in the constraints of "
        "that phase keeps it above."
    ]


def crossed_legs(orders: Sequence[FootOrder]) -> list[str]:
    """Return a sentence about the feet that are furthest on each other's side."""
    worst = min(orders, key=lambda order: order.distance, default=None)
    if worst is None or worst.distance > 0.0:
        return []
    return [
        f"Legs cross: {worst.first!r} is {-worst.distance:.3g} m on the side of {worst.second!r} at t = "
        f"{worst.time:.4g} s in phase {worst.phase!r}. Plan with sides=rt.gait.OwnSides(), the default of gaits."
    ]


def _differences(holdings: Sequence[Holding], allowed: float) -> list[str]:
    """Return a sentence about the planned force that differs most from that of the equations."""
    known = [(h.force_error, h, h.difference) for h in holdings if h.difference is not None]
    part, holding, peak = max(known, key=lambda entry: entry[0], default=(0.0, None, None))
    if holding is None or peak is None or part <= allowed:
        return []
    return [
        f"A planned contact force is not that of the equations: {holding.contact!r} by {peak.value:.3g} {peak.unit} at "
        f"t = {peak.time:.4g} s in phase {peak.phase!r}, {part:.3g} of its scale; {allowed:.3g} is allowed. "
        "Use a finer mesh."
    ]


def _moves(holdings: Sequence[Holding], allowed: float) -> list[str]:
    found = []
    for kind, verb in MOVES.items():
        pairs = [(holding.contact, getattr(holding, kind)) for holding in holdings]
        name, peak = max(pairs, key=lambda pair: pair[1].value, default=(None, None))
        if peak is not None and peak.value > allowed:
            found.append(
                f"Contact {name!r} {verb}: by {peak.value:.3g} {peak.unit} at t = {peak.time:.4g} s in phase "
                f"{peak.phase!r}, {allowed:.3g} is allowed; use a finer mesh."
            )
    return found


def _forces(holdings: Sequence[Holding], allowed: float) -> list[str]:
    broken = [(part_of(v, holding.weight), v) for holding in holdings for v in (*holding.planned, *holding.solved)]
    over = sorted((pair for pair in broken if pair[0] > allowed), key=lambda pair: -pair[0])
    if not over:
        return []
    part, worst = over[0]
    others = f", and {len(over) - 1} more" if len(over) > 1 else ""
    return [
        f"A contact force violates its limits: {worst} in phase {worst.phase!r}{others}; "
        f"that is {part:.3g} of the weight, {allowed:.3g} is allowed."
    ]


def _impacts(impacts: Sequence[Impact], forces: float | None, limits: float) -> list[str]:
    found = []
    for impact in impacts:
        who = f"The impact of {impact.link} at t = {impact.time:.4g} s"
        momentum, rest = impact.momentum, impact.rest
        if forces is not None and momentum.value > forces * impact.scale:
            found.append(
                f"{who} does not conserve momentum: {momentum.name} by {momentum.value:.3g} N s, "
                f"{forces * impact.scale:.3g} is allowed."
            )
        if rest.value > limits:
            found.append(f"{who} leaves {rest.name} moving at {rest.value:.3g} {rest.unit}; {limits:.3g} is allowed.")
        worst = max(impact.broken, key=lambda v: part_of(v, impact.scale), default=None)
        if forces is not None and worst is not None and part_of(worst, impact.scale) > forces:
            found.append(f"{who} violates a limit: {worst}; {forces:.3g} of the impulse is allowed.")
    return found
