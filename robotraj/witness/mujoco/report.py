"""What MuJoCo says of a plan, as a value that prints as a table."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Mapping

from rich.console import Console

from robotraj._util.values import dataclass
from robotraj.witness.layout import WIDTH, columns_of, worst_of
from robotraj.witness.peak import Peak
from robotraj.witness.protocols import Array
from robotraj.witness.simulation.drift import Drift
from robotraj.witness.simulation.robot import Simulation


@dataclass(frozen=True)
class FootReport:
    """How one foot stood.

    Attributes
    ----------
    name : str
        The contact's.
    slip : float
        Farthest that it slid along the ground from where it came down, in any one stance [m].
    sink : float
        Deepest that it went into the soft ground [m].
    force : ndarray (3,)
        Mean contact force over the whole motion, impacts included, world axes [N].
    planned : ndarray (3,) or None
        The same of the plan; None where the plan does not tell forces.
    loaded : float
        Share of the time that it was on the ground.
    stances : int
        How often it came down, the start included.
    """

    name: str
    slip: float
    sink: float
    force: Array
    planned: Array | None
    loaded: float
    stances: int


@dataclass(frozen=True)
class SecondOpinion:
    """How MuJoCo moved the robot that followed the plan.

    Attributes
    ----------
    simulation : Simulation
        The motion, every step of it, in Pinocchio's coordinates.
    deviation : Drift
        By state: final and largest distance from the plan. Of a floating root, positions along world axes and a
        rotation vector in the body's (``q.root_rx`` ...).
    feet : tuple of FootReport
    effort : mapping of str to Peak
        By motor: largest torque that the feedback added [N m, N].
    saturated : float
        Largest share of the time that a motor was at its effort limit.
    fell : float or None
        When the robot fell [s]; None if it stayed up, or if its root does not move.
    failure : str or None
        Why and when the simulation stopped early; None if it did not.
    periods : int
    duration : float
        Of all periods, as planned [s].
    lag : float
        How much longer they took, because feet came down when they did [s].
    step : float
        Longest step of MuJoCo [s].
    feedback : str
        What held the robot on its plan.
    simulator : str
        MuJoCo's version, its integrator and its contacts.
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

    @property
    def completed(self) -> bool:
        """Whether the robot came through all periods without falling."""
        return self.failure is None and self.fell is None

    @property
    def upright(self) -> bool:
        """Whether it never fell as long as it was simulated."""
        return self.fell is None

    @property
    def slip(self) -> float:
        """Largest slip of any foot [m]."""
        return max((foot.slip for foot in self.feet), default=0.0)

    @property
    def sink(self) -> float:
        """Deepest any foot went into the ground [m]."""
        return max((foot.sink for foot in self.feet), default=0.0)

    def __str__(self) -> str:
        return _render(self)


def _render(report: SecondOpinion) -> str:
    """Lay out the verdict, the deviation, the feet and the effort of the feedback."""
    stream = io.StringIO()
    console = Console(file=stream, width=WIDTH, color_system=None, highlight=False, markup=False)
    times = "once" if report.periods == 1 else f"{report.periods} times"
    console.print(f"MuJoCo follows the plan {times}, {report.duration:.6g} s: {_verdict(report)}")
    for line in (report.feedback, f"{report.simulator}, steps of {report.step:.2g} s"):
        console.print(textwrap.fill(line, WIDTH, initial_indent="  ", subsequent_indent="    "))
    if report.lag:
        console.print(
            f"  touchdowns set the clock: {abs(report.lag):.2g} s {'later' if report.lag > 0 else 'sooner'} in all"
        )
    rows, left_out = worst_of(report.deviation.rows, lambda row: row.relative)
    console.print(f"  deviation: |simulated - planned|{left_out}")
    table = columns_of("state", "final", "largest", "at t [s]", "unit")
    for row in rows:
        table.add_row(row.name, f"{row.final:.2e}", f"{row.largest:.2e}", f"{row.time:.4f}", row.unit)
    console.print(table)
    if report.feet:
        table = columns_of("foot", "slip [m]", "sink [m]", "on ground", "stances", "mean force [N]", "planned")
        for foot in report.feet:
            planned = "" if foot.planned is None else _vector(foot.planned)
            table.add_row(
                foot.name,
                f"{foot.slip:.1e}",
                f"{foot.sink:.1e}",
                f"{100 * foot.loaded:.0f} %",
                str(foot.stances),
                _vector(foot.force),
                planned,
            )
        console.print("\n", table, sep="")
    peaks = sorted(report.effort.values(), key=lambda peak: -peak.value)[:3]
    added = ", ".join(f"{p.name} {p.value:.3g} {p.unit}" for p in peaks)
    console.print(
        f"\n  feedback added at most {added}; a motor was at its limit {100 * report.saturated:.1f} % of the time"
    )
    return "\n".join(line.rstrip() for line in stream.getvalue().rstrip().splitlines())


def _verdict(report: SecondOpinion) -> str:
    if report.failure is not None:
        return f"STOPPED: {report.failure}"
    if report.fell is not None:
        return f"FELL at t = {report.fell:.4g} s"
    return "COMPLETED, upright" if report.feet else "COMPLETED"


def _vector(values: Array) -> str:
    return " ".join(f"{value:.1f}" for value in values)
