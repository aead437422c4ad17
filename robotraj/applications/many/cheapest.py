"""The cheapest of several problems: each is planned, and their costs are compared."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.applications.many.failure import Failure
from robotraj.applications.many.sweep import sweep
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.links.touchdown import Touchdown
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.errors import NoSolutionFound
from robotraj.solution.solution import Solution

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.applications.many.options import GuessedChoices

STILL = 1e-6
"""Displacement [m] in a period up to which a gait stays on the spot."""


@dataclass(frozen=True, eq=False)
class Cheapest(OneLine):
    """Planned candidates and their costs.

    Attributes
    ----------
    found : dict of str to Solution or Failure
        The plans by the names of the candidates.
    costs : dict of str to float
        Costs of the plans that were proved, the least first; see ``cheapest``.
    """

    found: Mapping[str, Solution | Failure]
    costs: Mapping[str, float]

    @property
    def best(self) -> str:
        """Name of the candidate with the least cost."""
        return next(iter(self.costs))

    @property
    def solution(self) -> Solution:
        """Its plan."""
        found = self.found[self.best]
        assert isinstance(found, Solution), "candidates with costs were planned"
        return found

    def __str__(self) -> str:
        lines = [f"{name}: {cost:.5g}" for name, cost in self.costs.items()]
        lines += [f"{name}: {each.cause}" for name, each in self.found.items() if name not in self.costs]
        return "\n".join(lines)


def cheapest(
    problems: Mapping[str, Problem | Phase], *, executor: Executor | None = None, **options: Unpack[GuessedChoices]
) -> Cheapest:
    """Plan candidates such as the orders of contacts of ``rt.gait.orders``, and compare their costs.

    The cost is the objective. Of motions that repeat it is J / |L|, the objective per metre of the displacement L along
    x in the planned period, or J / T, per second of its duration T, where none of them moves on. So half a stride
    and a whole one are compared. The candidates are problems of one task: the orders of the given ones are compared,
    and no others.

    Parameters
    ----------
    problems : mapping of str to Problem or Phase
        Candidates by name.
    executor : concurrent.futures.Executor, optional
        As for ``rt.sweep``.
    **options
        Of ``rt.plan``. On a given mesh nothing is proved, and solved plans are compared.

    Raises
    ------
    InputError
        There is no candidate, an entry is no problem, or all of them raise errors.
    NoSolutionFound
        No candidate was proved; the message has the cause of each.
    """
    if not isinstance(problems, Mapping) or not problems:
        raise InputError(
            f"rt.applications.cheapest takes problems by name, such as rt.gait.orders(...); got {problems!r}."
        )
    found = dict(zip(problems, sweep(list(problems.values()), executor=executor, **options), strict=True))
    held = {name: each for name, each in found.items() if isinstance(each, Solution) and _counts(each)}
    if not held:
        causes = "None of the candidates was solved: " + "; ".join(f"{n}: {each.cause}" for n, each in found.items())
        tried = [each for each in found.values() if isinstance(each, Solution)]
        raise NoSolutionFound(causes, tried[-1]) if tried else InputError(causes)
    lengths = {name: _displacement(each) for name, each in held.items()}
    moving = any(np.isfinite(length) and length > STILL for length in lengths.values())
    costs = {name: each.objective / _size(each, lengths[name], moving) for name, each in held.items()}
    return Cheapest(found, dict(sorted(costs.items(), key=lambda item: item[1])))


def _counts(solution: Solution) -> bool:
    """Whether a plan was proved, or solved where nothing was measured."""
    return solution.success and (solution.proof is None or solution.proof.holds)


def _displacement(solution: Solution) -> float:
    """Return the displacement along x in the planned period [m]; infinite for a motion that does not repeat."""
    links = [link.repeat if isinstance(link, Touchdown) else link for link in solution.problem.links]
    robot = solution.problem.phases[0].robot
    if robot is None or robot.root == "fixed" or not any(isinstance(link, Mirror | Periodic) for link in links):
        return np.inf
    return float(abs(solution.at(solution.duration).q[0] - solution.at(0.0).q[0]))


def _size(solution: Solution, length: float, moving: bool) -> float:
    """Return by what the objective is divided: metres or seconds of a period, 1 for a motion that does not repeat."""
    if not np.isfinite(length):
        return 1.0
    return max(length, STILL) if moving else solution.duration
