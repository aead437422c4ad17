"""Messages about the contacts and impacts of a plan."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj.witness.contacts.impact import Impact
from robotraj.witness.contacts.slip_and_friction import Holding, part_of

MOVES = {"slip": "slips", "sink": "leaves the ground or sinks into it", "turn": "turns"}


def contact_failures(
    holdings: Sequence[Holding],
    impacts: Sequence[Impact],
    contact: float | None,
    forces: float | None,
    limits: float,
) -> list[str]:
    """Return one sentence for each kind of figure that exceeds its tolerance, about the worst violation.

    Parameters
    ----------
    contact, forces, limits : float or None
        Thresholds of ``Tolerances``; figures without a threshold are not judged.
    """
    return [
        *([] if contact is None else _moves(holdings, contact)),
        *([] if forces is None else _forces(holdings, forces)),
        *_impacts(impacts, forces, limits),
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
