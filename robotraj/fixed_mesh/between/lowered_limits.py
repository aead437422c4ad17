"""Limits of variables and path rows, lowered on the intervals where a motion exceeds them between its points."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from robotraj._util.lazy_values import LazySequence
from robotraj._util.precision import MET
from robotraj.fixed_mesh.between.nlp_violations import between_points
from robotraj.problem.phase_row import Kind
from robotraj.problem.problem import Problem
from robotraj.solution.phase_solution import PhaseSolution, alike
from robotraj.solution.solution import Solution
from robotraj.solution.violation import Violation
from robotraj.transcription.interval_limits.interval_violations import (
    EXACT,
    IntervalViolation,
    state_violations,
    variable_violations,
)
from robotraj.transcription.interval_limits.row_places import LimitedInterval

MORE = 1.1
"""Ratio of a margin to the excess; above 1, since the motion changes with the margin."""


class LoweredLimits:
    """The margins of one mesh, from solve to solve; states are those of exact motions.

    Attributes
    ----------
    amounts : dict
        Margin by which the limit of a row is lowered on an interval, in the unit of the row.
    """

    def __init__(self) -> None:
        self.amounts: dict[LimitedInterval, float] = {}
        self._of_rows: Sequence[IntervalViolation] = ()
        self._of_states: LazySequence[IntervalViolation] = LazySequence(list)
        self._of_controls: LazySequence[IntervalViolation] = LazySequence(list)

    def measure(self, solution: Solution, of_rows: Sequence[IntervalViolation] = ()) -> None:
        """Take the excess of another solution from now on; it is found when first read.

        Parameters
        ----------
        solution : Solution
        of_rows : sequence of IntervalViolation
            Excess over path rows that is lowered too.
        """
        self._of_rows = [each for each in of_rows if not _is_lowered_path(solution.phases[each.phase])]
        self._of_states = LazySequence(partial(_states, solution.phases))
        self._of_controls = LazySequence(partial(_controls, solution.phases))

    @property
    def found(self) -> list[IntervalViolation]:
        """Limits that the solution exceeds between its points."""
        return [*self._of_controls, *self._of_states, *self._of_rows]

    def violations(self, problem: Problem) -> LazySequence[Violation]:
        """Return those of controls as violations of a solution, computed at first use: many plans need none."""
        return LazySequence(partial(between_points, problem, self._of_controls))

    def lower(self) -> None:
        """Lower the limits that were exceeded by a little more than the excess."""
        for violation in self.found:
            place = LimitedInterval(violation.phase, violation.interval, violation.row.number)
            of_bound = MET * violation.row.greatest_bound if violation.row.kind is Kind.PATH else 0.0
            room = max(EXACT * min(1.0, violation.size), of_bound)
            self.amounts[place] = self.amounts.get(place, 0.0) + MORE * violation.amount + room


def _controls(phases: Sequence[PhaseSolution]) -> list[IntervalViolation]:
    return [
        violation
        for i, part in enumerate(phases)
        for violation in variable_violations(part.phase, i, part.trajectory, part.inputs, alike(part, phases))
    ]


def _states(phases: Sequence[PhaseSolution]) -> list[IntervalViolation]:
    """Find exceeded bounds of the robot's states in exact motions; states that an objective added are no motion.

    Rows on Bernstein coefficients bound the collocated positions. An exact motion integrates its speeds, so its
    positions differ from the collocated ones by some 1e-5 rad between the knots. A given end that is beyond a limit by
    round-off stays there, so nothing is lowered beside it for that.
    """
    found = []
    for i, part in enumerate(phases):
        if not part.exact:
            continue
        given = _given_ends_beyond(part)
        rows = part.phase.rows
        own = {bound.number for bound, _ in rows.bounds_of(part.phase.body.states)}
        if _is_lowered_path(part):
            own |= {row.number for row in rows.of_state}
        found += [
            violation
            for violation in state_violations(part.phase, i, part.trajectory, 0.0, alike(part, phases))
            if violation.row.number in own
            and violation.amount > given.get((violation.row.number, violation.interval), 0.0)
        ]
    return found


def _is_lowered_path(part: PhaseSolution) -> bool:
    """Whether rows of the state are lowered, too: on a path they leave the control no choice."""
    return part.exact and part.phase.path is not None


def _given_ends_beyond(part: PhaseSolution) -> dict[tuple[int, int], float]:
    """Return the room beside given ends beyond a limit, twice their excess, by number of row and interval."""
    phase, room = part.phase, dict[tuple[int, int], float]()
    for bound, state in phase.rows.bounds_of(phase.dae.states):
        for end, interval in ((phase.start_bounds, 0), (phase.end_bounds, part.mesh.count - 1)):
            low, high = float(end.lower[state]), float(end.upper[state])
            excess = max(bound.lower - low, high - bound.upper)
            if low == high and excess > 0.0:
                room[bound.number, interval] = 2.0 * excess
    return room
