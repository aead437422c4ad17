"""The result of a simulation in MuJoCo, which prints as a report."""

from __future__ import annotations

import html
from collections.abc import Mapping
from typing import TYPE_CHECKING

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.witness.colours import coloured
from robotraj.witness.peak import Peak
from robotraj.witness.report_tables import table, worst_of, wrapped
from robotraj.witness.simulation.drift import Drift
from robotraj.witness.simulation.simulate import Simulation

if TYPE_CHECKING:
    from robotraj.witness.robustness.monte_carlo import MonteCarlo


@dataclass(frozen=True)
class FootReport(OneLine):
    """The stances of one foot.

    Attributes
    ----------
    name : str
        Name of the contact.
    slip : float
        Largest distance along the ground from the place of touchdown, in any one stance [m].
    sink : float
        Largest penetration of the soft ground [m].
    force : ndarray (3,)
        Mean contact force over the whole motion, impacts included, world axes [N].
    planned : ndarray (3,) or None
        Mean contact force of the plan; None where the robot did not complete it.
    loaded : float
        Fraction of the time with load.
    stances : int
        Number of touchdowns, the start included.
    """

    name: str
    slip: float
    sink: float
    force: Array
    planned: Array | None
    loaded: float
    stances: int


@dataclass(frozen=True, repr=False)
class SecondOpinion(OneLine):
    """The motion of a robot that followed a plan in MuJoCo.

    Attributes
    ----------
    simulation : Simulation
        Every step of the motion, in Pinocchio's coordinates.
    deviation : Drift
        By state: final and largest distance from the plan. A floating root deviates by positions along world axes and
        a rotation vector in its own axes (``q.root_rx`` ...).
    feet : tuple of FootReport
    effort : mapping of str to Peak
        By motor: largest torque that the feedback added [N m, N].
    saturated : float
        Largest share of the time that a motor was at its effort limit.
    fell : float or None
        Time at which the robot fell [s]; None if it did not, or if its root does not move.
    failure : str or None
        Reason and time of a fall or of an early stop of the simulation; None if the robot completed the plan.
    periods : int
    duration : float
        Planned duration of all periods [s].
    lag : float
        Time by which touchdowns delayed the plan [s]: each phase begins with its own touchdown.
    step : float
        Longest step of MuJoCo [s].
    feedback : str
        Description of the feedback.
    simulator : str
        MuJoCo's version, its integrator and its contacts.
    robustness : MonteCarlo or None
        Runs with random disturbances, if any were asked for; they do not change the verdict.
    """

    simulation: Simulation
    deviation: Drift
    feet: tuple[FootReport, ...]
    effort: Mapping[str, Peak]
    saturated: float
    fell: float | None
    failure: str | None
    periods: int
    duration: float
    lag: float
    step: float
    feedback: str
    simulator: str
    robustness: MonteCarlo | None = None

    @property
    def completed(self) -> bool:
        """Whether the robot completed all periods without a fall."""
        return self.failure is None and self.fell is None

    @property
    def upright(self) -> bool:
        """Whether the robot did not fall while it was simulated."""
        return self.fell is None

    @property
    def slip(self) -> float:
        """Largest slip of any foot [m]."""
        return max((foot.slip for foot in self.feet), default=0.0)

    @property
    def sink(self) -> float:
        """Largest penetration of the ground by any foot [m]."""
        return max((foot.sink for foot in self.feet), default=0.0)

    @property
    def verdict(self) -> str:
        """``"PASSED"`` where the robot completed the plan, else ``"FAILED"``."""
        return "PASSED" if self.completed else "FAILED"

    def __repr__(self) -> str:
        largest = self.deviation.worst
        return (
            f"<SecondOpinion {self.verdict}: {self.periods} periods, {self.duration:.4g} s, largest deviation "
            f"{largest.largest:.2g} {largest.unit}>"
        )

    def __str__(self) -> str:
        return _render(self, coloured(self.verdict))

    def _repr_html_(self) -> str:
        """Show the report in a notebook."""
        return f'<pre style="line-height:1.2">{html.escape(_render(self, self.verdict))}</pre>'


def _render(report: SecondOpinion, verdict: str) -> str:
    """Return the deviation, the feet, the effort of the feedback and the verdict."""
    times = "once" if report.periods == 1 else f"{report.periods} times"
    lines = [f"MuJoCo follows the plan {times}, {report.duration:.6g} s"]
    lines += wrapped(report.feedback) + wrapped(f"{report.simulator}, steps of {report.step:.2g} s")
    if report.lag:
        lines.append(f"  touchdowns came {abs(report.lag):.2g} s {'later' if report.lag > 0 else 'sooner'} in all")
    rows, others = worst_of(report.deviation.rows, lambda row: row.relative)
    cells = [[r.name, f"{r.final:.2e}", f"{r.largest:.2e}", f"{r.time:.4f}", r.unit] for r in rows]
    lines += [
        f"  deviation: |simulated - planned|{others}",
        *table(("state", "final", "largest", "at t [s]", "unit"), cells),
        "",
    ]
    if report.feet:
        cells = [
            [
                foot.name,
                f"{foot.slip:.1e}",
                f"{foot.sink:.1e}",
                f"{100 * foot.loaded:.0f} %",
                str(foot.stances),
                _vector(foot.force),
                "" if foot.planned is None else _vector(foot.planned),
            ]
            for foot in report.feet
        ]
        headers = ("foot", "slip [m]", "sink [m]", "loaded", "stances", "mean force [N]", "planned")
        lines += [*table(headers, cells), ""]
    strongest = sorted(report.effort.values(), key=lambda peak: -peak.value)[:3]
    added = ", ".join(f"{p.name} {p.value:.3g} {p.unit}" for p in strongest)
    lines += wrapped(
        f"feedback added at most {added}; a motor was at its limit {100 * report.saturated:.1f} % of the time"
    )
    if report.robustness is not None:
        lines += str(report.robustness).splitlines()
    if report.failure is not None:
        lines += wrapped(report.failure, "  ! ", "    ")
    return "\n".join([*lines, f"{verdict}: {_outcome(report)}"])


def _outcome(report: SecondOpinion) -> str:
    if report.fell is not None:
        return f"the robot fell at t = {report.fell:.4g} s"
    if report.failure is not None:
        return "the simulation stopped"
    return "the robot completed the plan" + (", upright" if report.feet else "")


def _vector(values: Array) -> str:
    return " ".join(f"{value:.1f}" for value in values)
