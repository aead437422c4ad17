"""The duration of a phase as a cost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from robotraj._util.values import dataclass
from robotraj.dynamics.point import Point
from robotraj.problem.objectives.base import EndCost

if TYPE_CHECKING:
    from robotraj.dynamics.dae import Dynamics
    from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class Duration(EndCost):
    """Duration of the phase, t_end - t_start [s].

    With least time alone, torques that do not affect the time are not determined and may oscillate. A small weight of
    effort determines them: ``rt.Duration() + 1e-3 * rt.Effort()``. With T* and E* the time and effort of the fastest
    motion, the time T found with weight w and effort E satisfies T* <= T <= T* + w (E* - E).
    """

    def value(self, start: Point, end: Point) -> Scalar:
        """Duration [s]."""
        return end.t - start.t

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Accept any dynamics."""
