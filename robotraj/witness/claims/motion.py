"""The plan is a motion of the robot or System: short parts, simulated by themselves, meet their ends."""

from __future__ import annotations

from robotraj.solution.claims.claim import Claim
from robotraj.witness.checks.residual import Residual
from robotraj.witness.checks.watch import SOLVER_NOISE
from robotraj.witness.claims.judged import LATE, Scope
from robotraj.witness.figures import Figures, Tolerances
from robotraj.witness.peak import Peak
from robotraj.witness.simulation.drift import DriftRow
from robotraj.witness.simulation.mirror_image import MIRRORED

ASYMMETRIC = "left and right of the robot differ in inertia: plan both halves of the gait, closed by rt.Periodic."

SCOPE = Scope(
    "motion",
    "forward simulation of short parts by plain Pinocchio, or by a System's own equations on numbers",
    "from each planned state the planned torques move the robot to the next ones, by the equations of its model",
    "growth of small errors over the whole motion, which feedback has to correct; the model itself",
)


def motion(figures: Figures, tolerances: Tolerances) -> Claim:
    """Return the claim on the equations of motion."""
    if figures.local is None:
        return SCOPE.unknown(LATE)
    row = figures.local.worst
    wrong = list(_equations(figures, tolerances))
    if tolerances.local is None and not wrong:
        return SCOPE.unknown("No threshold was given.", row.relative)
    return SCOPE.judged(wrong, row.relative, tolerances.local)


def _equations(figures: Figures, tolerances: Tolerances) -> list[str]:
    """Return sentences on the local error, the residual and the open-loop drift, as far as they have thresholds."""
    advice, found = advice_on(figures.residual), []
    if figures.local is not None and tolerances.local is not None:
        what = "The plan violates the equations of motion: a short part, simulated by itself, misses its end:"
        row = figures.local.worst
        found += off(what, row, tolerances.local, ASYMMETRIC if row.phase.endswith(MIRRORED) else advice)
    if tolerances.drift is not None and figures.failure is not None:
        found.append(f"The open-loop simulation stopped early: {figures.failure}.")
    elif tolerances.drift is not None and figures.drift is not None:
        found += off("Open loop, the simulation drifts from the plan:", figures.drift.worst, tolerances.drift, advice)
    peak = _largest(figures.residual)
    if tolerances.residual is not None and peak is not None and peak.value > tolerances.residual:
        found.append(
            f"The plan violates the equations between the collocation points: {peak.name} by {peak.value:.3g} "
            f"{peak.unit} at t = {peak.time:.4g} s in phase {peak.phase!r}; {tolerances.residual:.3g} is allowed."
        )
    return found


def off(what: str, row: DriftRow, tolerance: float, advice: str) -> list[str]:
    """Return a sentence about the worst state, where its error exceeds the tolerance."""
    if row.relative <= tolerance:
        return []
    return [
        f"{what} {row.name} by {row.largest:.3g} {row.unit}".rstrip()
        + f" at t = {row.time:.4g} s in phase {row.phase!r}, {tolerance * row.scale:.3g} is allowed; {advice}"
    ]


def advice_on(residual: Residual) -> str:
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
