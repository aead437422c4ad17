"""The plan of one step of a control loop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass

if TYPE_CHECKING:
    from robotraj.solution.phase_solution import PhaseSolution
    from robotraj.solution.sample import Sample
    from robotraj.solvers.status import Status


@dataclass(frozen=True, eq=False)
class Replan(OneLine):
    """The plan of one step, returned by ``Replanner.step``.

    Attributes
    ----------
    t : float
        Time of the step [s], on the clock of the caller.
    motion : PhaseSolution
        The planned motion, on the same clock; of a gait its current phase.
    fresh : bool
        Whether the iterate of this step meets its rows. Otherwise ``motion`` is that of the last step that did.
    status : Status
        How the solve of this step ended; ``Status.TIME_LIMIT`` at the deadline.
    violation : float
        Largest violation of a scaled row by the iterate of this step, evaluated outside the solver.
    iterations : int
    seconds : float
        Wall-clock time of the step.
    later : tuple of PhaseSolution
        The phases of a gait after the current one.
    """

    t: float
    motion: PhaseSolution
    fresh: bool
    status: Status
    violation: float
    iterations: int
    seconds: float
    later: tuple[PhaseSolution, ...] = ()

    @property
    def start(self) -> float:
        """Time of the measurement that the plan starts from [s]."""
        return self.motion.t0

    @property
    def end(self) -> float:
        """Time at which the plan ends [s]."""
        last = (self.motion, *self.later)[-1]
        return last.t0 + last.duration

    @overload
    def at(self, t: float) -> Sample[float]: ...
    @overload
    def at(self, t: Array) -> Sample[Array]: ...
    @overload
    def at(self, t: float | Array) -> Sample[Any]: ...

    def at(self, t: float | Array) -> Sample[Any]:
        """Evaluate the plan at a time, or at times (m,), on the clock of the caller [s].

        Times before the start and after the end are taken as the start and the end. Several times lie in one phase.
        """
        times = self.within(t)
        part = next((each for each in self.later[::-1] if np.min(times) >= each.t0), self.motion)
        return part.at(times)

    def within(self, t: float | Array) -> Array:
        """Return times, those outside the plan moved to its ends [s]."""
        return np.clip(np.asarray(t, dtype=float), self.start, self.end)

    def __str__(self) -> str:
        kept = "" if self.fresh else ", plan of an earlier step kept"
        return (
            f"{self.status.value} after {self.iterations} iterations, {1e3 * self.seconds:.1f} ms, largest violation "
            f"{self.violation:.1e}{kept}"
        )
