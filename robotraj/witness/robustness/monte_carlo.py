"""Many simulations of a plan in MuJoCo under its own gains, each with other disturbances."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine, wrapped
from robotraj._util.values import dataclass
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.robustness.control_loop import Loop, above_zero, generators, whole
from robotraj.witness.robustness.disturbances import Disturbances

if TYPE_CHECKING:
    from matplotlib.figure import Figure


CONFIDENCE = 1.96
"""Standard deviations of a 95 percent interval."""
SHARES = (50, 90, 100)
"""Percentiles that the funnel plot draws."""


@dataclass(frozen=True, eq=False)
class MonteCarlo(OneLine):
    """The runs of ``monte_carlo``.

    Attributes
    ----------
    times : ndarray (m,)
        Times of the controller's periods [s].
    deviations : ndarray (runs, m)
        Largest deviation of a joint's position from the plan [rad, m]; infinite after a simulation diverged.
    used : ndarray (runs,)
        Largest feedback torque relative to the reserve of its motor; above 1 the motor saturated. The reserve is the
        distance of the planned torque from the limit of effort in the direction of the feedback.
    bound : float
        Largest deviation of a run that counts as held [rad, m].
    seed : int
    disturbances : Disturbances
    how : str
        Description of the simulator.
    """

    times: Array
    deviations: Array
    used: Array
    bound: float
    seed: int
    disturbances: Disturbances
    how: str

    @property
    def worst(self) -> Array:
        """Largest deviation of each run (runs,)."""
        return np.asarray(self.deviations.max(axis=1))

    @property
    def held(self) -> float:
        """Share of the runs that stayed within the bound."""
        return float(np.mean(self.worst <= self.bound))

    @property
    def interval(self) -> tuple[float, float]:
        """Interval of 95 percent confidence of ``held``.

        Source: Wilson, Probable inference, the law of succession, and statistical inference, J. Amer. Statist. Assoc.
        22 (1927).
        """
        n, z = len(self.deviations), CONFIDENCE
        centre = (self.held + 0.5 * z**2 / n) / (1.0 + z**2 / n)
        half = z / (1.0 + z**2 / n) * np.sqrt(self.held * (1.0 - self.held) / n + 0.25 * z**2 / n**2)
        return max(0.0, float(centre - half)), min(1.0, float(centre + half))

    def plot(self) -> Figure:
        """Draw the funnel: percentiles of the deviation over time, and the bound.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from matplotlib.figure import Figure

        figure = Figure(figsize=(7.0, 3.5), layout="constrained")
        axes = figure.subplots()
        finite = np.where(np.isfinite(self.deviations), self.deviations, np.nan)
        for share in SHARES:
            curve = np.nanpercentile(finite, share, axis=0)
            axes.fill_between(self.times, 0.0, curve, alpha=0.25, color="C0", linewidth=0.0)
            axes.plot(self.times, curve, color="C0", linewidth=1.0, label=f"{share} percent of the runs")
        axes.axhline(self.bound, color="C3", linestyle="--", label="bound")
        axes.set(xlabel="t [s]", ylabel="largest deviation [rad, m]", xlim=(self.times[0], self.times[-1]))
        axes.legend(loc="upper left")
        return figure

    def __str__(self) -> str:
        low, high = self.interval
        kept = int(np.sum(self.worst <= self.bound))
        lines = wrapped(
            f"{kept} of {len(self.worst)} runs stayed within {self.bound:g} rad or m of the plan: "
            f"{100 * low:.1f} to {100 * high:.1f} percent with 95 percent confidence"
        )
        middle, most = np.median(self.worst), self.worst.max()
        lines += wrapped(f"largest deviation: median {middle:.2e}, most {most:.2e}", "  ")
        lines += wrapped(
            f"share of the torque reserve: median {np.median(self.used):.2g}, most {self.used.max():.2g}", "  "
        )
        lines += wrapped(f"seed {self.seed}, {self.how}", "  ")
        if kept < len(self.worst):
            lines += wrapped(
                "try: rt.witness.disturbance_margin finds the disturbances that the plan tolerates; another optimum of "
                "rt.multistart may tolerate more",
                "  ",
            )
        return "\n".join(lines)


def monte_carlo(
    solution: SolutionLike,
    runs: int = 100,
    *,
    disturbances: Disturbances | None = None,
    bound: float = 0.1,
    seed: int = 0,
    rate: float = 1000.0,
) -> MonteCarlo:
    """Simulate a plan in MuJoCo many times under tau = tau_plan - K(t) e, with random disturbances.

    The controller measures positions and velocities with noise at its rate. After the delay it applies the torque of
    ``solution.gains``, clipped at the phase's limits of effort, for one period.

    Parameters
    ----------
    solution : Solution
        A plan of a robot with a fixed root and without contacts. ``rt.witness.second_opinion`` simulates others.
    runs : int
    disturbances : Disturbances, optional
    bound : float
        Largest deviation of a joint's position that counts as held [rad, m].
    seed : int
        The same seed gives the same runs.
    rate : float
        Rate of the controller [Hz].

    Returns
    -------
    MonteCarlo
        ``print`` shows the share of runs that stayed within the bound and its interval of confidence.

    Raises
    ------
    InputError
        MuJoCo is not installed, the plan has contacts, a moving root or no robot, or a number is not above 0.
    """
    loop = Loop(solution, rate, "rt.witness.monte_carlo")
    whole(runs=runs)
    above_zero(bound=bound)
    drawn = disturbances or Disturbances()
    found = [loop.run(drawn, rng) for rng in generators(seed, runs)]
    deviations, used = np.array([each for each, _ in found]), np.array([share for _, share in found])
    return MonteCarlo(loop.times, deviations, used, float(bound), seed, drawn, loop.how)
