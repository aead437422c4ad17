"""The disturbances that a plan tolerates under its own gains: the largest factor at which no run is lost."""

from __future__ import annotations

from robotraj._util.printing import OneLine, wrapped
from robotraj._util.values import dataclass
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.robustness.control_loop import Loop, above_zero, generators, whole
from robotraj.witness.robustness.disturbances import Disturbances
from robotraj.witness.robustness.monte_carlo import MonteCarlo, monte_carlo

LARGEST, LEAST = 10.0, 1e-3
"""Factors between which the search takes place."""
STEP = 1.1
"""Ratio of two factors at which the search ends."""
SAFETY = 0.8
"""Stated factor relative to the largest one at which no run of the search was lost."""


@dataclass(frozen=True, eq=False)
class DisturbanceMargin(OneLine):
    """The disturbances that a plan tolerates, found by ``disturbance_margin``.

    Attributes
    ----------
    factor : float
        Factor of the given disturbances that is stated; 0 where the plan is lost under the least of them.
    runs : MonteCarlo
        Runs at ``factor`` with random numbers that the search did not see. Their share is an unbiased estimate.
    """

    factor: float
    runs: MonteCarlo

    @property
    def disturbances(self) -> Disturbances:
        """The tolerated disturbances: ``factor`` times those given."""
        return self.runs.disturbances

    def __str__(self) -> str:
        most = "at least " if self.factor >= SAFETY * LARGEST else ""
        return "\n".join(
            [
                *wrapped(f"the plan tolerates {most}{self.factor:.2g} times the disturbances"),
                *str(self.runs).splitlines(),
            ]
        )


def disturbance_margin(
    solution: SolutionLike,
    runs: int = 100,
    *,
    disturbances: Disturbances | None = None,
    bound: float = 0.1,
    seed: int = 0,
    rate: float = 1000.0,
) -> DisturbanceMargin:
    """Find the factor of the disturbances up to which a plan is held under its own gains.

        factor = 0.8 max {f : every one of ``runs`` runs under f times the disturbances stays within the bound}

    A run keeps its random numbers while f changes, and counts as held below a factor at which it was held. The search
    takes place between 0.001 and 10 and ends within 10 percent. Further ``runs`` runs with other random numbers then
    test the factor.

    Parameters
    ----------
    solution : Solution
        A plan of a robot with a fixed root and without contacts.
    runs : int
        Number of runs of the search, and of the test.
    disturbances, bound, rate
        See ``rt.witness.monte_carlo``.
    seed : int
        ``rt.witness.monte_carlo`` with ``margin.disturbances`` and the same seed repeats the runs of the test.

    Returns
    -------
    DisturbanceMargin

    Raises
    ------
    InputError
        See ``rt.witness.monte_carlo``.
    """
    loop = Loop(solution, rate, "rt.witness.disturbance_margin")
    whole(runs=runs)
    above_zero(bound=bound)
    given, factor = disturbances or Disturbances(), LARGEST

    def held(run: int, scale: float) -> bool:
        (rng,) = generators(seed, 1, runs + run)
        return bool(loop.run(given.scaled(scale), rng)[0].max() <= bound)

    for run in range(runs):
        if held(run, factor):
            continue
        low = LEAST
        if not held(run, low):
            factor = 0.0
            break
        while factor > STEP * low:
            middle = (low * factor) ** 0.5
            low, factor = (middle, factor) if held(run, middle) else (low, middle)
        factor = low
    factor *= SAFETY
    found = monte_carlo(solution, runs, disturbances=given.scaled(factor), bound=bound, seed=seed, rate=rate)
    return DisturbanceMargin(factor, found)
