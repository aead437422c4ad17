"""Plan until the plan is proved between its points, by Coulomb's law, with links apart and above the ground."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from robotraj._util.time_left import LimitReached
from robotraj.fixed_mesh.at_points import excluded_guess
from robotraj.fixed_mesh.diagnosis.exclusions.crossed_zones import crossed_zones
from robotraj.fixed_mesh.diagnosis.exclusions.rest_to_rest import slipping_motions
from robotraj.fixed_mesh.diagnosis.exclusions.slipping import slipping_contacts
from robotraj.fixed_mesh.diagnosis.self_collision import overlapping_ends
from robotraj.fixed_mesh.solve import solve
from robotraj.planning.loop.run import run
from robotraj.planning.proving.correction import STOPPED, Correction, PlanAttempt
from robotraj.planning.proving.kept_apart import KeptApart
from robotraj.planning.proving.over_ground import AboveGround
from robotraj.planning.proving.sharp_friction import SharpFriction
from robotraj.planning.proving.soft_friction import factor_of
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.records import Round, answered, with_effort_of
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status


def prove(
    problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None = None
) -> Solution:
    """Plan on finer and finer meshes until ``settings.goals`` hold, then correct what their rows do not state.

    Corrections come in this order: links that overlap (``KeptApart``), links below the ground (``AboveGround``), and
    friction that the smooth law leaves out (``SharpFriction``). Each plans again until it has nothing left to try, and
    its plan replaces the one before it only where it is better and no other correction refuses it. What is left is in
    the proof, which then does not hold.

    Nothing is solved where the ground has less friction than every motion needs, where links overlap at a fixed end,
    or where a state must cross a zone that its rows forbid: on every mesh a motion may jump over it between the points.
    """
    slipping = slipping_contacts(problem) or slipping_motions(problem)
    if conflicts := slipping or overlapping_ends(problem) or crossed_zones(problem):
        return replace(excluded_guess(problem, guess, settings), status=Status.INFEASIBLE, conflicts=conflicts)
    found, apart = _begun(problem, guess, settings, progress)
    corrections: tuple[Correction, ...] = (apart, AboveGround(settings, apart), SharpFriction(settings, apart))
    try:
        for each in corrections:
            found = _corrected(found, each, corrections, progress)
    except KeyboardInterrupt:
        found = replace(found, status=Status.INTERRUPTED)
    for each in corrections:
        found = each.judged(found)
    out_of_time = found.status in (Status.TIME_LIMIT, Status.MEMORY_LIMIT)
    return replace(found, status=Status.SOLVED) if out_of_time and found.proof and found.proof.holds else found


def _begun(
    problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None
) -> tuple[Solution, KeptApart]:
    """Return the first plan and what is known of overlaps. It has rows where they kept the links of the guess apart."""
    apart, spent = KeptApart(problem, settings), None
    near = apart.from_guess(guess)
    if near is not None:
        spent = _run(near, progress)
        if spent.success or spent.status in STOPPED:
            return spent, apart
        apart = KeptApart(problem, settings)
    found = run(problem, guess, settings, progress)
    found = found if spent is None else with_effort_of(spent, found)
    return (found, apart) if factor_of(found) == 0.0 else _from_softest(problem, found, settings, apart, progress)


def _from_softest(
    problem: Problem, soft: Solution, settings: Settings, apart: KeptApart, progress: Progress | None
) -> tuple[Solution, KeptApart]:
    """Return the plan from the motion with the softest friction, whose links overlap, and what is known of overlaps.

    Friction becomes less soft along a motion without overlaps; where none is found, along this one.
    """
    try:
        found = _corrected(soft, apart, (apart,), progress)
    except LimitReached:
        found = soft
    except KeyboardInterrupt:
        found = replace(soft, status=Status.INTERRUPTED)
    has_own_friction = factor_of(found) == 0.0
    if has_own_friction or found.status is Status.INTERRUPTED:
        return found, apart
    return with_effort_of(found, run(problem, soft, settings, progress)), KeptApart(problem, settings)


def _corrected(
    found: Solution, correction: Correction, corrections: Sequence[Correction], progress: Progress | None
) -> Solution:
    """Plan again until a correction has nothing left to try. A plan that another correction refuses is dropped."""
    dropped: Solution | None = None
    while found.status not in STOPPED and (attempt := correction.next_attempt(found, dropped)) is not None:
        found = replace(found, rounds=_answered(found.rounds, attempt))
        again = _run(attempt, progress)
        if again.status in STOPPED:
            # Nothing else is tried; the plan before it is a motion, although it lacks something.
            return replace(with_effort_of(again, found), status=again.status)
        others = (each for each in corrections if each is not correction)
        is_better = correction.accepts(again) and all(each.allows(again) for each in others)
        found = with_effort_of(found, again) if is_better else with_effort_of(again, found)
        dropped = None if is_better else again
    if dropped is not None:
        found = replace(found, rounds=answered(found.rounds, found.rounds[-1].lacked, "the plan before it is kept"))
    return found


def _run(attempt: PlanAttempt, progress: Progress | None) -> Solution:
    if attempt.is_single:
        return solve(attempt.problem, attempt.guess, attempt.settings, progress, attempt.surfaces)
    return run(attempt.problem, attempt.guess, attempt.settings, progress, attempt.surfaces, attempt.is_brief)


def _answered(rounds: Sequence[Round], attempt: PlanAttempt) -> tuple[Round, ...]:
    """Return the rounds so far, whose last one has what it lacks and what is planned next."""
    last = rounds[-1]
    lacked = attempt.lacked if last.status is Status.SOLVED else last.status.value
    return answered(rounds, lacked, attempt.why)
