"""One solve on one mesh: transcribe, solve, evaluate every row again."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from robotraj.guess.base import InitialGuess
from robotraj.guess.default import as_guess
from robotraj.native.engines.base import Engine, VirtualMachine
from robotraj.planning.deadline import Deadline
from robotraj.planning.many.starts import Start
from robotraj.planning.nlp_violations import between_points, violations
from robotraj.planning.restarts import restarted
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.costates.duals import LateDuals, PhaseDuals
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.records import added_times
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import LateMultipliers, Multipliers, Outcome, Progress, Solver
from robotraj.solvers.ipopt import Ipopt
from robotraj.solvers.status import Status
from robotraj.transcription.collocation.unwrap_angles import unwrapped
from robotraj.transcription.extract import extract
from robotraj.transcription.interval_limits.added_rows import rows_to_add, with_added_rows
from robotraj.transcription.interval_limits.constraint_generation import AddedRow
from robotraj.transcription.interval_limits.interval_violations import (
    IntervalViolation,
    state_violations,
    variable_violations,
)
from robotraj.transcription.interval_limits.margins import Margins, with_margins
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.reuse import transcribed_again
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.transcribe import transcribe

COARSE = 15
"""Intervals a phase of the relaxed problem, which shows the limits that conflict."""
ROW_TOLERANCE = 1e-6
"""Largest violation of a scaled row or bound that counts as held, when rows are evaluated outside the solver."""
NEAR = 1e-2
"""Largest violation of a scaled row at a guess from another problem whose multipliers are still worth taking."""


def solve(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
    hold: Callable[[Solution], bool] | None = None,
    margins: Margins | None = None,
) -> Solution:
    """Solve a problem on a mesh and check the answer outside the solver.

    Where a row on states turns out broken between collocation points, it is imposed there too, as
    ``interval_limits`` says,
    and the problem solved again, from the last answer; only if ``hold``, where given, says of the first answer that
    it is worth it. A guess brings its added rows along, on the intervals that its mesh has as well, unless
    ``interval_limits`` has
    no rounds: then nothing is imposed. Where the problem with further rows cannot be solved, the solution without them
    stays, and ``interval_limits`` lists what is broken.

    Where the problem cannot be solved from its guess, ``settings.restarts`` solve it from elsewhere: see
    ``robotraj.planning.restarts``. With ``margins``, limits are lower on some intervals.
    """
    if isinstance(progress, Deadline):
        progress.before_solve()
    began = time.perf_counter()
    mesh, solver, engine = settings.mesh, settings.solver, settings.engine
    interval_limits = settings.interval_limits
    nlp = _again(problem, mesh, guess, engine, interval_limits) or transcribe(
        problem, mesh, as_guess(guess), engine, interval_limits
    )
    added, same = _known_rows(problem, mesh, guess) if interval_limits.rounds else ([], False)
    nlp = with_margins(nlp, margins or {})
    plain = nlp
    if added:
        nlp = with_added_rows(nlp, added, nlp.guess)
    multipliers = _multipliers(guess, nlp, True) if added and same else _multipliers(guess, plain, False)
    if added and not same and multipliers is not None:
        multipliers = _lengthened(multipliers, nlp)
    solution, w = _solve(nlp, guess, multipliers, solver, progress, began)
    try:
        if settings.restarts.count and not solution.success:

            def once_more(asked: Problem, start: InitialGuess | Solution | None) -> Solution:
                # Whether rows between the points are worth it is said of the problem's own solutions: others lead to
                # them.
                worth = hold if asked is problem else _never
                return solve(asked, start, replace(settings, restarts=Restarts(0)), progress, worth)

            def coarsely(asked: Problem, start: InitialGuess | Solution | None) -> Solution:
                few = replace(
                    settings,
                    mesh=Mesh(COARSE, HermiteSimpson()),
                    solver=Ipopt(max_iterations=300),
                    engine=VirtualMachine(),
                    interval_limits=ConstraintGeneration(rounds=0),
                    restarts=Restarts(0),
                )
                return solve(asked, start, few, progress)

            solution = restarted(solution, nlp, guess, once_more, settings.restarts, coarsely)
            if solution.success:
                return solution
        found = _state_violations(solution, interval_limits.tolerance)
        moving = any(isinstance(layout.mesh, MovingMesh) for layout in nlp.layouts)
        for _ in range(interval_limits.rounds if hold is None or hold(solution) else 0):
            new = rows_to_add(nlp, found, added)
            if not new or not solution.success:
                break
            began = time.perf_counter()
            if moving:
                # Knots start again from where the mesh has them: moved ones hold on to the arcs they came to stand on.
                nlp = transcribe(problem, mesh, as_guess(solution), engine, interval_limits)
                nlp = with_added_rows(nlp, [*added, *new], nlp.guess)
            else:
                nlp = with_added_rows(nlp, new, w)
            again, w = _solve(nlp, solution, _multipliers(solution, nlp, True), solver, progress, began)
            times, iterations = added_times(solution.times, again.times), again.iterations + solution.iterations
            failed = not again.success and again.status is not Status.INTERRUPTED
            solution = replace(solution if failed else again, times=times, iterations=iterations)
            if failed:
                break
            added += new
            found = _state_violations(solution, interval_limits.tolerance)
        of_variables = [
            violation
            for i, part in enumerate(solution.phases)
            for violation in variable_violations(part.phase, i, part.trajectory, part.torques)
        ]
        left, controls = (between_points(problem, group) for group in (found, of_variables))
    except KeyboardInterrupt:
        # Ctrl-C where no solver waits for it: what the last one found stays.
        return replace(solution, status=Status.INTERRUPTED, added_rows=tuple(added))
    return replace(solution, added_rows=tuple(added), interval_violations=left, control_interval_violations=controls)


def _never(solution: Solution) -> bool:
    return False


def _again(
    problem: Problem,
    mesh: Mesh | Sequence[Mesh],
    guess: InitialGuess | Solution | None,
    engine: Engine | None,
    interval_limits: ConstraintGeneration,
) -> Nlp | None:
    """Take over the NLP of an earlier solution of a problem like this one without added rows, or of earlier starts."""
    if isinstance(guess, Start):
        return guess.shared.transcribed(problem, mesh, guess, engine, interval_limits)
    if (
        not isinstance(guess, Solution)
        or guess.added_rows
        or guess.multipliers is None
        or guess.multipliers.origin is None
    ):
        return None
    origin = guess.multipliers.origin
    return transcribed_again(origin.nlp, problem, mesh, engine, interval_limits, origin.w)


def _state_violations(solution: Solution, allowed: float) -> list[IntervalViolation]:
    """Find rows of the state that are violated between the collocation points."""
    return [
        violation
        for i, part in enumerate(solution.phases)
        for violation in state_violations(part.phase, i, part.trajectory, allowed)
    ]


def _known_rows(
    problem: Problem, mesh: Mesh | Sequence[Mesh], guess: InitialGuess | Solution | None
) -> tuple[list[AddedRow], bool]:
    """Rows added for an earlier solution that this problem has as well; and whether all are on the same mesh.

    On another mesh, rows are taken over on the intervals that begin and end as before, whatever their schemes.
    """
    if not isinstance(guess, Solution) or not guess.added_rows or len(guess.phases) != len(problem.phases):
        return [], False
    meshes = [mesh] * len(problem.phases) if isinstance(mesh, Mesh) else list(mesh)

    def rows(phase: Phase) -> list[tuple[str, str | None]]:
        return [(row.name, row.joint) for row in phase.rows]

    pairs = list(zip(guess.phases, problem.phases, strict=True))
    if not all(rows(part.phase) == rows(phase) for part, phase in pairs):
        return [], False
    # A row of the same name may hold at another time, or depend on what is not known between the points.
    held = [{row.number for row in phase.rows.of_state} for phase in problem.phases]
    added = [each for each in guess.added_rows if each.row in held[each.phase]]
    if all(part.mesh == here for part, here in zip(guess.phases, meshes, strict=True)):
        return added, len(added) == len(guess.added_rows)
    kept = [_kept_intervals(part.mesh, here) for part, here in zip(guess.phases, meshes, strict=True)]
    return [
        replace(each, interval=kept[each.phase][each.interval]) for each in added if each.interval in kept[each.phase]
    ], False


def _kept_intervals(before: Mesh, after: Mesh) -> dict[int, int]:
    """Intervals of a mesh that another one has as well, by their numbers there; none where knots move."""
    if isinstance(before, MovingMesh) or isinstance(after, MovingMesh):
        return {}
    numbers = {ends: k for k, ends in enumerate(_ends(after))}
    return {k: numbers[ends] for k, ends in enumerate(_ends(before)) if ends in numbers}


def _ends(mesh: Mesh) -> Iterator[tuple[float, float]]:
    knots = [round(float(knot), 12) for knot in mesh.knots]
    return zip(knots[:-1], knots[1:], strict=True)


def _solve(
    nlp: Nlp,
    guess: InitialGuess | Solution | None,
    multipliers: Multipliers | None,
    solver: Solver,
    progress: Progress | None,
    began: float,
) -> tuple[Solution, np.ndarray]:
    """Solve a transcribed problem; also give the decision vector. It is being built since ``began``."""
    shared = guess.shared if isinstance(guess, Start) else None
    known = guess.multipliers if isinstance(guess, Solution) else shared.known if shared else None
    if known is not None and known.origin is not None:
        outcome = solver.resolve(nlp, known, progress, multipliers)
    else:
        outcome = solver.solve(nlp, progress, multipliers)
    outcome = replace(outcome, w=unwrapped(nlp, outcome.w))
    if shared is not None:
        shared.keep(nlp, outcome.multipliers)
    # What a solver does not count as its own, such as assembling the NLP's functions for it, is building.
    own = outcome.times.get("setup", 0.0) + outcome.times.get("solve", 0.0)
    times = {"build": time.perf_counter() - began - own - nlp.compiling, "compile": nlp.compiling}
    return _conclude(nlp, outcome, times), outcome.w


def _conclude(nlp: Nlp, outcome: Outcome, times: dict[str, float]) -> Solution:
    """Evaluate every row again outside the solver and wrap up what it found."""
    outputs = nlp.outputs(outcome.w)
    broken = violations(nlp, outcome.w, ROW_TOLERANCE, outputs)
    status = outcome.status
    if status is Status.SOLVED and broken:
        status = Status.ROWS_VIOLATED
    if status is Status.INFEASIBLE and _more_equations_than_unknowns(nlp):
        status = Status.OVERDETERMINED
    trajectories = extract(nlp, outcome.w, outputs)
    phases = tuple(
        PhaseSolution(phase, layout.mesh, trajectory)
        for phase, layout, trajectory in zip(nlp.problem.phases, nlp.layouts, trajectories, strict=True)
    )
    return Solution(
        nlp.problem,
        phases,
        status,
        outcome.message,
        nlp.objective(outcome.w, outputs),
        outcome.iterations,
        times | outcome.times,
        broken,
        outcome.multipliers,
        duals=_late_duals(nlp, outcome) if status is Status.SOLVED else (),
        impulses=tuple(
            {unknown.name: float(value) for unknown, value in zip(link.unknowns, outcome.w[columns], strict=True)}
            for link, columns in zip(nlp.problem.bound_links, nlp.link_columns, strict=True)
        ),
    )


def _more_equations_than_unknowns(nlp: Nlp) -> bool:
    equations = np.sum(nlp.rows.lower == nlp.rows.upper)
    return bool(equations > np.sum(nlp.variables.lower < nlp.variables.upper))


def _late_duals(nlp: Nlp, outcome: Outcome) -> LateDuals:
    # Costates are not unique where invariants are held. A copy of the NLP is without the functions that it has made.
    held = any(phase.dae.invariants for phase in nlp.problem.phases)
    return LateDuals(partial(_duals, replace(nlp), outcome), 0 if held else len(nlp.layouts))


def _duals(nlp: Nlp, outcome: Outcome) -> tuple[PhaseDuals, ...]:
    """Duals as functions of time: late, with what finds them."""
    from robotraj.solution.costates.covector import covectors

    return covectors(nlp, outcome.w, outcome.multipliers)


def _broken_by(nlp: Nlp) -> float:
    """Largest violation of a scaled row at the guess."""
    values = nlp.values(nlp.guess)
    return float(np.max(np.maximum(nlp.rows.lower - values, values - nlp.rows.upper) * nlp.row_scale, initial=0.0))


def _multipliers(guess: Any, nlp: Nlp, extended: bool) -> Multipliers | None:
    """Multipliers of an earlier solution of the same NLP, or of one nearby; added rows come last and start at zero.

    Far from the earlier problem its multipliers, and the small barrier that belongs to them, cost more than they save.
    """
    if not isinstance(guess, Solution) or guess.multipliers is None or not guess.success:
        return None
    same = guess.problem is nlp.problem
    if not same and _broken_by(nlp) > NEAR:
        return None
    known, sizes = guess.multipliers, (len(nlp.rows), len(nlp.variables))
    more = sizes[0] - known.sizes[0], sizes[1] - known.sizes[1]
    if min(more) >= 0 and (extended or more == (0, 0)):
        return _lengthened(known, nlp)
    if not same:
        return None
    from robotraj.solution.costates.transfer import transfer

    return transfer(guess.duals, nlp)


def _lengthened(known: Multipliers, nlp: Nlp) -> Multipliers:
    # Not every solver reads them, and finding them may take a further solve.
    return LateMultipliers(partial(_extended, known, nlp), (len(nlp.rows), len(nlp.variables)), known.origin)


def _extended(known: Multipliers, nlp: Nlp) -> Multipliers:
    """Add zeros for the rows and columns that came last."""
    rows, bounds = np.zeros(len(nlp.rows)), np.zeros(len(nlp.variables))
    rows[: len(known.rows)], bounds[: len(known.bounds)] = known.rows, known.bounds
    return Multipliers(rows, bounds)
