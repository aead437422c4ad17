"""What the witness found, as a value that prints as a table and can refuse."""

from __future__ import annotations

from dataclasses import fields, replace

from robotraj._util.errors import ValidationFailed, unknown_name
from robotraj._util.values import dataclass
from robotraj.witness.closed_loop import ClosedLoop
from robotraj.witness.contact_complaints import contact_complaints
from robotraj.witness.drift import Drift, DriftRow
from robotraj.witness.energy import Energy
from robotraj.witness.holding import Holding
from robotraj.witness.impact import Impact
from robotraj.witness.peak import Peak
from robotraj.witness.plant import Landing
from robotraj.witness.residual import Residual
from robotraj.witness.table import render
from robotraj.witness.violations import SOLVER_NOISE, Violation


@dataclass(frozen=True)
class Tolerances:
    """Thresholds of ``Report.passed``; None reports a figure without judging it.

    Attributes
    ----------
    local : float or None
        Largest local error: |simulated - planned| / (1 + |planned|) at the end of any short part of the plan that is
        simulated from the plan's own state.
    tracking : float or None
        Largest deviation with feedback: joint positions [rad, m] as they are, joint velocities divided by
        10 max(1, largest planned value).
    limits : float
        Largest violation of a limit, constraint or boundary condition, as a part of half the range of a row with two
        bounds, of max(1, |limit|) otherwise.
    contact : float or None
        Largest slip [m], sink [m] and turn [rad] of a contact between collocation points.
    forces : float or None
        How far normal force, friction and centre of pressure may be broken between collocation points, as a part of the
        robot's weight; of impacts, as a part of the impulse.
    energy : float or None
        |imbalance| of the energy balance relative to the energy that moved.
    residual : float or None
        Residual of the equations between collocation points and jump at knots, in the unit of each.
    drift : float or None
        Largest open-loop drift through all phases, scaled as ``tracking``; the states of Systems divided by
        max(1, largest planned value). An unstable motion drifts however good its plan is.
    """

    local: float | None = 1e-3
    tracking: float | None = 1e-2
    limits: float = 1e-3
    contact: float | None = 1e-4
    forces: float | None = 1e-3
    energy: float | None = None
    residual: float | None = None
    drift: float | None = None


