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
from functools import partial

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.fixed_mesh.at_points import AtPoints
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.closed_ways import closed_ways
from robotraj.fixed_mesh.diagnosis.elastic import motion_near, relaxed_motion
from robotraj.fixed_mesh.diagnosis.explain import completed, excluded
from robotraj.fixed_mesh.diagnosis.undefined import undefined_expression
from robotraj.fixed_mesh.diagnosis.unheld_ends import unheld_ends
from robotraj.fixed_mesh.solve_nlp import conflicts_are_certain
from robotraj.fixed_mesh.warm_start import PATIENCE
from robotraj.fixed_mesh.watched import watched_attempt
from robotraj.guess.default import default_guess, moves_freely, other_guess
from robotraj.guess.simulated import Simulated
from robotraj.guess.straight_line import StraightLine
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict, are_certain
from robotraj.solution.records import started_from, with_effort_of
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status
from robotraj.transcription.nlp import Nlp

RESTARTED = (Status.INFEASIBLE, Status.STALLED, Status.ROWS_VIOLATED)
"""Statuses after which another guess is tried."""

VARIATION = "variation of the guess, which did not converge"
"""Description of a start from a variation of the guess."""


def restarted(
    failed: AtPoints,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
) -> AtPoints:
    """Solve a problem that failed again, or find why it has no solution.

    Nothing is tried where no motion exists (``diagnosis.explain.excluded``), or where an obstacle closes the way
    (``diagnosis.closed_ways``). Otherwise the relaxed problem (``diagnosis.elastic``) is solved from one start after
    the other. A motion of it that meets every row is the next guess. If all of them need relaxed rows, those of the
    least sum are the conflicts, or the torques that hold an end where motors cannot (``diagnosis.unheld_ends``).

    Parameters
    ----------
    failed : AtPoints
    guess : InitialGuess, Solution or None
        Guess of the user. It is varied, but for a solution; the default guess is varied where none is given.
    settings : Settings
    progress : callable, optional

    Returns
    -------
    AtPoints
        The first that was found, else the failed one, with the times and iterations of all attempts.
    """
    problem, nlp, restarts = failed.posed.problem, failed.posed.nlp, settings.restarts
    if failed.solution.status not in RESTARTED or undefined_expression(failed.solution):
        return failed
    exclusions = excluded(problem)
    if are_certain(exclusions):
        return failed.changed(status=Status.INFEASIBLE, conflicts=exclusions)
    closed = closed_ways(problem)
    if closed:
        return failed.changed(conflicts=closed)
    again, coarse = replace(settings, restarts=Restarts(0)), CoarseSolves(settings, progress)
    brief = replace(again, solver=settings.solver.at_most(2 * PATIENCE))
    if guess is None and moves_freely(problem):
        other, description = (
            (StraightLine(), "straight line, since the simulated motion did not converge")
            if isinstance(default_guess(problem), Simulated)
            else (Simulated(), "simulated motion under constant controls")
        )
        failed = _attempt(failed, other, description, brief, progress)
        if failed.is_over:
            return failed
    least: tuple[Conflict, ...] = ()
    relaxed: Solution | None = None
    for start in _starts(failed.solution, nlp, guess, restarts):
        motion, conflicts = start.relaxed(problem, coarse)
        if motion is None:
            continue
        failed = failed.after(replace(motion, rounds=started_from(motion.rounds, "relaxed problem")))
        if motion.status is Status.INTERRUPTED:
            return failed.changed(status=Status.INTERRUPTED)
        if conflicts:
            if relaxed is None or _total(conflicts) < _total(least):
                least, relaxed = conflicts, motion
            if start.certain and all(conflict.physical for conflict in conflicts):
                break
            continue
        failed = _attempt(failed, motion, partial(start.described, nlp), again, progress)
        if failed.is_over:
            return failed
        # All rows are met on a coarse mesh, so no limit excludes a motion.
        least, relaxed = (), motion
    if not all(conflict.physical for conflict in least) and not isinstance(guess, Solution):
        # Constraints of the user, such as obstacles, may be passed on another side. More variations seldom help there.
        for branch, seed in enumerate(restarts.seeds[: len(Restarts.seeds)], 1):
            varied = other_guess(problem, branch, (seed,), given=guess)
            failed = _attempt(failed, varied, VARIATION, brief, progress)
            if failed.is_over:
                return failed
    unheld = unheld_ends(problem) if least or relaxed is None else ()
    return failed.changed(conflicts=unheld or completed(problem, least, relaxed, coarse))


def _attempt(
    failed: AtPoints,
    guess: InitialGuess | Solution,
    described: str | Callable[[Solution], str],
    settings: Settings,
    progress: Progress | None,
) -> AtPoints:
    """Solve the problem of a failed attempt from another guess.

    Returns the attempt, or else the failed one, with the times and iterations of both. An interrupt is its status.
    """
    found = watched_attempt(failed.posed.problem, guess, settings, progress)
    if found.solution.success:
        description = described if isinstance(described, str) else described(found.solution)
        return found.changed(rounds=started_from(found.solution.rounds, description)).after(failed.solution)
    failed = failed.after(found.solution)
    is_interrupted = found.solution.status is Status.INTERRUPTED
    return failed.changed(status=Status.INTERRUPTED) if is_interrupted else failed


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

    def relaxed(self, problem: Problem, coarse: CoarseSolves) -> tuple[Solution | None, tuple[Conflict, ...]]:
        """Return the motion of the relaxed problem from this start, and the rows that it relaxes.

        Rows that conflict at the fixed durations need not conflict in the problem. Its durations are then freed.
        """
        if not self.durations:
            return relaxed_motion(problem, coarse, self.guess)
        ample, meets_rows = motion_near(self.problem, coarse, self.guess)
        if ample is None or meets_rows or ample.status is Status.INTERRUPTED:
            return ample, ()
        freed, conflicts = relaxed_motion(problem, coarse, ample)
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
