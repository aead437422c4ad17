"""Other ways to begin, where a problem turned out infeasible from where a plan begins by default.

Free durations may be guessed too short. With less time than a motion needs, its rows contradict each other, and a
solver that steps toward their least sum of contradictions may shorten the duration instead of lengthening it: it ends
at a point that is infeasible locally, though the problem is not. At a fixed and ample duration, without the objective,
the rows alone are left, and any motion that meets them is a guess from which the duration falls to its optimum.
Source: Betts, Practical Methods for Optimal Control (2010), section 2.12 (find a feasible point first).

Guesses may also stand where an obstacle has no side to be passed on, or at a pose from which no row says where to go:
random variations of them, seeded, stand elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from robotraj._util.errors import InputError
from robotraj.guess.base import InitialGuess
from robotraj.guess.default import default_guess
from robotraj.guess.perturbed import Perturbed
from robotraj.guess.straight_line import StraightLine
from robotraj.planning.diagnosis.elastic import relaxed_motion
from robotraj.problem.problem import Problem
from robotraj.solution.records import added_times
from robotraj.solution.settings import Restarts
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.nlp import Nlp

LOST = (Status.INFEASIBLE, Status.STALLED, Status.ROWS_VIOLATED)
"""Ends from which another beginning may lead away."""

WHENCE = ", from a "
"""What separates the message of a solver from the beginning that led to its solution."""

Solve = Callable[[Problem, InitialGuess | Solution | None], Solution]
"""(problem, guess) -> Solution, on the same mesh."""


def restarted(
    failed: Solution,
    nlp: Nlp,
    guess: InitialGuess | Solution | None,
    solve: Solve,
    restarts: Restarts,
    coarsely: Solve,
) -> Solution:
    """Solve a problem that failed once more: from longer motions, variations, and a motion that meets every row.

    A relaxed problem (``robotraj.planning.diagnosis.elastic``) shows which limits conflict; where they are limits of
    joints or of a fixed duration alone, no variation is tried: no other beginning makes a motor stronger.

    Parameters
    ----------
    failed : Solution
        What the solver ended with.
    nlp : Nlp
        What it was given, with the durations it started from.
    guess : InitialGuess, Solution or None
        What the user gave. Guesses with a course of their own are not replaced, and only where there is none is there a
        default to vary.
    solve : callable
    restarts : Restarts
    coarsely : callable
        Solves on a coarse mesh, for the relaxed problem.

    Returns
    -------
    Solution
        The first that was found, else the one that failed; with the seconds and iterations of all that was tried.
    """
    problem = failed.problem
    if failed.status not in LOST:
        return failed
    spent, iterations = failed.times, failed.iterations
    factors = tuple(restarts.longer)[: restarts.count]
    seeds = tuple(restarts.seeds)[: restarts.count - len(factors)]
    for attempt, whence in chain(
        _from_longer(problem, nlp, guess, solve, factors), _from_elsewhere(problem, guess, solve, seeds, coarsely)
    ):
        if attempt.conflicts:
            failed = replace(failed, conflicts=attempt.conflicts)
            continue
        spent, iterations = added_times(spent, attempt.times), iterations + attempt.iterations
        if attempt.status is Status.INTERRUPTED:
            return replace(failed, status=Status.INTERRUPTED, times=spent, iterations=iterations)
        if attempt.success and whence:
            return replace(attempt, message=attempt.message + WHENCE + whence, times=spent, iterations=iterations)
    return replace(failed, times=spent, iterations=iterations)


def _from_elsewhere(
    problem: Problem, guess: InitialGuess | Solution | None, solve: Solve, seeds: Sequence[int], coarsely: Solve
) -> Iterator[tuple[Solution, str]]:
    """Start from variations of the default guess, then from a motion that meets every row on a coarse mesh.

    Before that, the relaxed problem shows which rows conflict. Limits of joints at a fixed duration end the search.
    """
    if not seeds or guess is not None:
        return
    motion, conflicts = relaxed_motion(problem, coarsely)
    if motion is not None and (conflicts or motion.status is Status.INTERRUPTED):
        yield replace(motion, conflicts=conflicts), ""
    fixed = all(low == high for low, high in (phase.duration_bounds for phase in problem.phases))
    if conflicts and fixed and all(conflict.physical for conflict in conflicts):
        return
    for seed in seeds:
        found = solve(problem, Perturbed(default_guess(problem), (seed,)))
        yield found, "variation of the default guess, which led nowhere"
    if motion is not None and not conflicts:
        yield solve(problem, motion), "motion that meets every row on a coarse mesh"


def _from_longer(
    problem: Problem, nlp: Nlp, guess: InitialGuess | Solution | None, solve: Solve, factors: Sequence[float]
) -> Iterator[tuple[Solution, str]]:
    """Start from motions that take longer; say so of each solution, and nothing of these motions themselves."""
    free = [layout.duration.column is not None for layout in nlp.layouts]
    if not any(free) or not (guess is None or isinstance(guess, StraightLine | Solution)):
        return
    tried: set[tuple[float, ...]] = set()
    for times in factors:
        durations = tuple(_duration(nlp, i, times) for i in range(len(free)))
        if durations in tried:
            return
        tried.add(durations)
        try:
            ample = [
                replace(phase, duration=duration, objective=None) if is_free else phase
                for phase, duration, is_free in zip(problem.phases, durations, free, strict=True)
            ]
        except InputError:
            # No limit of speeds allows it yet: what a free duration may grow to, a fixed one is refused for.
            continue
        motion = solve(Problem(ample, problem.links), None)
        yield motion, ""
        if motion.success:
            found = solve(problem, motion)
            yield found, _whence(nlp, free, durations, found)


def _whence(nlp: Nlp, free: list[bool], durations: tuple[float, ...], found: Solution) -> str:
    """Say how long the motion was from which a solution was found, and what that tells of the guess."""
    chosen = [i for i, is_free in enumerate(free) if is_free]
    seconds = " and ".join(f"{durations[i]:.3g} s" for i in chosen)
    short = sum(found.phases[i].duration - _duration(nlp, i, 1.0) for i in chosen) > 0
    return f"motion of {seconds}: the guess {'was too short' if short else 'led nowhere'}"


def _duration(nlp: Nlp, index: int, times: float) -> float:
    """Duration of a phase [s]: its own where that is fixed, else so many times the guessed one, within its bounds."""
    scalar = nlp.layouts[index].duration
    if scalar.column is None:
        return float(scalar.value)
    return float(np.clip(times * nlp.guess[scalar.column], *nlp.problem.phases[index].duration_bounds))
