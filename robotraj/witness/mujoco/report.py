"""What MuJoCo says of a plan, as a value that prints as a table."""

from __future__ import annotations

from collections.abc import Mapping

from robotraj._util.values import dataclass
from robotraj.witness.drift import Drift
from robotraj.witness.mujoco.table import render
from robotraj.witness.peak import Peak
from robotraj.witness.protocols import Array
from robotraj.witness.simulation import Simulation


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
        return render(self)
