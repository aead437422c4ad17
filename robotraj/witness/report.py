"""What the witness found, as a value that prints as a table and can refuse."""

from __future__ import annotations

from dataclasses import fields, replace

from robotraj._util.errors import ValidationFailed, unknown_name
from robotraj._util.values import dataclass
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
    drift : float or None
        Largest open-loop drift through all phases: joint positions [rad, m] as it is, joint velocities times
        10 max(1, largest planned value), the states of Systems times max(1, largest planned value).
    limits : float
        Largest violation of a limit or constraint, in the SI unit of its row.
    energy : float or None
        |imbalance| of the energy balance relative to the energy that moved.
    residual : float or None
        Residual of the equations between collocation points and jump at knots, in the unit of each.
    phase_drift : float or None
        As ``drift``, each phase from its own planned first state: of plans with contacts, whose open-loop motion is
        unstable and loses any plan in the end.
    contact : float or None
        Largest slip [m], sink [m] and turn [rad] of a contact between collocation points.
    forces : float or None
        How far normal force, friction and centre of pressure may be broken between collocation points, as a part of the
        robot's weight; of impacts, as a part of the impulse.
    """

    drift: float | None = 1e-3
    limits: float = 1e-3
    energy: float | None = None
    residual: float | None = None
    phase_drift: float | None = 1e-3
    contact: float | None = 1e-4
    forces: float | None = 1e-3


@dataclass(frozen=True)
class Report:
    """The proof of a plan, or what is wrong with it.

    Attributes
    ----------
    drift : Drift
        By state: final and largest distance between the simulated and the planned motion.
    violations : tuple of Violation
        Bounds broken by more than a solver's tolerance, the worst first.
    energy : Energy or None
        None for Systems, whose energy is not known.
    residual : Residual
    failure : str or None
        Why and when the simulation stopped before the end; None if it did not.
    tolerances : Tolerances
        The thresholds of ``passed``.
    duration : float
        Of the plan [s].
    intervals : int
        Of all phases.
    phases : tuple of str
        Names of the phases.
    rtol, atol : float
        Tolerances of the simulation's steps.
    unchecked : tuple of str
        Rows of the problem that a file could not keep and that were not checked.
    restarted : Drift or None
        Drift of each phase from its own planned first state; None where no phase has contacts.
    landings : tuple of Landing
        Where the simulation through all phases set its contacts down.
    holdings : tuple of Holding
        How every contact of every phase holds: slip, sink, forces.
    impacts : tuple of Impact
    stiff : float or None
        Time [s] from which on LSODA integrated, since DOP853 took too many steps there.
    """

    drift: Drift
    violations: tuple[Violation, ...]
    energy: Energy | None
    residual: Residual
    failure: str | None
    tolerances: Tolerances
    duration: float
    intervals: int
    phases: tuple[str, ...]
    rtol: float
    atol: float
    unchecked: tuple[str, ...] = ()
    restarted: Drift | None = None
    landings: tuple[Landing, ...] = ()
    holdings: tuple[Holding, ...] = ()
    impacts: tuple[Impact, ...] = ()
    stiff: float | None = None

    @property
    def passed(self) -> bool:
        """Whether the simulation ended and everything lies within ``tolerances``."""
        return not self.complaints(self.tolerances)

    def complaints(self, tolerances: Tolerances) -> tuple[str, ...]:
        """One sentence for each kind of figure that exceeds its tolerance, naming the worst offender."""
        found = []
        if self.unchecked:
            found.append(
                f"Not checked, because the file could not keep it: {'; '.join(self.unchecked)}. "
                "Give problem= to rt.load_solution."
            )
        if self.failure is not None:
            found.append(f"The simulation stopped early: {self.failure}.")
        elif tolerances.drift is not None and self.drift.worst.relative > tolerances.drift:
            found.append(self._drifts(self.drift.worst, tolerances.drift, "drifts from the plan"))
        if self.restarted is not None and tolerances.phase_drift is not None:
            row = self.restarted.worst
            if row.relative > tolerances.phase_drift:
                found.append(self._drifts(row, tolerances.phase_drift, "of one phase by itself drifts from the plan"))
        found += contact_complaints(
            self.holdings, self.impacts, tolerances.contact, tolerances.forces, tolerances.limits
        )
        if self.violations and (worst := self.violations[0]).amount > tolerances.limits:
            more = sum(v.amount > tolerances.limits for v in self.violations) - 1
            others = f", and {more} more" if more else ""
            found.append(f"A bound is broken: {worst}{others}; {tolerances.limits:.3g} is allowed.")
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

    def _drifts(self, row: DriftRow, tolerance: float, what: str) -> str:
        return (
            f"The simulation {what}: {row.name} by {row.largest:.3g} {row.unit}".rstrip()
            + f" at t = {row.time:.4g} s in phase {row.phase!r}, {tolerance * row.scale:.3g} is allowed; "
            + self._advice()
        )

    def _advice(self) -> str:
        """Say what to do about a drift: close the gaps of an unfinished solve first, else refine."""
        jump = max(self.residual.jumps.values(), key=lambda peak: peak.value, default=None)
        if jump is not None and jump.value > SOLVER_NOISE:
            gap = f"{jump.name} by {jump.value:.3g} {jump.unit}".rstrip()
            when = f"t = {jump.time:.4g} s"
            return f"the plan itself jumps at the knot at {when}, {gap}: its solve has not converged."
        return "use a finer mesh or a scheme of higher order, or track() if the motion is unstable."

    def __str__(self) -> str:
        return render(self)


def _largest(residual: Residual) -> Peak | None:
    parts = (residual.dynamics, residual.rate, residual.jumps)
    every = [peak for part in parts for peak in part.values()]
    return max(every, key=lambda peak: peak.value, default=None)
