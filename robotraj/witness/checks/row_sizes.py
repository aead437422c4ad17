"""The sizes of the rows of constraints in a planned motion, to which their violations are relative."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.problem.constraints.base import BoundConstraint, Where
from robotraj.problem.phase_row import PhaseRow
from robotraj.problem.sizes.motion_sizes import MotionSizes, same_variables
from robotraj.witness.checks.watch import Watch
from robotraj.witness.protocols import PhaseSolutionLike


@dataclass(frozen=True, eq=False)
class RowSizes:
    """Sizes of the rows of a phase in its motion (``problem.motion_sizes``).

    Attributes
    ----------
    planned : PhaseSolution
    phases : sequence of PhaseSolution
        All phases of the motion: those with the same variables share their sizes.
    """

    planned: PhaseSolutionLike
    phases: Sequence[PhaseSolutionLike]

    def measure(self, constraint: BoundConstraint, watches: list[Watch]) -> None:
        """Give each violated watch of a constraint the size of its row at its worst time, or over the phase.

        Rows that define variables of the objective, and rates, which are no functions of a point, are left out.
        """
        if constraint.source is None or constraint.where is Where.RATE:
            return
        integral = constraint.where is Where.INTEGRAL
        for entry, watch in enumerate(watches):
            if watch.is_violated:
                row = self._row(constraint, entry)
                motion = _sampled(self.planned, self._times if integral else np.array([watch.nearest]))
                changes = self._motion_sizes.changes([row], self.planned.phase.rows.sample, *motion)[:, 0]
                watch.size = row.size_in(float(np.trapezoid(changes, motion[0]) if integral else changes[0]))

    def _row(self, constraint: BoundConstraint, entry: int) -> PhaseRow:
        table = self.planned.phase.rows
        return next(r for r in table if r.entry == entry and table.constraints[r.constraint] is constraint)

    @cached_property
    def _times(self) -> Array:
        return _times_of(self.planned)

    @cached_property
    def _motion_sizes(self) -> MotionSizes:
        same = same_variables([each.phase for each in self.phases], self.planned.phase)
        table = self.planned.phase.rows
        motions = (_sampled(self.phases[i], _times_of(self.phases[i])) for i in same)
        return reduce(MotionSizes.joined, (MotionSizes.of(table, *motion) for motion in motions))


def _times_of(planned: PhaseSolutionLike) -> Array:
    knots = np.asarray(planned.knots, dtype=float)
    return np.unique(np.concatenate([knots, 0.5 * (knots[1:] + knots[:-1])]))


def _sampled(planned: PhaseSolutionLike, times: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return times (m,), states, algebraic variables and controls (m, n), and parameters (np,)."""
    phase, sample = planned.phase, planned.at(times)
    dae = phase.dae
    x, z, u = (
        np.array([named[v.name] for v in kind], dtype=float).reshape(len(kind), len(times)).T
        for named, kind in ((sample.x, dae.states), (sample.z, dae.algebraic), (sample.u, dae.controls))
    )
    return times, x, z, u, np.array([planned.parameters[name] for name in phase.parameter_names], dtype=float)