@dataclass(frozen=True, repr=False)
class Report:
    """The proof of a plan, or what is wrong with it.

    Attributes
    ----------
    local : Drift or None
        Local error by state: parts of the plan simulated one by one. None where time was up before.
    closed_loop : ClosedLoop
        The plan followed with its own feedback, and the growth of a small error without it.
    drift : Drift or None
        Open loop, by state: final and largest distance between the simulated and the planned motion. Shown, not judged.
    breaches : tuple of Violation
        Bounds broken by more than a solver's tolerance, the worst first; ``violations`` are those that count.
    energy : Energy or None
        None for Systems, whose energy is not known.
    residual : Residual
    failure : str or None
        Why and when the open-loop simulation stopped before the end; None if it did not.
    tolerances : Tolerances
        The thresholds of ``passed``.
    duration : float
        Of the plan [s].
    intervals : int
        Of all phases.
    phases : tuple of str
        Names of the phases.
    rtol, atol : float
        Tolerances of the simulations' steps.
    seconds : float
        Processor time of the validation [s].
    unchecked : tuple of str
        What was not checked, and why: rows of the problem that a file could not keep, and checks for which there was
        no time. With any of them the plan has not passed.
    unseen : tuple of str
        Figures that are shown, not judged, for which there was no time.
    landings : tuple of Landing
        Where the open-loop simulation set its contacts down.
    holdings : tuple of Holding
        How every contact of every phase holds: slip, sink, forces.
    impacts : tuple of Impact
    stiff : float or None
        Time [s] from which on LSODA simulated open loop, because the motion is stiff there.
    """

    local: Drift | None
    closed_loop: ClosedLoop | None
    drift: Drift | None
    breaches: tuple[Violation, ...]
    energy: Energy | None
    residual: Residual
    failure: str | None
    tolerances: Tolerances
    duration: float
    intervals: int
    phases: tuple[str, ...]
    rtol: float
    atol: float
    seconds: float = 0.0
    unchecked: tuple[str, ...] = ()
    unseen: tuple[str, ...] = ()
    landings: tuple[Landing, ...] = ()
    holdings: tuple[Holding, ...] = ()
    impacts: tuple[Impact, ...] = ()
    stiff: float | None = None

    @property
    def violations(self) -> tuple[Violation, ...]:
        """Bounds broken by more than the tolerance, the worst first."""
        return tuple(v for v in self.breaches if v.relative > self.tolerances.limits)

    @property
    def passed(self) -> bool:
        """Whether everything that is judged was checked and lies within ``tolerances``."""
        return not self.complaints(self.tolerances)

    def complaints(self, tolerances: Tolerances) -> tuple[str, ...]:
        """One sentence for each kind of figure that exceeds its tolerance, naming the worst offender."""
        found = []
        if self.unchecked:
            found.append(f"Not checked: {'; '.join(self.unchecked)}.")
        if self.local is not None and tolerances.local is not None:
            row = self.local.worst
            if not row.relative <= tolerances.local:
                found.append(
                    "The plan does not obey the equations of motion: simulated from its own state at the beginning of "
                    f"a short part, {row.name} is off by {row.largest:.3g} {row.unit}".rstrip()
                    + f" at t = {row.time:.4g} s in phase {row.phase!r}, {tolerances.local * row.scale:.3g} is "
                    f"allowed; {self._advice()}"
                )
        if self.closed_loop is not None and tolerances.tracking is not None:
            found += self._tracking(self.closed_loop, tolerances.tracking)
        if tolerances.drift is not None:
            if self.failure is not None:
                found.append(f"The open-loop simulation stopped early: {self.failure}.")
            elif self.drift is not None and not self.drift.worst.relative <= tolerances.drift:
                found.append(self._drifts(self.drift.worst, tolerances.drift))
        found += contact_complaints(
            self.holdings, self.impacts, tolerances.contact, tolerances.forces, tolerances.limits
        )
        broken = [v for v in self.breaches if v.relative > tolerances.limits]
        if broken:
            others = f", and {len(broken) - 1} more" if len(broken) > 1 else ""
            allowed = tolerances.limits * broken[0].size
            found.append(f"A bound is broken: {broken[0]}{others}; {allowed:.3g} is allowed.")
        energy = self.energy
        if tolerances.energy is not None and energy is not None and energy.relative > tolerances.energy:
            found.append(
                f"The energy balance is off by {energy.imbalance:.3g} J, {energy.relative:.3g} of the energy "
                f"that moved, worst in the interval from t = {energy.time:.4g} s; "
                f"{tolerances.energy:.3g} is allowed."
            )
        peak = _largest(self.residual)
        if tolerances.residual is not None and peak is not None and peak.value > tolerances.residual:
            found.append(
                f"The dynamics do not hold between the collocation points: {peak.name} by {peak.value:.3g} "
                f"{peak.unit} at t = {peak.time:.4g} s in phase {peak.phase!r}; "
                f"{tolerances.residual:.3g} is allowed."
            )
        return tuple(found)

    def check(self, **allowed: float | None) -> None:
        """Raise unless the plan holds.

        Parameters
        ----------
        **allowed : float or None
            Thresholds by the names of ``Tolerances``: ``check(drift=1e-2, contact=1e-5)``; the report's own where not
            given.

        Raises
        ------
        ValidationFailed
            Names the worst offender of each kind, with its joint and time; carries this report.
        """
        names = [entry.name for entry in fields(Tolerances)]
        for name in allowed:
            if name not in names:
                raise unknown_name("threshold", name, names)
        complaints = self.complaints(replace(self.tolerances, **{k: v for k, v in allowed.items() if v is not None}))
        if complaints:
            raise ValidationFailed(" ".join(complaints), self)

    def _tracking(self, loop: ClosedLoop, tolerance: float) -> list[str]:
        """Say how far feedback lets the robot go from its plan, where that is too far."""
        if loop.error is None:
            return []
        if loop.reason is not None:
            return [f"With feedback, the robot does not get through the plan: {loop.reason}."]
        row = loop.error.worst
        if row.relative <= tolerance:
            return []
        return [
            f"With feedback, the robot leaves the plan: {row.name} by {row.largest:.3g} {row.unit}".rstrip()
            + f" at t = {row.time:.4g} s in phase {row.phase!r}, {tolerance * row.scale:.3g} is allowed; "
            + self._advice()
        ]

    def _drifts(self, row: DriftRow, tolerance: float) -> str:
        return (
            f"Open loop, the simulation drifts from the plan: {row.name} by {row.largest:.3g} {row.unit}".rstrip()
            + f" at t = {row.time:.4g} s in phase {row.phase!r}, {tolerance * row.scale:.3g} is allowed; "
            + self._advice()
        )

    def _advice(self) -> str:
        """Say what to do about an error: close the gaps of an unfinished solve first, else refine."""
        jump = max(self.residual.jumps.values(), key=lambda peak: peak.value, default=None)
        if jump is not None and jump.value > SOLVER_NOISE:
            gap = f"{jump.name} by {jump.value:.3g} {jump.unit}".rstrip()
            when = f"t = {jump.time:.4g} s"
            return f"the plan itself jumps at the knot at {when}, {gap}: its solve has not converged."
        return "use a finer mesh or a scheme of higher order, or leave mesh= out, so that the planner refines."

    def __str__(self) -> str:
        return render(self)


def _largest(residual: Residual) -> Peak | None:
    parts = (residual.dynamics, residual.rate, residual.jumps)
    every = [peak for part in parts for peak in part.values()]
    return max(every, key=lambda peak: peak.value, default=None)
