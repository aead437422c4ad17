"""Limits between the collocation points of one mesh: rows are added there, and the problem is solved again.

Three groups of rows may fail between the points, and each has its own answer. Limits of the state get rows at their
peaks. Distances get further rows, or other planes (``clearing``). Limits of controls are lowered (``lowered_limits``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robotraj._util.time_left import used_time
from robotraj.guess.from_solution import FromSolution
from robotraj.planning.proving.clearing import ROUGH_SHORTFALL, ROUNDS, Clearing
from robotraj.planning.proving.lowered_limits import LoweredLimits
from robotraj.planning.proving.nlp_violations import between_points
from robotraj.planning.solve_nlp import solve_nlp
from robotraj.planning.warm_start import earlier_multipliers
from robotraj.problem.problem import Problem
from robotraj.solution.phase_solution import alike
from robotraj.solution.records import with_effort_of
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status
from robotraj.transcription.interval_limits.added_rows import exceeded_although_added, rows_to_add, with_added_rows
from robotraj.transcription.interval_limits.interval_violations import IntervalViolation, state_violations
from robotraj.transcription.interval_limits.margins import with_margins
from robotraj.transcription.interval_limits.row_places import AddedRow, Margins
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.reuse import continued_at
from robotraj.transcription.schemes.mesh import MovingMesh
from robotraj.transcription.transcribe import transcribe

if TYPE_CHECKING:
    from robotraj.transcription.clearance.surface_rows import NearSurfaces

Array = NDArray[np.float64]


class Posed(NamedTuple):
    """A transcribed problem with the rows that it has so far.

    Attributes
    ----------
    problem : Problem
    nlp, without_clearance : Nlp
        What is solved, and the same without rows on distances.
    clearing : Clearing
    added : tuple of AddedRow
        Rows between the points.
    surfaces : sequence of NearSurfaces or None
        For each phase, links of the robot that rows keep apart.
    """

    problem: Problem
    nlp: Nlp
    without_clearance: Nlp
    clearing: Clearing
    added: tuple[AddedRow, ...]
    surfaces: Sequence[NearSurfaces | None]

    @property
    def moving(self) -> bool:
        """Whether knots move."""
        return any(isinstance(layout.mesh, MovingMesh) for layout in self.nlp.layouts)

    def again(
        self,
        settings: Settings,
        solution: Solution,
        w: Array,
        new: Sequence[AddedRow],
        replaced: bool,
        margins: Margins,
    ) -> Posed:
        """Return the problem with new rows and lowered limits, from a solution with the decision vector w.

        Rows on distances are built again where these have further rows or other planes (``replaced``), not where bounds
        change.
        """
        added = (*self.added, *new)
        if self.moving:
            # Knots start again from those of the mesh, since moved knots stay on the arcs that they have reached.
            last = FromSolution(solution)
            base = transcribe(
                self.problem, settings.mesh, last, settings.engine, settings.interval_limits, settings.smoothing
            )
            base = with_surfaces(with_added_rows(base, added, base.guess), self.surfaces)
        else:
            base = with_added_rows(self.without_clearance, new, w) if new else continued_at(self.without_clearance, w)
        rebuilt = bool(self.clearing) and (bool(new) or replaced)
        nlp = with_margins(base if rebuilt or new or not self.clearing else continued_at(self.nlp, w), margins)
        nlp = self.clearing.rows(nlp) if rebuilt else nlp
        return self._replace(nlp=nlp, without_clearance=base, added=added)


def limited_between(
    posed: Posed,
    solution: Solution,
    w: Array,
    settings: Settings,
    progress: Progress | None,
    hold: Callable[[Solution], bool] | None,
    lower: bool,
) -> Solution:
    """Return a solution that holds its limits between the points, too, or lists where it exceeds them.

    Parameters
    ----------
    posed : Posed
    solution : Solution
        The first one.
    w : ndarray (n,)
        Its decision vector.
    settings : Settings
    progress : callable, optional
    hold : callable, optional
        Returns whether limits between the points are imposed; by default they always are.
    lower : bool
        Whether limits of controls that the motion exceeds between the points are lowered there.
    """
    limits, clearing, lowered = settings.interval_limits, posed.clearing, LoweredLimits()
    warm = settings.solver.from_nearby() if clearing or lower else settings.solver
    try:
        found, held = _measured(posed, solution, w, limits.tolerance, lowered, lower)
        limited = hold is None or hold(solution)
        rounds = limits.rounds if limited else 0
        for number in range(max(rounds, ROUNDS if clearing or lower else 0)):
            fresh = [each for each in found if each not in held]
            new = rows_to_add(posed.nlp, fresh, posed.added) if number < rounds else []
            exceeded = lower and limited and bool(lowered.found)
            settled = clearing.settled_after_rise if limits.rounds else clearing.settled
            replaced = not clearing.proved(0.0 if rounds else ROUGH_SHORTFALL) or not settled
            if not (new or exceeded or replaced) or not solution.success:
                break
            began = used_time()
            if exceeded:
                lowered.lower()
            next_one = posed.again(settings, solution, w, new, replaced, lowered.amounts)
            # Rows that are added between the points come before those on distances, whose numbers change.
            alike = not clearing or (clearing.numbered and not new and not posed.moving)
            known = earlier_multipliers(solution, next_one.nlp, True) if alike else None
            again, w = solve_nlp(next_one.nlp, solution, known, warm, progress, began)
            failed = not again.success and again.status is not Status.INTERRUPTED
            solution = with_effort_of(again, solution) if failed else with_effort_of(solution, again)
            if failed or not again.iterations:
                # A solve that ends where it starts changes nothing: further margins of this size would not either.
                break
            posed = next_one
            found, held = _measured(posed, solution, w, limits.tolerance, lowered, lower)
        left = (*clearing.violations(solution), *between_points(posed.problem, found))
    except KeyboardInterrupt:
        # Ctrl-C between two solves: the last solution is kept.
        return replace(solution, status=Status.INTERRUPTED, added_rows=posed.added)
    controls = lowered.violations(posed.problem)
    return replace(solution, added_rows=posed.added, interval_violations=left, control_interval_violations=controls)


def with_surfaces(nlp: Nlp, surfaces: Sequence[NearSurfaces | None]) -> Nlp:
    """Return the NLP with rows that keep links of the robots apart."""
    if not any(surfaces):
        return nlp
    from robotraj.transcription.clearance.surface_rows import with_surface_rows

    return with_surface_rows(nlp, surfaces)


def _measured(
    posed: Posed, solution: Solution, w: Array, allowed: float, lowered: LoweredLimits, lower: bool
) -> tuple[list[IntervalViolation], list[IntervalViolation]]:
    """Measure all three groups; return violated rows of the state, and those of them that lower limits answer."""
    found = [
        violation
        for i, part in enumerate(solution.phases)
        for violation in state_violations(part.phase, i, part.trajectory, allowed, alike(part, solution.phases))
    ]
    posed.clearing.measure(solution, posed.clearing.binds(posed.nlp, w))
    held = exceeded_although_added(posed.nlp, found, posed.added) if lower else []
    lowered.measure(solution, held)
    return found, held
