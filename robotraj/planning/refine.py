"""Refinement to a tolerance: solve, estimate the error between the knots, refine the mesh, solve again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from robotraj.planning.duality_gap import SolverAccuracy
from robotraj.planning.solve import solve
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.records import MeshStep, added_times
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.assess import assess
from robotraj.transcription.refinement.base import Assessment, Refinement
from robotraj.transcription.refinement.equidistribution import Equidistribute
from robotraj.transcription.refinement.linear_controls import on_lines
from robotraj.transcription.refinement.objective_quadrature import quadrature_errors
from robotraj.transcription.schemes.collocation import Collocation
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.schemes.onestep import OneStep

MOST_MESHES = 25
"""Largest number of meshes."""
MOST_INTERVALS = 10_000
"""Largest number of intervals of all phases; errors of more are round-off or need a higher order."""
PATIENCE = 4
"""Number of successive meshes without a smaller error after which refinement stops."""
LESS = 0.8
"""Share of the least error so far below which an error counts as smaller."""
ALIKE = 2.0
"""Largest ratio of the errors of successive meshes that count as alike."""
ROOM = 0.1
"""Largest relative change of the length of a moving interval from one mesh to the next."""
GROWTH = 1.1
"""Ratio of the numbers of points over two meshes below which the next one grows by as much at once."""
CALMED = 4.0
"""Largest change of the objective before the last one, relative to the tolerance, once it has settled."""
ROUND_OFF = 1e-13
"""Error below which a mesh is not refined."""
MOST_EXCESS = 5e-4
"""Excess over a path row between the points, relative to its bound, below which no interval is split for it."""
FALL = 0.25
"""Largest ratio of the excesses on successive meshes for a further split.

