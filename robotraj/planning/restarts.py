"""Other initial guesses for a problem that a solver found infeasible from the given one.

Free durations may be guessed too short. With less time than a motion needs, its constraints conflict. A solver that
minimises their violation may then shorten the duration instead of lengthening it, and ends at a point that is locally
infeasible. The problem is first solved at a fixed and ample duration, without the objective. Any motion that meets the
constraints is a guess, from which the duration falls to its optimum.
Source: Betts, Practical Methods for Optimal Control (2010), section 2.12 (find a feasible point first).

Guesses may also be symmetric to an obstacle, with gradients that point to neither side, or lie at a singular pose.
Seeded random variations avoid both. Each ends at another branch of inverse kinematics, if a pose has several.

Systems whose ends are free, such as reactors, are far from a straight line. Their simulated motion is tried first,
or the straight line where the simulated motion is the default guess.

Passive joints swing, and the relaxed problem has many local optima: from one guess larger torques may seem necessary,
where another motion needs none. More variations are tried there before the problem is called infeasible.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.guess.default import default_guess, moves_freely, other_guess
from robotraj.guess.simulated import Simulated
from robotraj.guess.straight_line import StraightLine
from robotraj.planning.diagnosis.closed_ways import closed_ways
from robotraj.planning.diagnosis.elastic import motion_near, relaxed_motion
from robotraj.planning.diagnosis.explain import completed, excluded
from robotraj.planning.diagnosis.undefined import undefined_expression
from robotraj.planning.diagnosis.unheld_ends import unheld_ends
from robotraj.planning.solve_nlp import conflicts_are_certain
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict, are_certain
from robotraj.solution.records import started_from, with_effort_of
from robotraj.solution.settings import Restarts
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.nlp import Nlp

RESTARTED = (Status.INFEASIBLE, Status.STALLED, Status.ROWS_VIOLATED)
"""Statuses after which another guess is tried."""

VARIATION = "variation of the guess, which did not converge"
"""Description of a start from a variation of the guess."""

UNRELAXED = 2
"""Largest number of variations from which the problem itself is solved, although its relaxed form has conflicts."""

Solve = Callable[[Problem, InitialGuess | Solution | None], Solution]
"""(problem, guess) -> Solution, on the same mesh."""


def restarted(
    failed: Solution,
    nlp: Nlp,
    guess: InitialGuess | Solution | None,
    solve: Solve,
    solve_briefly: Solve,
    restarts: Restarts,
    solve_coarse: Solve,
) -> Solution:
    """Solve a problem that failed again, or find why it has no solution.

    Nothing is tried where no motion exists (``planning.diagnosis.explain.excluded``), or where an obstacle closes the
    way (``planning.diagnosis.closed_ways``). Otherwise the relaxed problem (``planning.diagnosis.elastic``) is solved
    from one start after the other. A motion of it that meets every row is the next guess. If all of them need relaxed
    rows, those of the least sum are the conflicts, or the torques that hold an end where motors cannot
    (``planning.diagnosis.unheld_ends``).

    Parameters
    ----------
    failed : Solution
        The failed solution of the solver.
    nlp : Nlp
        Its NLP, with the guessed durations.
    guess : InitialGuess, Solution or None
        Guess of the user. It is varied, but for a solution; the default guess is varied where none is given.
    solve : callable
        ``solve(problem, guess)`` solves on the same mesh.
    solve_briefly : callable
        The same in few iterations of one solver: it has no second opinion, and most end without a motion.
    restarts : Restarts
    solve_coarse : callable
        ``solve_coarse(problem, guess)`` solves the relaxed problem on a coarse mesh.

    Returns
    -------
    Solution
        The first that was found, else the failed one, with the times and iterations of all attempts.
    """
    problem = failed.problem
    if failed.status not in RESTARTED or undefined_expression(failed):
        return failed
    exclusions = excluded(problem)
    if are_certain(exclusions):
        return replace(failed, status=Status.INFEASIBLE, conflicts=exclusions)
    closed = closed_ways(problem)
    if closed:
        return replace(failed, conflicts=closed)
    if guess is None and moves_freely(problem):
        other, description = (
            (StraightLine(), "straight line, since the simulated motion did not converge")
            if isinstance(default_guess(problem), Simulated)
            else (Simulated(), "simulated motion under constant controls")
        )
        failed = _attempt(failed, solve_briefly, other, description)
        if failed.success or failed.status is Status.INTERRUPTED:
            return failed
    least: tuple[Conflict, ...] = ()
    relaxed: Solution | None = None
    for start in _starts(failed, nlp, guess, restarts):
        motion, conflicts = start.relaxed(problem, solve_coarse)
        if motion is None:
            continue
        motion = replace(motion, rounds=started_from(motion.rounds, "relaxed problem"))
        failed = with_effort_of(motion, failed)
        if motion.status is Status.INTERRUPTED:
            return replace(failed, status=Status.INTERRUPTED)
        if conflicts:
            if relaxed is None or _total(conflicts) < _total(least):
                least, relaxed = conflicts, motion
            if start.certain and all(conflict.physical for conflict in conflicts):
                break
            continue
        found = solve(problem, motion)
        if found.success:
            return with_effort_of(
                failed, replace(found, rounds=started_from(found.rounds, start.described(nlp, found)))
            )
        failed = with_effort_of(found, failed)
        if found.status is Status.INTERRUPTED:
            return replace(failed, status=Status.INTERRUPTED)
        # All rows are met on a coarse mesh, so no limit excludes a motion.
        least, relaxed = (), motion
    if not all(conflict.physical for conflict in least) and not isinstance(guess, Solution):
        # Constraints of the user, such as obstacles, may be passed on another side.
        for branch, seed in enumerate(restarts.seeds[:UNRELAXED], 1):
            failed = _attempt(failed, solve_briefly, other_guess(problem, branch, (seed,), given=guess), VARIATION)
            if failed.success or failed.status is Status.INTERRUPTED:
                return failed
    unheld = unheld_ends(problem) if least or relaxed is None else ()
    return replace(failed, conflicts=unheld or completed(problem, least, relaxed, solve_coarse))


def _attempt(failed: Solution, solve: Solve, guess: InitialGuess, description: str) -> Solution:
    """Solve the problem of a failed solution from another guess.

    Returns the solution, or else the failed one, with the times and iterations of both. An interrupt is its status.
    """
    found = solve(failed.problem, guess)
    found = replace(found, rounds=started_from(found.rounds, description))
    if found.success:
        return with_effort_of(failed, found)
    failed = with_effort_of(found, failed)
    return replace(failed, status=Status.INTERRUPTED) if found.status is Status.INTERRUPTED else failed


def _total(conflicts: Sequence[Conflict]) -> float:
    return sum(conflict.relative for conflict in conflicts)


@dataclass(frozen=True, eq=False)
class _Start:
    """A start of the relaxed problem.

    Attributes
    ----------
    problem : Problem
        The problem; its free durations are fixed if ``durations`` are given.
    guess : InitialGuess, Solution or None
        Guess of the relaxed problem.
    durations : tuple of float
        Durations of all phases [s]; empty if they stay free.
    free : tuple of bool
        Whether the duration of each phase is free in the problem.
    certain : bool
        Whether conflicts of joint limits alone end the search. With a motor at every joint they seldom depend on the
        guess.
    varied : bool
        Whether the guess is a variation of the user's guess or of the default guess.
    """

    problem: Problem
    guess: InitialGuess | Solution | None
    durations: tuple[float, ...] = ()
    free: tuple[bool, ...] = ()
    certain: bool = False
    varied: bool = False

    def relaxed(self, problem: Problem, solve: Solve) -> tuple[Solution | None, tuple[Conflict, ...]]:
        """Return the motion of the relaxed problem from this start, and the rows that it relaxes.

        Rows that conflict at the fixed durations need not conflict in the problem. Its durations are then freed.
        """
        if not self.durations:
            return relaxed_motion(problem, solve, self.guess)
        ample, meets_rows = motion_near(self.problem, solve, self.guess)
        if ample is None or meets_rows or ample.status is Status.INTERRUPTED:
            return ample, ()
        freed, conflicts = relaxed_motion(problem, solve, ample)
        if freed is None:
            return None, ()
        return with_effort_of(ample, freed), conflicts

    def described(self, nlp: Nlp, found: Solution) -> str:
        """Describe the start from which a solution was found."""
        if self.varied:
            return VARIATION
        if self.durations:
            return _motion_text(nlp, self.free, self.durations, found)
        return "motion that meets every row on a coarse mesh"


def _starts(failed: Solution, nlp: Nlp, guess: InitialGuess | Solution | None, restarts: Restarts) -> Iterator[_Start]:
    """Yield longer motions where durations are free, the last iterate, and variations of the guess.

    The last iterate is tried after a guess of the user, such as keyframes, and where all durations are fixed. Longer
    motions replace it where durations are free and the guess is a straight line, a solution or none.
    """
    problem, left = failed.problem, restarts.count
    free = tuple(layout.duration.column is not None for layout in nlp.layouts)
    longer: _Start | None = None
    if any(free):
        tried: set[tuple[float, ...]] = set()
        for times in restarts.longer[:left]:
            durations = tuple(_duration(nlp, i, times) for i in range(len(free)))
            if durations in tried:
                break
            tried.add(durations)
            left -= 1
            try:
                ample = [
                    replace(phase, duration=duration, objective=None) if is_free else phase
                    for phase, duration, is_free in zip(problem.phases, durations, free, strict=True)
                ]
            except InputError:
                # A phase refuses a fixed duration that is too short for its speed limits. The next one is longer.
                continue
            longer = _Start(Problem(ample, problem.links), None, durations, free)
            yield longer
    if left and (isinstance(guess, InitialGuess) and not isinstance(guess, StraightLine) or not any(free)):
        left -= 1
        yield _Start(problem, failed, certain=conflicts_are_certain(nlp))
    if not isinstance(guess, Solution):
        for branch, seed in enumerate(restarts.seeds[:left], 1):
            varied = other_guess(problem, branch, (seed,), given=guess)
            yield replace(longer or _Start(problem, None), guess=varied, varied=True)


def _motion_text(nlp: Nlp, free: Sequence[bool], durations: tuple[float, ...], found: Solution) -> str:
    """Describe the longer motion from which a solution was found, and why the guess failed."""
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
