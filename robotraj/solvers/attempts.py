"""Attempts of the interior-point method at one program, and the order in which they follow each other."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, NamedTuple

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.solvers.status import STATUSES, Status

if TYPE_CHECKING:
    from robotraj.native import Outcome as NativeOutcome

FACTOR = 100.0
"""Error of the problem of one barrier parameter below which the parameter falls, in multiples of the parameter."""
AHEAD = 30.0
"""Factor on ``FACTOR`` from a guess with a small barrier: its problem need not be solved before a smaller one's."""
PATIENCE_STAGES = (500,)
PATIENCE_ASSEMBLED = (200, 250)
"""Iterations of the attempts before the last one: of problems in stages, and of assembled ones.

Near singular postures such as straight knees an attempt may wander without converging. With contacts, first attempts
that converge take up to 200 iterations, and seldom 100.
"""
LARGER, LEAST_LARGER = 100.0, 0.1
"""Factor on the first barrier parameter of later attempts, and the least value of that parameter."""
LIGHTER = 0.1
"""Weight of the objective in the third attempt."""


@dataclass(frozen=True)
class WeighedAttempt:
    """One attempt from the guess.

    Attributes
    ----------
    barrier : float
        First barrier parameter.
    factor : float
        Multiple of the barrier parameter, as ``FACTOR``.
    weight : float
        Factor on the scale of the objective.
    known : dict of str to ndarray
        Multipliers from which it starts. Without any, the method estimates them.
    """

    barrier: float
    factor: float
    weight: float
    known: dict[str, Array]


def later_attempts(from_guess: float, factor: float) -> tuple[WeighedAttempt, WeighedAttempt]:
    """Return the second and the third attempt of a solve, both with a larger barrier and without multipliers.

    In the second one the barrier weighs as much beside the objective as in the first, and rows weigh less: a step of
    five_link from a poor guess and turning trots of solo12 converge so. In the third one barrier and rows outweigh
    the objective for longer: feet find their stairs.

    Parameters
    ----------
    from_guess : float
        First barrier parameter of a start from a guess.
    factor : float
        Of ``WeighedAttempt``.
    """
    barrier = max(LARGER * from_guess, LEAST_LARGER)
    return WeighedAttempt(barrier, factor, barrier / from_guess, {}), WeighedAttempt(barrier, factor, LIGHTER, {})


class Tried(NamedTuple):
    """The status of the last attempt, the iterations of all, and what each of them found."""

    status: Status
    iterations: int
    found: list[NativeOutcome]


def solve_in_turn(
    attempts: tuple[WeighedAttempt, ...],
    patience: tuple[int, ...],
    max_iterations: int,
    final: Collection[str],
    solve: Callable[[WeighedAttempt, int], NativeOutcome],
) -> Tried:
    """Make attempts until one ends neither at the limit of its iterations nor with a failed line search.

    Parameters
    ----------
    attempts : tuple of WeighedAttempt
    patience : tuple of int
        Iterations of all attempts that are made but the last one, which has those that are left.
    max_iterations : int
        Limit of the iterations of all attempts.
    final : collection of str
        Endings of the compiled solver after which no attempt follows.
    solve : callable
        ``solve(attempt, iterations)`` makes one attempt.
    """
    tried = Tried(Status.ITERATION_LIMIT, 0, [])
    for attempt, limit in zip(attempts, (*patience, max_iterations), strict=False):
        found = solve(attempt, min(limit, max_iterations - tried.iterations))
        status = STATUSES.get(found.status, Status.SOLVER_ERROR)
        tried = Tried(status, tried.iterations + found.iterations, [*tried.found, found])
        ended = status not in (Status.ITERATION_LIMIT, Status.STALLED)
        if ended or found.status in final or tried.iterations >= max_iterations:
            break
    return tried
