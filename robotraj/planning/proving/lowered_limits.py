"""Limits of controls that a motion exceeds between its points, lowered there by the excess."""

from __future__ import annotations

from robotraj.solution.solution import Solution
from robotraj.transcription.interval_limits.interval_violations import IntervalViolation, variable_violations
from robotraj.transcription.interval_limits.margins import LimitedInterval

MORE = 1.1
"""Margins are this many times the excess: what they change moves the motion, and its excess with it."""


class LoweredLimits:
    """The margins of one mesh, from solve to solve.

    Attributes
    ----------
    found : list of IntervalViolation
        Limits that the solution that was measured last exceeds.
    amounts : dict
        By how much the limits of rows are lowered on intervals, in their SI unit.
    """

    def __init__(self) -> None:
        self.found: list[IntervalViolation] = []
        self.amounts: dict[LimitedInterval, float] = {}

    def measure(self, solution: Solution) -> None:
        """Find the limits that a solution exceeds between its points."""
        self.found = [
            violation
            for i, part in enumerate(solution.phases)
            for violation in variable_violations(part.phase, i, part.trajectory, part.inputs)
        ]

    def lower(self) -> None:
        """Lower the limits that were exceeded."""
        for violation in self.found:
            place = LimitedInterval(violation.phase, violation.interval, violation.row.number)
            self.amounts[place] = self.amounts.get(place, 0.0) + MORE * violation.amount
