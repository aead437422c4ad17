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

    With least time alone, torques that do not affect the time are not determined and may oscillate. Plans that are
    proved therefore minimise their mean square as well, with the small weight ``smoothing`` of ``rt.plan``. On a given
    mesh that weight is 0 unless it is given.
    """

    def value(self, start: Point, end: Point) -> Scalar:
        """Duration [s]."""
        return end.t - start.t

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Accept any dynamics."""


def fixed_duration_note(terms: Sequence[tuple[float, object]], bounds: tuple[float, float]) -> str:
    """Doubt an objective of durations alone where the duration is fixed; empty otherwise."""
    if bounds[0] < bounds[1] or not terms or not all(isinstance(term, Duration) for _, term in terms):
        return ""
    least, most = 0.1 * bounds[0], 5.0 * bounds[0]
    return (
        f"the objective is the duration alone, which is fixed at {bounds[0]:g} s, so every motion has the same "
        f"objective. Give duration=({least:g}, {most:g}) for the least time, or minimise rt.Effort()."
    )
