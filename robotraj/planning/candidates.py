"""Plans with each candidate of ``rt.constraints.OneOf``, and the best of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import product
from typing import cast

import numpy as np

from robotraj._util.errors import InputError
from robotraj.problem.constraints.base import AtEnd, AtStart, Constraint
from robotraj.problem.constraints.task_space.candidates import OneOf
from robotraj.problem.problem import Problem
from robotraj.solution.records import added_times
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status

MOST = 64
"""Largest number of combinations of candidates."""


def with_candidates(find: Callable[..., Solution]) -> Callable[..., Solution]:
    """Return a function that applies ``find(problem, ...)`` to every combination of candidates.

    It returns the solution of least objective, with the seconds and iterations of all plans. Where none succeeds, it
    returns the first.
    """

    def best(problem: Problem, *arguments: object) -> Solution:
        chosen: Solution | None = None
        times, iterations = dict[str, float](), 0
        for each in _combinations(problem):
            try:
                found = find(each, *arguments)
            except KeyboardInterrupt:
                # Ctrl-C or a limit between two plans: the best so far is kept.
                if chosen is None:
                    raise
                break
            times, iterations = added_times(times, found.times), iterations + found.iterations
            if chosen is None or _cost(found) < _cost(chosen):
                chosen = found
            if found.status is Status.INTERRUPTED:
                break
        assert chosen is not None
        return replace(chosen, times=times, iterations=iterations)

    return best


def has_candidates(problem: Problem) -> bool:
    """Whether a phase has ``rt.constraints.OneOf``."""
    return any(_inner(each) is not None for phase in problem.phases for each in phase.constraints)


def _cost(solution: Solution) -> float:
    return solution.objective if solution.success else np.inf


def _inner(constraint: Constraint) -> OneOf | None:
    from robotraj.problem.constraints.task_space.candidates import OneOf

    while isinstance(constraint, AtStart | AtEnd):
        constraint = constraint.constraint
    return constraint if isinstance(constraint, OneOf) else None


def _choose(constraint: Constraint, number: int) -> Constraint:
    if isinstance(constraint, AtStart | AtEnd):
        return type(constraint)(_choose(constraint.constraint, number))
    return replace(cast("OneOf", constraint), chosen=number)


def _combinations(problem: Problem) -> Iterator[Problem]:
    """Yield the problem with every combination of candidates.

    Raises
    ------
    InputError
        There are too many combinations.
    """
    places = [
        (i, k, len(inner.candidates))
        for i, phase in enumerate(problem.phases)
        for k, each in enumerate(phase.constraints)
        if (inner := _inner(each)) is not None
    ]
    count = int(np.prod([size for *_, size in places], dtype=float))
    if count > MOST:
        raise InputError(f"OneOf: {count} combinations of candidates are more than {MOST}; leave some out.")
    for numbers in product(*(range(size) for *_, size in places)):
        phases = list(problem.phases)
        for (i, k, _), number in zip(places, numbers, strict=True):
            constraints = list(phases[i].constraints)
            constraints[k] = _choose(constraints[k], number)
            phases[i] = phases[i].with_(constraints=constraints)
        yield Problem(phases, problem.links)