An excess of a smooth control falls faster. Where a control switches inside an interval, its excess does not fall.
"""
FAR_MORE, HARDLY = 1.5, 0.7
"""Ratios of points and of errors of successive meshes that show that the error does not follow the mesh."""
CALM = Equidistribute(finest=MOST_INTERVALS)
"""Refinement of meshes whose controls are lines; it keeps their scheme."""
ENDING = (Status.INTERRUPTED, Status.TIME_LIMIT, Status.MEMORY_LIMIT)
"""Statuses after which nothing else is tried."""
SMALL = 1e-2
"""Least size of an objective to which the tolerance is relative."""


def adapt(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
) -> Solution:
    """Refine the meshes of all phases until every interval's error is below the tolerance and the objective settled.

    Each mesh starts from the solution on the one before, with a smaller barrier. An objective has settled when it
    hardly changes on a finer mesh, and changed little on the mesh before (``CALMED``). Controls of systems become lines
    where a finer mesh fails, or where its error hardly falls.
    Last, intervals are split on which path rows on controls or accelerations are violated, while that excess falls.
    If the errors are small enough but ``refinement`` returns no finer mesh, a smaller tolerance is used. Otherwise
    every interval whose knots are fixed is halved.

    Rows are added between the collocation points once a mesh meets the tolerance without them, or is no better than an
    earlier one. Rows added on a coarse mesh would have to be found again on the next one. Where
    the solver stops too far from the optimum of its mesh, its gap is reduced (``Solver.with_smaller_gap``). The status
    of a solution that misses the tolerance is ``Status.TOLERANCE_NOT_REACHED``.
    """
    tolerance, refinement, limits = settings.tolerance, settings.refinement, settings.interval_limits
    assert tolerance is not None and refinement is not None
    mesh = settings.mesh
    meshes: list[Mesh] = [mesh] * len(problem.phases) if isinstance(mesh, Mesh) else list(mesh)
    steps: list[MeshStep] = []
    # Violations below 1e-7 are round-off of the solver.
    limits = replace(limits, tolerance=min(limits.tolerance, max(1e-7, 0.1 * tolerance)))
    calm_from = 0
    total, iterations = dict[str, float](), 0
    start: InitialGuess | Solution | None = guess
    adding_rows, excess = False, np.inf
    accuracy = SolverAccuracy(settings.solver)

    def assessed(solution: Solution) -> tuple[list[Assessment], float, bool]:
        """Return the assessments of all phases, the largest error, and whether the objective has settled."""
        size = tolerance * max(abs(solution.objective), SMALL)
        changes = np.abs(np.diff([*(step.objective for step in steps[calm_from:]), solution.objective]))
        # If each mesh halves the distance to the optimum, the remaining distance equals the last change. A mesh may
        # miss the intervals that matter, so that its change says little after a large one.
        settled = len(changes) > 0 and changes[-1] <= 0.5 * size and bool(np.all(changes[-2:] <= CALMED * size))
        settled = settled and _quadrature_error(solution) <= size
        assessments = [assess(part.phase, part.trajectory, part.mesh, settled) for part in solution.phases]
        return assessments, max(float(a.errors.max()) for a in assessments), settled

    def needs_rows(solution: Solution) -> bool:
        nonlocal adding_rows
        if not adding_rows and solution.success:
            _, worst, settled = assessed(solution)
            earlier = min((step.error for step in steps[calm_from:]), default=np.inf)
            adding_rows = (worst <= tolerance and settled) or worst >= earlier
        return adding_rows

    def solved(start: InitialGuess | Solution | None, hold: Callable[[Solution], bool] | None) -> Solution:
        nonlocal total, iterations
        solver = accuracy.solver.from_nearby() if steps else accuracy.solver
        own = replace(settings, mesh=tuple(meshes), solver=solver, interval_limits=limits)
        found = solve(problem, start, own, progress, hold)
        total, iterations = added_times(total, found.times), iterations + found.iterations
        return found

    def recorded(solution: Solution) -> Solution:
        return replace(solution, refinement=tuple(steps), times=total, iterations=iterations)

    kept: Solution | None = None
    try:
        while True:
            solution = solved(start, needs_rows)
            if not solution.success and accuracy.tightened and solution.status is not Status.INTERRUPTED:
                accuracy.revert()
                solution = solved(start, needs_rows)
            kept = recorded(solution)
            assessments, worst, settled = assessed(solution)
            steps.append(
                MeshStep(
                    sum(m.count for m in meshes),
                    sum(len(part.points) for part in solution.phases),
                    worst,
                    solution.objective,
                    solution.iterations,
                    solution.seconds,
                )
            )
            kept = solution = recorded(solution)
            accurate = worst <= tolerance and settled
            before = excess
            if accurate:
                excess = max(float(each.broken.max()) for each in assessments)
            splitting = accurate and MOST_EXCESS < excess < FALL * before
            reached = adding_rows and accurate and not splitting
            tighter = accuracy.tighten_if_needed(solution, tolerance * max(abs(solution.objective), SMALL))
            failed = not solution.success and solution.status not in ENDING
            astray = failed or (worst > tolerance and _hardly_falls(steps))
            if astray and len(steps) > 1 and refinement != CALM:
                assert isinstance(start, Solution)
                # The program of a failed mesh leads astray from the motion on the last one.
                last = start if failed else solution
                calmer = on_lines(problem, tuple(part.mesh for part in last.phases))
                if calmer != tuple(meshes):
                    meshes, refinement, start, calm_from = list(calmer), CALM, last, len(steps)
                    continue
            if not solution.success or (reached and not tighter):
                return solution
            if reached:
                start = solution
                continue
            # While the objective changes, errors must be smaller than the tolerance.
            goal = tolerance if worst > tolerance else max(0.1 * worst, 1e-3 * tolerance)
            finer = _next(solution, assessments, refinement, tolerance, goal)
            barely_grown = len(steps) > calm_from + 2 and steps[-1].points < GROWTH * steps[-3].points
            while barely_grown and not _has_grown(meshes, finer) and goal > 1e-3 * tolerance:
                # With an interval or two more, errors would stay the same for mesh after mesh.
                goal *= 0.3
                finer = _next(solution, assessments, refinement, tolerance, goal)
            if splitting:
                rough = [replace(each, settled=False) for each in assessments]
                finer = _next(solution, rough, refinement, tolerance, tolerance)
            if worst <= tolerance and not settled and not _is_finer(meshes, finer):
                closer = _next(solution, assessments, refinement, tolerance, max(0.1 * worst, ROUND_OFF))
                if not _is_finer(meshes, closer):
                    closer = [_halved(mesh) for mesh in meshes]
                finer = [b if isinstance(b, MovingMesh) else c for b, c in zip(finer, closer, strict=True)]
            given_up = worst > tolerance and _stagnates([step.error for step in steps[calm_from:]])
            if given_up or len(steps) == MOST_MESHES or sum(m.count for m in finer) > MOST_INTERVALS:
                if accurate and adding_rows:
                    return solution
                if not adding_rows:
                    limited = solved(solution, None)
                    if limited.status is Status.INTERRUPTED:
                        return replace(recorded(solution), status=Status.INTERRUPTED)
                    if limited.success:
                        solution = limited
                return replace(recorded(solution), status=Status.TOLERANCE_NOT_REACHED)
            meshes, start = finer, solution
    except KeyboardInterrupt:
        # Ctrl-C between two solves: the solution on the last mesh is kept.
        if kept is None:
            raise
        return replace(kept, status=Status.INTERRUPTED)


def _quadrature_error(solution: Solution) -> float:
    """Return the quadrature error of the objective along exact motions, whose states have no error."""
    parts = [part for part in solution.phases if part.exact]
    return abs(
        sum(
            float(quadrature_errors(part.phase, part.trajectory, part.mesh.schemes, part.inputs).sum())
            for part in parts
        )
    )


def _is_finer(before: Sequence[Mesh], after: Sequence[Mesh]) -> bool:
    """Whether meshes have more points and none has fewer; meshes whose knots move are ignored."""
    pairs = [(a, b) for a, b in zip(before, after, strict=True) if not isinstance(a, MovingMesh)]
    more = [_points(b) - _points(a) for a, b in pairs]
    return not more or (min(more) >= 0 and max(more) > 0)


def _has_grown(before: Sequence[Mesh], after: Sequence[Mesh]) -> bool:
    """Whether meshes have ``GROWTH`` times as many points; true where all knots move."""
    pairs = [(a, b) for a, b in zip(before, after, strict=True) if not isinstance(a, MovingMesh)]
    return sum(_points(b) for _, b in pairs) >= GROWTH * sum(_points(a) for a, _ in pairs)


def _points(mesh: Mesh) -> int:
    return sum(len(scheme.nodes) if isinstance(scheme, Collocation) else 1 for scheme in mesh.schemes)


def _halved(mesh: Mesh) -> Mesh:
    """Halve every interval, where errors are round-off and the objective has not settled.

    The residual does not measure the effect of control polynomials, Bernstein bounds and quadrature on the objective.
    """
    knots = np.interp(np.arange(2 * mesh.count + 1) / 2, np.arange(mesh.count + 1), mesh.knots)
    return Mesh(tuple(knots.tolist()), tuple(scheme for scheme in mesh.schemes for _ in range(2)))


def _stagnates(errors: list[float]) -> bool:
    """Whether the last meshes are no better than an earlier one and their errors are alike, as on singular arcs.

    Errors that vary widely belong to different motions, as without an objective. The next error may be small enough.
    """
    before, last = errors[:-PATIENCE], errors[-PATIENCE:]
    return bool(before) and min(last) > LESS * min(before) and max(last) < ALIKE * min(last)


def _hardly_falls(steps: Sequence[MeshStep]) -> bool:
    """Whether the error hardly fell although the last mesh has far more points, as on singular arcs."""
    if len(steps) < 2:
        return False
    before, last = steps[-2:]
    return last.points > FAR_MORE * before.points and last.error > HARDLY * before.error


def _is_integrated(part: PhaseSolution) -> bool:
    """Whether a scheme of one step integrates the phase; its intervals are split until the objective settles."""
    return any(isinstance(scheme, OneStep) for scheme in part.mesh.schemes)


def _next(
    solution: Solution, assessments: Sequence[Assessment], refinement: Refinement, tolerance: float, goal: float
) -> list[Mesh]:
    """Refine the mesh of every phase to a goal, and meshes of schemes of one step to the tolerance."""
    pairs = zip(solution.phases, assessments, strict=True)
    return [_refined(part, own, refinement, tolerance if _is_integrated(part) else goal) for part, own in pairs]


def _refined(part: PhaseSolution, assessment: Assessment, refinement: Refinement, tolerance: float) -> Mesh:
    """Refine the mesh of a phase; moving knots start from their last places."""
    mesh = part.mesh
    if not isinstance(mesh, MovingMesh):
        return refinement.refine(mesh, assessment, tolerance)
    inner = (part.knots[1:-1] - part.t0) / part.duration
    refined = refinement.refine(Mesh((0.0, *inner, 1.0), mesh.schemes), assessment, tolerance)
    # Knots are near the switches by now and need little room.
    return MovingMesh(refined.intervals, refined.scheme, max(mesh.least, 1 - ROOM), min(mesh.most, 1 + ROOM))
