"""Other initial guesses, for a problem that a solver found infeasible from the given one.

Free durations may be guessed too short. With less time than a motion needs, its constraints conflict. A solver that
minimises their violation may then shorten the duration instead of lengthening it, and ends at a point that is locally
infeasible. At a fixed and ample duration, without the objective, any motion that meets the constraints is a guess from
which the duration falls to its optimum.
Source: Betts, Practical Methods for Optimal Control (2010), section 2.12 (find a feasible point first).

Guesses may also lie where gradients point to neither side of an obstacle, or at a singular pose. Seeded random
variations of them do not; each of them ends at another branch of inverse kinematics, where a pose has several.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from robotraj._util.errors import InputError
from robotraj.guess.base import InitialGuess
from robotraj.guess.default import other_guess
from robotraj.guess.straight_line import StraightLine
from robotraj.planning.diagnosis.elastic import relaxed_motion
from robotraj.problem.problem import Problem
from robotraj.solution.records import added_times
from robotraj.solution.settings import Restarts
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.nlp import Nlp

LOST = (Status.INFEASIBLE, Status.STALLED, Status.ROWS_VIOLATED)
"""Statuses after which another guess is tried."""

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
    """Solve a problem that failed again: from longer motions, variations, and a motion that meets every constraint.

    A relaxed problem (``robotraj.planning.diagnosis.elastic``) shows which limits conflict; where they are limits of
    joints or of a fixed duration alone, no variation is tried, since no other guess changes a limit.

    Parameters
    ----------
    failed : Solution
        The solution of the solver.
    nlp : Nlp
        Its program, with the guessed durations.
    guess : InitialGuess, Solution or None
        That of the user. Guesses other than a straight line or a solution are not replaced, and the default guess is
        varied only where none is given.
    solve : callable
    restarts : Restarts
    coarsely : callable
        Solves on a coarse mesh, for the relaxed problem.

    Returns
    -------
    Solution
        The first that was found, else the one that failed; with the seconds and iterations of all attempts.
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
    for branch, seed in enumerate(seeds, 1):
        found = solve(problem, other_guess(problem, branch, (seed,)))
        yield found, "variation of the default guess, which did not converge"
    if motion is not None and not conflicts:
        yield solve(problem, motion), "motion that meets every row on a coarse mesh"


def _from_longer(
    problem: Problem, nlp: Nlp, guess: InitialGuess | Solution | None, solve: Solve, factors: Sequence[float]
) -> Iterator[tuple[Solution, str]]:
    """Start from longer motions; each solution is named by its motion, the motions themselves are not named."""
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
            # A fixed duration that the speed limits do not allow is refused; the next one is longer.
            continue
        motion = solve(Problem(ample, problem.links), None)
        yield motion, ""
        if motion.success:
            found = solve(problem, motion)
            yield found, _whence(nlp, free, durations, found)


def _whence(nlp: Nlp, free: list[bool], durations: tuple[float, ...], found: Solution) -> str:
    """Describe the motion from which a solution was found, and whether the guess was shorter than the solution."""
    chosen = [i for i, is_free in enumerate(free) if is_free]
    seconds = " and ".join(f"{durations[i]:.3g} s" for i in chosen)
    short = sum(found.phases[i].duration - _duration(nlp, i, 1.0) for i in chosen) > 0
    return f"motion of {seconds}: the guess {'was too short' if short else 'did not converge'}"


def _duration(nlp: Nlp, index: int, times: float) -> float:
    """Return the duration of a phase [s]: the fixed one, or ``times`` the guessed one within its bounds."""
    scalar = nlp.layouts[index].duration
    if scalar.column is None:
        return float(scalar.value)
    return float(np.clip(times * nlp.guess[scalar.column], *nlp.problem.phases[index].duration_bounds))
