"""What the witness found, as a value that prints as a table and can refuse."""

from __future__ import annotations

from dataclasses import dataclass

from robotraj.errors import ValidationFailed
from robotraj.witness.drift import Drift
from robotraj.witness.energy import Energy
from robotraj.witness.peak import Peak
from robotraj.witness.residual import Residual
from robotraj.witness.table import render
from robotraj.witness.violations import SOLVER_NOISE, Violation


@dataclass(frozen=True)
class Tolerances:
    """Thresholds of ``Report.passed``; None reports a figure without judging it.

    Attributes
    ----------
    drift : float
        Largest open-loop drift: joint positions [rad, m] as it is, joint velocities times 10 max(1, largest
        planned value), the states of Systems times max(1, largest planned value).
    limits : float
        Largest violation of a limit or constraint, in the SI unit of its row.
    energy : float or None
        |imbalance| of the energy balance relative to the energy that moved.
    residual : float or None
        Residual of the equations between collocation points and jump at knots, in the unit of each.
    """

    drift: float = 1e-3
    limits: float = 1e-3
    energy: float | None = None
    residual: float | None = None


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
        elif (row := self.drift.worst).relative > tolerances.drift:
            allowed = tolerances.drift * row.scale
            found.append(
                f"The simulation drifts from the plan: {row.name} by {row.largest:.3g} {row.unit}".rstrip()
                + f" at t = {row.time:.4g} s in phase {row.phase!r}, {allowed:.3g} is allowed; "
                + self._advice()
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

    def check(
        self,
        drift: float | None = None,
        limits: float | None = None,
        energy: float | None = None,
        residual: float | None = None,
    ) -> None:
        """Raise unless the plan holds.

        Parameters
        ----------
        drift, limits, energy, residual : float, optional
            Thresholds as in ``Tolerances``; the report's own where None.

        Raises
        ------
        ValidationFailed
            Names the worst offender of each kind, with its joint and time; carries this report.
        """
        own = self.tolerances
        asked = Tolerances(
            own.drift if drift is None else drift,
            own.limits if limits is None else limits,
            own.energy if energy is None else energy,
            own.residual if residual is None else residual,
        )
        complaints = self.complaints(asked)
        if complaints:
            raise ValidationFailed(" ".join(complaints), self)

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
