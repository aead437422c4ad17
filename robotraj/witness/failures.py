"""Messages about a plan: one sentence for each kind of figure that exceeds its tolerance."""

from __future__ import annotations

from robotraj.witness.checks.residual import Residual
from robotraj.witness.checks.watch import SOLVER_NOISE
from robotraj.witness.contacts.failures import contact_failures, crossed_legs, swing_failures
from robotraj.witness.figures import Figures, Tolerances
from robotraj.witness.peak import Peak
from robotraj.witness.simulation.closed_loop import ClosedLoop
from robotraj.witness.simulation.drift import DriftRow
from robotraj.witness.simulation.mirror_image import MIRRORED

ASYMMETRIC = "left and right of the robot differ in inertia: plan both halves of the gait, closed by rt.Periodic."


def failures_of(figures: Figures, tolerances: Tolerances) -> tuple[str, ...]:
    """Return one sentence for each kind of figure that exceeds its tolerance, about the worst violation."""
    advice = _advice(figures.residual)
    found = [f"Not checked: {'; '.join(figures.unchecked)}."] if figures.unchecked else []
    if figures.local is not None and tolerances.local is not None:
        what = "The plan violates the equations of motion: a short part, simulated by itself, misses its end:"
        row = figures.local.worst
        found += _off(what, row, tolerances.local, ASYMMETRIC if row.phase.endswith(MIRRORED) else advice)
    if figures.closed_loop is not None and tolerances.tracking is not None:
        found += _tracking(figures.closed_loop, tolerances.tracking, advice)
    if tolerances.drift is not None and figures.failure is not None:
        found.append(f"The open-loop simulation stopped early: {figures.failure}.")
    elif tolerances.drift is not None and figures.drift is not None:
        found += _off("Open loop, the simulation drifts from the plan:", figures.drift.worst, tolerances.drift, advice)
    found += contact_failures(figures.holdings, figures.impacts, tolerances)
    found += swing_failures(figures.swings, tolerances.ground)
    found += crossed_legs(figures.foot_orders)
    found += _limits(figures, tolerances.limits)
    found += _overlaps(figures)
    found += _balances(figures, tolerances)
    return tuple(found)


def _off(what: str, row: DriftRow, tolerance: float, advice: str) -> list[str]:
    """Return a sentence about the worst state, where its error exceeds the tolerance."""
    if row.relative <= tolerance:
        return []
    return [
        f"{what} {row.name} by {row.largest:.3g} {row.unit}".rstrip()
        + f" at t = {row.time:.4g} s in phase {row.phase!r}, {tolerance * row.scale:.3g} is allowed; {advice}"
    ]


def _tracking(loop: ClosedLoop, tolerance: float, advice: str) -> list[str]:
    """Return a sentence about the deviation with feedback, where it exceeds the tolerance."""
    if loop.error is None:
        return []
    if loop.reason is not None:
        return [f"With feedback, the robot does not complete the plan: {loop.reason}."]
    return _off("With feedback, the robot leaves the plan:", loop.error.worst, tolerance, advice)


def _limits(figures: Figures, tolerance: float) -> list[str]:
    broken = [v for v in figures.breaches if v.relative > tolerance]
    if not broken:
        return []
    others = f", and {len(broken) - 1} more" if len(broken) > 1 else ""
    return [
        f"A bound is violated: {broken[0]} in phase {broken[0].phase!r}{others}; "
        f"{tolerance * broken[0].size:.3g} is allowed."
    ]


def _overlaps(figures: Figures) -> list[str]:
    """Return a sentence about the links that overlap most."""
    if not figures.self_collisions:
        return []
    worst = min(figures.self_collisions, key=lambda each: each.distance)
    count = len(figures.self_collisions) - 1
    others = f", and {count} more pair{'s' * (count > 1)} do" if count else ""
    return [
        f"Links of the robot overlap: {worst.label} by {-worst.distance:.3g} m at t = {worst.time:.4g} s in phase "
        f"{worst.phase!r}{others}."
    ]


def _balances(figures: Figures, tolerances: Tolerances) -> list[str]:
    """Return sentences about the energy balance and the residuals between collocation points."""
    found = []
    energy = figures.energy
    if tolerances.energy is not None and energy is not None and energy.relative > tolerances.energy:
        found.append(
            f"The energy balance is off by {energy.imbalance:.3g} J, {energy.relative:.3g} of the energy "
            f"that moved, worst in the interval from t = {energy.time:.4g} s; "
            f"{tolerances.energy:.3g} is allowed."
        )
    peak = _largest(figures.residual)
    if tolerances.residual is not None and peak is not None and peak.value > tolerances.residual:
        found.append(
            f"The plan violates the equations between the collocation points: {peak.name} by {peak.value:.3g} "
            f"{peak.unit} at t = {peak.time:.4g} s in phase {peak.phase!r}; {tolerances.residual:.3g} is allowed."
        )
    return found


def _advice(residual: Residual) -> str:
    """Return what to do about an error: converge an unfinished solve first, else refine."""
    jump = max(residual.jumps.values(), key=lambda peak: peak.value, default=None)
    if jump is not None and jump.value > SOLVER_NOISE:
        gap = f"{jump.name} by {jump.value:.3g} {jump.unit}".rstrip()
        return (
            f"the plan jumps at the knot at t = {jump.time:.4g} s, {gap}: its solve has not converged; solve it again."
        )
    return "use a finer mesh or a scheme of higher order, or plan without mesh=, so that the planner refines."


def _largest(residual: Residual) -> Peak | None:
    parts = (residual.dynamics, residual.rate, residual.jumps)
    every = [peak for part in parts for peak in part.values()]
    return max(every, key=lambda peak: peak.value, default=None)
