"""Limits between the collocation points of one mesh: rows are added there, and the problem is solved again.

Three groups of rows may fail between the points, and each has its own answer. Limits of the state get rows at their
peaks. Distances get further rows, or other planes (``clearing``). Limits of controls are lowered (``lowered_limits``).
"""

from __future__ import annotations

from dataclasses import replace

from robotraj._util.arrays import Array
from robotraj._util.time_left import used_time
from robotraj.fixed_mesh.at_points import AtPoints
from robotraj.fixed_mesh.between.clearing import ROUGH_SHORTFALL, ROUNDS
from robotraj.fixed_mesh.between.lowered_limits import LoweredLimits
from robotraj.fixed_mesh.between.nlp_violations import between_points
from robotraj.fixed_mesh.posed import Posed
from robotraj.fixed_mesh.solve_nlp import solve_nlp
from robotraj.fixed_mesh.warm_start import earlier_multipliers
from robotraj.solution.phase_solution import alike
from robotraj.solution.records import with_effort_of
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status
from robotraj.transcription.interval_limits.added_rows import exceeded_although_added, rows_to_add
from robotraj.transcription.interval_limits.interval_violations import IntervalViolation, state_violations


def limited_between(
    attempt: AtPoints,
    settings: Settings,
    progress: Progress | None = None,
    imposed: bool = True,
    lower: bool = False,
) -> Solution:
    """Return a solution that holds its limits between the points, too, or lists where it exceeds them.

    Rows of the state that the solution violates between its collocation points are added there by
    ``settings.interval_limits``. The problem is then solved again from the last solution. If it cannot be solved with
    further rows, the solution without them is returned.

    Parameters
    ----------
    attempt : AtPoints
    settings : Settings
    progress : callable, optional
    imposed : bool
        Whether limits between the points are imposed. Without them, distances may fall short by ``ROUGH_SHORTFALL``.
    lower : bool
        Whether limits of controls that the motion exceeds between the points are lowered there (``lowered_limits``).
    """
    posed, solution, w = attempt
    if solution.status is Status.INTERRUPTED and not settings.interval_limits.rounds:
        # No time is left to check an interrupted iterate between its points.
        return solution
    limits, clearing, lowered = settings.interval_limits, posed.clearing, LoweredLimits()
    warm = settings.solver.from_nearby() if clearing or lower else settings.solver
    try:
        found, held = _measured(posed, solution, w, limits.tolerance, lowered, lower)
        rounds = limits.rounds if imposed else 0
        for number in range(max(rounds, ROUNDS if clearing or lower else 0)):
            fresh = [each for each in found if each not in held]
            new = rows_to_add(posed.nlp, fresh, posed.added) if number < rounds else []
            exceeded = lower and imposed and bool(lowered.found)
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
