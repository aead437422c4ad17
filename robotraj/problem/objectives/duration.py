"""The duration of a phase as a cost."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj._util.errors import warn
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import Point
from robotraj.problem.objectives.base import EndCost
from robotraj.problem.phase import Phase
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


def warn_of_fixed_durations(phases: Sequence[Phase]) -> None:
    """Doubt phases whose objective is the duration alone and whose duration is fixed."""
    for phase in phases:
        terms = phase.objective.terms if phase.objective is not None else ()
        given, longest = phase.duration_bounds
        if given == longest and terms and all(isinstance(term, Duration) for _, term in terms):
            warn(
                f"Phase {phase.name!r}: the objective is the duration alone, which is fixed at {given:g} s, so every "
                f"motion has the same objective. Give duration=({0.1 * given:g}, {5.0 * given:g}) for the least time, "
                "or minimise rt.Effort()."
            )
