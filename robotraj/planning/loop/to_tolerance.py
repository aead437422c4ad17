"""Refinement to a tolerance: the errors of a solve between its knots, and the next mesh that follows from them.

Each mesh starts from the solution on the one before. Where a solver stops too far from the optimum of its mesh, its gap
is reduced. Controls of systems become lines where a mesh fails, or where its error hardly falls. Last, intervals are
split on which path rows on controls or accelerations, or limits of torques, are violated, while that excess falls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.precision import MET
from robotraj.fixed_mesh.between.limits_between import limited_between
from robotraj.fixed_mesh.solve import solved_at_points
from robotraj.planning.loop.finer_meshes import finer_meshes, split_where_broken
from robotraj.planning.loop.state import Found, PlanEnd, Task, step_of
from robotraj.planning.loop.tolerance_state import Errors, ToleranceState
from robotraj.solution.claims.objective_size import objective_size
from robotraj.solution.records import MeshStep
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.assess import assess
from robotraj.transcription.refinement.equidistribution import LEAST_GROWTH, SAFETY, Equidistribute
from robotraj.transcription.refinement.linear_controls import HARDLY, on_lines
from robotraj.transcription.refinement.objective_quadrature import quadrature_errors
from robotraj.transcription.refinement.split_and_merge import SplitAndMerge

MOST_MESHES = 25
"""Largest number of meshes."""
MOST_INTERVALS = 10_000
"""Largest number of intervals of all phases; errors of more are round-off or need a higher order."""
PATIENCE = 4
"""Number of successive meshes without a smaller error after which refinement stops."""
CALM = Equidistribute(finest=MOST_INTERVALS)
"""Refinement of meshes whose controls are lines; it keeps their scheme."""
SPENT = (Status.TIME_LIMIT, Status.MEMORY_LIMIT)


def solved_to_tolerance(state: ToleranceState, progress: Progress | None = None) -> Found:
    """Solve on the meshes of a state, with limits between the points where the solution needs them."""
    limits = state.settings.interval_limits
    limits = replace(limits, tolerance=min(limits.tolerance, SAFETY * max(MET, state.tolerance)))
    settings = replace(state.settings, mesh=state.meshes, solver=state.solver, interval_limits=limits)
    attempt = solved_at_points(state.problem, state.best or state.guess, settings, progress)
    try:
        errors, limited = errors_of(state, attempt.solution), state.limited
        if attempt.solution.success:
            no_better = errors.worst >= min((step.error for step in state.compared), default=np.inf)
            limited = limited or not errors.lacks or no_better
        solution = limited_between(attempt, settings, progress, limited)
        if solution.phases is not attempt.solution.phases:
            errors = errors_of(state, solution)
    except KeyboardInterrupt:
        # Ctrl-C after a solve: its solution is kept.
        return Found(replace(attempt.solution, status=Status.INTERRUPTED))
    return Found(solution, limited=limited, lacks=errors.lacks, errors=errors)


def errors_of(state: ToleranceState, solution: Solution) -> Errors:
    """Return the errors of a solution between its knots, and of its objective.

    If each mesh halves the distance to the optimum, the remaining distance equals the last change. That change is no
    measure of the distance if refinement left out the intervals that matter, so the one before counts too.
    """
    changes = np.abs(np.diff([*(step.objective for step in state.compared), solution.objective]))
    left = max(2.0 * changes[-1], SAFETY * changes[-2:].max(), _quadrature_error(solution)) if len(changes) else np.inf
    allowed = state.tolerance * objective_size(solution.phases, solution.objective)
    parts = [assess(part.phase, part.trajectory, part.mesh, bool(left <= allowed)) for part in solution.phases]
    return Errors(tuple(parts), state.tolerance, left, allowed)


def after_errors(state: ToleranceState, found: Found) -> ToleranceState | PlanEnd:
    """Return the state that follows from the errors of a solve, or the end of the plan."""
    solution, errors = found.solution, found.errors
    assert errors is not None and state.settings.refinement is not None
    if not solution.success and state.has_smaller_gap:
        return replace(state, gap=0.0, why="the solver's own gap")
    known = _recorded(state, solution, errors.worst)
    if state.is_last:
        return _missed(known, "")
    known = replace(known, limited=found.limited, gap=_next_gap(state, solution, errors.allowed))
    if lined := _on_lines(known, solution, errors):
        return lined
    if not solution.success:
        return _missed(known, solution.status.value)
    accurate, finer = not errors.lacks, None
    if accurate:
        known = replace(known, excess=errors.excess)
        # An excess of a smooth control falls so far at least; one where a control switches stays.
        if SplitAndMerge.path < errors.excess < SAFETY * state.excess:
            finer = split_where_broken(solution, errors.assessments, state.settings.refinement, state.tolerance)
        elif found.limited:
            return PlanEnd(known, "") if known.gap == state.gap else replace(known, why="a smaller gap of the solver")
    if finer is None:
        finer = finer_meshes(solution, errors, state.settings.refinement, _barely_grow(known.compared))
    count = sum(mesh.count for mesh in finer)
    stagnant = errors.worst > state.tolerance and stagnates([step.error for step in known.compared])
    if stagnant or len(known.steps) == MOST_MESHES or count > MOST_INTERVALS:
        return PlanEnd(known, "") if accurate and found.limited else _missed(known, "no finer mesh is of use")
    return replace(known, meshes=tuple(finer), why=f"{count} intervals")


def _recorded(state: ToleranceState, solution: Solution, error: float) -> ToleranceState:
    """Return the state with a solve and the record of its mesh, once for a mesh that is solved again with limits."""
    if not solution.success and state.is_last:
        return state
    before = state.steps[:-1] if state.is_last else state.steps
    state = replace(state, steps=(*before, step_of(solution, error)))
    return replace(state, best=solution) if solution.success else replace(state, failed=solution)


def _missed(state: ToleranceState, why: str) -> ToleranceState | PlanEnd:
    """Return the end of a plan that misses its tolerance, or the solve that imposes the limits it still lacks."""
    best, failed = state.best, state.failed
    if best is None:
        return PlanEnd(state, why)
    spent = failed is not None and failed.status in SPENT
    if not state.limited and not spent:
        meshes = tuple(part.mesh for part in best.phases)
        return replace(state, meshes=meshes, limited=True, is_last=True, why=Task.LIMITS.value)
    status = failed.status if spent and failed is not None else Status.TOLERANCE_NOT_REACHED
    return PlanEnd(replace(state, best=replace(best, status=status)), why)


def _next_gap(state: ToleranceState, solution: Solution, allowed: float) -> float:
    """Return a smaller gap for the next solver where that of a solution exceeds ``SAFETY`` of the allowed error."""
    gap, own = state.gap, state.settings.solver
    if not solution.success or not gap:
        return gap
    ratio = duality_gap(solution) / (SAFETY * allowed)
    if ratio <= 1.0:
        return gap
    smaller = SAFETY * gap / ratio
    # A solver at its smallest gap returns itself.
    return gap if own.with_smaller_gap(smaller) == own.with_smaller_gap(gap) else smaller


def _on_lines(state: ToleranceState, solution: Solution, errors: Errors) -> ToleranceState | None:
    """Return the state whose controls of systems are lines, where the last mesh leads astray; else None."""
    failed = not solution.success and solution.status not in SPENT
    astray = failed or (errors.worst > state.tolerance and _hardly_falls(state.steps))
    first = len(state.steps) == 1
    endless = solution.iterations >= InteriorPoint.max_iterations
    if not astray or (first and not endless) or state.settings.refinement == CALM:
        return None
    # The program of a failed mesh leads astray from the motion on the last one.
    last = None if first else state.best
    meshes = state.meshes if last is None else tuple(part.mesh for part in last.phases)
    calmer = on_lines(state.problem, meshes)
    if calmer == state.meshes:
        return None
    settings = replace(state.settings, refinement=CALM)
    return replace(state, settings=settings, meshes=calmer, first=len(state.steps), why="controls as lines")


def _quadrature_error(solution: Solution) -> float:
    """Return the quadrature error of the objective along exact motions, whose states have no error."""
    parts = [part for part in solution.phases if part.exact]
    return abs(sum(float(quadrature_errors(p.phase, p.trajectory, p.mesh.schemes, p.inputs).sum()) for p in parts))


def _barely_grow(steps: Sequence[MeshStep]) -> bool:
    """Whether the last two meshes have hardly more points than the one before them."""
    return len(steps) > 2 and steps[-1].points < LEAST_GROWTH * steps[-3].points


def _hardly_falls(steps: Sequence[MeshStep]) -> bool:
    """Whether the error hardly fell although one of first order would have, as on singular arcs."""
    if len(steps) < 2:
        return False
    before, last = steps[-2:]
    return before.points < HARDLY * last.points and last.error > HARDLY * before.error


def stagnates(errors: Sequence[float]) -> bool:
    """Whether the last meshes are no better than an earlier one and their errors are alike, as on singular arcs.

    Errors that vary widely belong to different motions, as without an objective. The next error may be small enough.
    """
    before, last = errors[:-PATIENCE], errors[-PATIENCE:]
    return bool(before) and min(last) > HARDLY * min(before) and min(last) > HARDLY * max(last)


def duality_gap(solution: Solution) -> float:
    """Return the duality gap: multipliers times the distances of rows and variables from their bounds.

    For a convex program it bounds the distance of the objective from the optimum. Source: Nocedal & Wright,
    Numerical Optimization (2006), section 14.1.
    """
    multipliers = solution.multipliers
    if multipliers is None or multipliers.origin is None:
        return 0.0
    nlp, w = multipliers.origin.nlp, multipliers.origin.w
    gap = 0.0
    for own, scalars, values in (
        (multipliers.rows, nlp.rows, nlp.values(w)),
        (multipliers.bounds, nlp.variables, w),
    ):
        distance = np.where(own > 0, scalars.upper - values, values - scalars.lower)
        gap += float(np.abs(own) @ np.where(np.isfinite(distance), np.maximum(distance, 0.0), 0.0))
    return gap
