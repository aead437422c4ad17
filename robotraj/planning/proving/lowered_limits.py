"""Limits of controls, lowered on the intervals where a motion exceeds them between its points."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from robotraj._util.lazy_values import LazySequence
from robotraj.planning.nlp_violations import between_points
from robotraj.problem.problem import Problem
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution
from robotraj.solution.violation import Violation
from robotraj.transcription.interval_limits.interval_violations import IntervalViolation, variable_violations
from robotraj.transcription.interval_limits.margins import LimitedInterval

MORE = 1.1
"""Ratio of a margin to the excess; above 1, since the motion changes with the margin."""


class LoweredLimits:
    """The margins of one mesh, from solve to solve.

    Attributes
    ----------
    amounts : dict
        Margin by which the limit of a row is lowered on an interval, in the unit of the row.
    """

    def __init__(self) -> None:
        self.amounts: dict[LimitedInterval, float] = {}
        self._found: LazySequence[IntervalViolation] = LazySequence(list)

    def measure(self, solution: Solution) -> None:
        """Take the excess of another solution from now on."""
        self._found = LazySequence(partial(_exceeded, solution.phases))

    @property
    def found(self) -> Sequence[IntervalViolation]:
        """Limits that the solution exceeds between its points, found when first read."""
        return self._found

    def violations(self, problem: Problem) -> LazySequence[Violation]:
        """Return them as violations of a solution, computed at first use: many plans need none."""
        return LazySequence(partial(between_points, problem, self._found))

    def lower(self) -> None:
        """Lower the limits that were exceeded."""
        for violation in self.found:
            place = LimitedInterval(violation.phase, violation.interval, violation.row.number)
            self.amounts[place] = self.amounts.get(place, 0.0) + MORE * violation.amount


def _exceeded(phases: Sequence[PhaseSolution]) -> list[IntervalViolation]:
    return [
        violation
        for i, part in enumerate(phases)
        for violation in variable_violations(part.phase, i, part.trajectory, part.inputs)
    ]
