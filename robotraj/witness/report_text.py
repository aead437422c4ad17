"""A report as text, 80 columns wide, the verdict last."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj.solution.claims.claim import Claim, Judgement
from robotraj.witness.claims.contract import claims_of
from robotraj.witness.contacts.contact_table import contacts, link_lines, order_lines, swing_lines
from robotraj.witness.figures import Figures
from robotraj.witness.peak import Peak
from robotraj.witness.report_tables import table, worst_of, wrapped
from robotraj.witness.simulation.drift import Drift, DriftRow


def render(figures: Figures, failures: Sequence[str], verdict: str) -> str:
    """Return the report: motion by state, violated bounds, contacts, residuals, energy, failures and verdict.

    Parameters
    ----------
    failures : sequence of str
        Sentences on figures that exceed their tolerances.
    verdict : str
        Verdict as printed, which may be coloured.
    """
    phases = ", ".join(repr(name) for name in figures.phases)
    head = f"Validation of {phases}: {figures.duration:.6g} s, {figures.intervals} intervals"
    lines = [*wrapped(head, "", "  "), *_motion(figures), "", *_violations(figures), ""]
    lines += _clearances(figures)
    if figures.holdings:
        lines += contacts(figures.holdings, figures.impacts, figures.landings, figures.tolerances)
        lines += [*swing_lines(figures.swings), *link_lines(figures.link_depths), *order_lines(figures.foot_orders)]
        lines += [*wrapped("the plan uses " + ", ".join(map(str, figures.shares))), ""] if figures.shares else [""]
    lines += [*_residual(figures), *_energy(figures), *_unseen(figures)]
    lines += _claims_text(claims_of(figures, figures.tolerances))
    lines += [line for failure in failures for line in wrapped(failure, "  ! ", "    ")]
    return "\n".join([*lines, f"{verdict} in {figures.seconds:.2g} s of processor time"])


def _motion(figures: Figures) -> list[str]:
    """Lay out local error, deviation with feedback and open-loop drift of every state, side by side."""
    loop = figures.closed_loop
    tracked = None if loop is None else loop.error
    parts = ((figures.local, figures.tolerances.local), (tracked, figures.tolerances.tracking), (figures.drift, None))
    shown = next((drift for drift, _ in parts if drift is not None), None)
    notes = _notes(figures)
    if shown is None:
        return notes
    rows, others = worst_of(
        shown.rows, lambda row: max(_share(drift, row.name, tolerance) for drift, tolerance in parts)
    )
    cells = [
        [
            row.name,
            *(cell for drift, tolerance in parts[:2] for cell in _cells_of(drift, row.name, tolerance)),
            _cells_of(figures.drift, row.name, figures.tolerances.drift)[0],
            row.unit,
        ]
        for row in rows
    ]
    title = wrapped(
        f"largest |simulated - planned|{others}: for short parts alone (local), with feedback by solution.gains "
        "(tracking) and without it (open loop)",
        more="  ",
    )
    headers = ("state", "local", "allowed", "tracking", "allowed", "open loop", "unit")
    return [*title, *table(headers, cells), *notes]


def _row(drift: Drift | None, name: str) -> DriftRow | None:
    return drift[name] if drift is not None and name in drift else None


def _share(drift: Drift | None, name: str, tolerance: float | None) -> float:
    """Return the drift of a state relative to its tolerance; without a tolerance, the drift itself."""
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
    return [line for note in notes for line in wrapped(note)]


def _violations(figures: Figures) -> list[str]:
    if not figures.violations:
        return ["  limits and constraints: none violated, at or between the knots"]
    rows, others = worst_of(figures.violations, lambda v: v.relative)
    title = f"  limits and constraints violated, {figures.tolerances.limits:.1e} of their range is allowed{others}"
    cells = [[f"{v.label} !", f"{v.amount:.2e}", f"{v.limit:.6g}", v.unit, f"{v.time:.4f}", v.phase] for v in rows]
    return [title, *table(("row", "by", "limit", "unit", "at t [s]", "phase"), cells, (0, 5))]


def _clearances(figures: Figures) -> list[str]:
    """Return the smallest distances, links that overlap, and what was not judged."""
    lines = []
    for each in figures.clearances:
        apart = f"{1e3 * each.distance:.4g} mm, {each.label}, t = {each.time:.4g} s"
        lines += wrapped(f"smallest distance: {apart} (at least {1e3 * each.margin:g} mm)")
    for each in figures.self_collisions:
        lines += wrapped(
            f"overlap: {each.label} by {-1e3 * each.distance:.3g} mm in phase {each.phase!r}, t = {each.time:.4g} s !"
        )
    if figures.own_distances and not figures.self_collisions:
        least = min(figures.own_distances, key=lambda each: each.distance)
        lines += wrapped(f"own links: nearest are {least.label}, {1e3 * least.distance:.3g} mm, t = {least.time:.4g} s")
    lines += [line for each in figures.unguarded for line in wrapped(f"not judged: {each}")]
    lines += [line for each in figures.left_out for line in wrapped(f"left out: {each}")]
    return [*lines, ""] if lines else []


def _residual(figures: Figures) -> list[str]:
    dynamics, rate = figures.residual.dynamics, figures.residual.rate
    names = list(dict.fromkeys([*dynamics, *rate]))
    shown, others = worst_of(names, lambda name: max(_value(dynamics.get(name)), _value(rate.get(name))))
    jump = max(figures.residual.jumps.values(), key=lambda peak: peak.value, default=None)
    most = (
        "none" if jump is None else f"{jump.value:.1e} {jump.unit}".rstrip() + f", {jump.name}, t = {jump.time:.4g} s"
    )
    cells = [[name, *_cells(dynamics.get(name)), *_cells(rate.get(name))] for name in shown]
    headers = ("of", "dynamics", "unit", "at t [s]", "rate", "unit", "at t [s]")
    titles = [*wrapped(f"largest jump at a knot: {most}"), f"  largest residual of the equations{others}"]
    return [*titles, *table(headers, cells), ""]


def _value(peak: Peak | None) -> float:
    return 0.0 if peak is None else peak.value


def _cells(peak: Peak | None) -> tuple[str, str, str]:
    return ("", "", "") if peak is None else (f"{peak.value:.2e}", peak.unit, f"{peak.time:.4f}")


def _energy(figures: Figures) -> list[str]:
    energy = figures.energy
    if energy is None:
        return []
    return [
        f"  energy: work {energy.work:.6g} J - dissipated {energy.dissipated:.6g} J - change {energy.change:.6g} J",
        f"          = {energy.imbalance:.2e} J, {energy.relative:.1e} of the energy that moved",
    ]


def _unseen(figures: Figures) -> list[str]:
    return wrapped(f"no time for: {', '.join(figures.unseen)}") if figures.unseen else []


def _claims_text(claims: Sequence[Claim]) -> list[str]:
    """Return a table of the claims, and the reasons of those that were not judged."""
    cells = [
        [
            claim.name,
            claim.judgement.value,
            "" if claim.figure is None else f"{claim.figure:.1e} {claim.unit}".rstrip(),
            "" if claim.bound is None else f"{claim.bound:.0e}",
        ]
        for claim in claims
    ]
    lines = table(("claim", "judgement", "worst", "allowed"), cells, (0, 1))
    for claim in claims:
        if claim.judgement is Judgement.NOT_JUDGED:
            lines += [line for note in claim.notes for line in wrapped(f"{claim.name}: {note}", "  ? ", "    ")]
    return [*lines, ""]
