"""Attempts of the interior-point method at one program, and the order in which they follow each other."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.solvers.status import STATUSES, Status

if TYPE_CHECKING:
    import numpy as np

    from robotraj.native import Outcome as NativeOutcome

    Array = NDArray[np.float64]

FACTORS = (100.0, 10.0)
"""Error of the problem of one barrier parameter below which the parameter falls, in multiples of the parameter.

The first takes fewer iterations. If its line search fails, the attempt begins again with the second.
"""
AHEAD = 30.0
"""Factor on ``FACTORS`` from a guess with a small barrier: its problem need not be solved before a smaller one's."""
PATIENCE_STAGES = (500,)
PATIENCE_ASSEMBLED = (150, 250)
"""Iterations of the attempts before the last one: of problems in stages, and of assembled ones.

Near singular postures such as straight knees an attempt may wander without converging. With contacts, attempts that
converge seldom take 100 iterations. Few of the long ones converge from the larger barrier of the second attempt, so
that the third begins as the first one did.
"""
LARGER, LEAST_LARGER = 100.0, 0.1
"""Factor on the first barrier parameter of the second attempt, and the least value of that parameter."""


@dataclass(frozen=True)
class Attempt:
    """One attempt from the guess.

    Attributes
    ----------
    barrier : float
        First barrier parameter.
    from_guess : float
        That of a start from a guess, which decides the scale of the objective.
    iterations : int or None
        Limit of its iterations; None for all that are left.
    known : dict of str to ndarray
        Multipliers from which it starts. Without any, the method estimates them.
    """

    barrier: float
    from_guess: float
    iterations: int | None
    known: dict[str, Array]


class Tried(NamedTuple):
    """The status of the last attempt, the iterations of all, and what each of them found."""

    status: Status
    iterations: int
    found: list[NativeOutcome]


def attempts_from(first: Attempt, patience: tuple[int, ...]) -> list[Attempt]:
    """Return the attempts of a solve: ``first``, one with a larger barrier and without multipliers, and so on in turn.

    Parameters
    ----------
    first : Attempt
    patience : tuple of int
        Iterations of the attempts before the last one, which has those of ``first``.
    """
    barrier = max(LARGER * first.from_guess, LEAST_LARGER)
    both = (first, Attempt(barrier, barrier, first.iterations, {}))
    return [replace(both[k % 2], iterations=limit) for k, limit in enumerate((*patience, first.iterations))]


def solve_in_turn(
    attempts: list[Attempt],
    factors: tuple[float, ...],
    max_iterations: int,
    final: Collection[str],
    solve: Callable[[Attempt, float, int], NativeOutcome],
) -> Tried:
    """Make attempts until one ends neither at the limit of its iterations nor with a failed line search.

    Parameters
    ----------
    attempts : list of Attempt
    factors : tuple of float
        Multiples of the barrier parameter as in ``FACTORS``, each tried after the line search failed with the one
        before.
    max_iterations : int
        Limit of the iterations of all attempts.
    final : collection of str
        Endings of the compiled solver after which no attempt follows.
    solve : callable
        ``solve(attempt, factor, iterations)`` makes one attempt.
    """
    tried = Tried(Status.ITERATION_LIMIT, 0, [])
    for attempt in attempts:
        for factor in factors:
            left = max_iterations - tried.iterations
            found = solve(attempt, factor, left if attempt.iterations is None else min(left, attempt.iterations))
            status = STATUSES.get(found.status, Status.SOLVER_ERROR)
            tried = Tried(status, tried.iterations + found.iterations, [*tried.found, found])
            if found.status in final or tried.iterations >= max_iterations:
                return tried
            if status is not Status.STALLED:
                break
        if status is not Status.ITERATION_LIMIT:
            break
    return tried
