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

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from robotraj.guess import Guess, StraightLine
from robotraj.guesses import Perturbed, default_guess
from robotraj.problem import Problem
from robotraj.records import added_times
from robotraj.solution import Solution
from robotraj.status import Status
from robotraj.transcription import Nlp

TIMES = (3.0, 9.0, 27.0)
"""How many times as long as they were guessed durations are, one after the other: the longer, the further from the
optimum."""
SEEDS = (0, 1)
"""Of the variations that are tried."""
LOST = (Status.INFEASIBLE, Status.STALLED, Status.ROWS_VIOLATED)
"""Ends from which another beginning may lead away."""


def from_elsewhere(
    failed: Solution,
    guess: Guess | Solution | None,
    solve: Callable[[Problem, Guess | Solution | None], Solution],
) -> Solution | None:
    """Solve a problem that failed once more, from variations of the default guess.

    Parameters
    ----------
    failed : Solution
        What the solver ended with.
    guess : Guess, Solution or None
        What the user gave; only where that is nothing is there a default to vary.
    solve : callable
        (problem, guess) -> Solution, on the same mesh.

    Returns
    -------
    Solution or None
        None where that does not help either.
    """
    problem = failed.problem
    if failed.status not in LOST or guess is not None or any(phase.bound_contacts for phase in problem.phases):
        return None
    spent, iterations = failed.times, failed.iterations
    for seed in SEEDS:
        found = solve(problem, Perturbed(default_guess(problem), (seed,)))
        spent, iterations = added_times(spent, found.times), iterations + found.iterations
        if found.status is Status.INTERRUPTED:
            return replace(failed, status=Status.INTERRUPTED, times=spent, iterations=iterations)
        if found.success:
            message = f"{found.message}, from a variation of the default guess, which led nowhere"
            return replace(found, message=message, times=spent, iterations=iterations)
    return None


def from_longer(
    failed: Solution,
    nlp: Nlp,
    guess: Guess | Solution | None,
    solve: Callable[[Problem, Guess | Solution | None], Solution],
) -> Solution | None:
    """Solve a problem that failed once more, from a motion that takes longer.

    Parameters
    ----------
    failed : Solution
        What the solver ended with.
    nlp : Nlp
        What it was given, with the durations it started from.
    guess : Guess, Solution or None
        What the user gave. Guesses with a course of their own are not replaced.
    solve : callable
        (problem, guess) -> Solution, on the same mesh.

    Returns
    -------
    Solution or None
        None where more time does not help, or nothing is free to take it.
    """
    problem = failed.problem
    free = [layout.duration.column is not None for layout in nlp.layouts]
    contacts = any(phase.bound_contacts for phase in problem.phases)
    if failed.status not in LOST or not any(free) or contacts:
        return None
    if not (guess is None or isinstance(guess, StraightLine | Solution)):
        return None
    spent, iterations = failed.times, failed.iterations

    def counted(solution: Solution) -> Solution:
        nonlocal spent, iterations
        spent, iterations = added_times(spent, solution.times), iterations + solution.iterations
        return solution

    tried: set[tuple[float, ...]] = set()
    for times in TIMES:
        durations = tuple(_duration(nlp, i, times) for i in range(len(free)))
        if durations in tried:
            break
        tried.add(durations)
        ample = [
            replace(phase, duration=duration, objective=None) if is_free else phase
            for phase, duration, is_free in zip(problem.phases, durations, free, strict=True)
        ]
        motion = counted(solve(Problem(ample, problem.links), None))
        found = counted(solve(problem, motion)) if motion.success else motion
        if found.status is Status.INTERRUPTED:
            return replace(failed, status=Status.INTERRUPTED, times=spent, iterations=iterations)
        if found.success:
            seconds = " and ".join(f"{t:.3g} s" for t, is_free in zip(durations, free, strict=True) if is_free)
            message = f"{found.message}, from a motion of {seconds}: the guess was too short"
            return replace(found, message=message, times=spent, iterations=iterations)
    return None


def _duration(nlp: Nlp, index: int, times: float) -> float:
    """Duration of a phase [s]: its own where that is fixed, else so many times the guessed one, within its bounds."""
    scalar = nlp.layouts[index].duration
    if scalar.column is None:
        return float(scalar.value)
    return float(np.clip(times * nlp.guess[scalar.column], *nlp.problem.phases[index].duration_bounds))
