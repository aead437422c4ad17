"""Co-design: numbers of a robot that are best for several motions, by the gradients of their optima."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import minimize

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.applications.many.one_of_many import check_options, continued, planned
from robotraj.applications.many.posed import as_problem, made
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.errors import NoSolutionFound
from robotraj.solution.released import released
from robotraj.solution.solution import Solution

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.applications.many.options import GuessedChoices

Posed = Problem | Phase
Make = Callable[[Any], Posed | Sequence[Posed]]

AT_BOUND = 1e-6
"""Distance from a bound, relative to the range, below which a number is at it."""


@dataclass(frozen=True, eq=False)
class Codesign(OneLine):
    """The best numbers of a design that were found, with the motions that they serve.

    Attributes
    ----------
    values : mapping of str to float
        The numbers.
    objective : float
        Sum of the objectives of all motions.
    gradient : mapping of str to float
        Derivative of the objective by each number: near zero, or pointing out of the range at a bound.
    at_bounds : tuple of str
        Numbers that ended at a bound.
    solutions : tuple of Solution
        The motions.
    steps : tuple of (mapping of str to float, float)
        Numbers and objective of every design that was planned.
    converged : bool
        Whether the search met its tolerance.
    """

    values: Mapping[str, float]
    objective: float
    gradient: Mapping[str, float]
    at_bounds: tuple[str, ...]
    solutions: tuple[Solution, ...]
    steps: tuple[tuple[Mapping[str, float], float], ...]
    converged: bool

    def __str__(self) -> str:
        first = self.steps[0][1]
        head = f"objective {self.objective:.6g}, {first:.6g} at first, {len(self.steps)} designs planned"
        return "\n".join(
            [head + ("" if self.converged else "; not converged")]
            + [
                f"  {name}: {value:.6g}, slope {self.gradient[name]:.3g}"
                + (" (bound)" if name in self.at_bounds else "")
                for name, value in self.values.items()
            ]
        )


def codesign(
    make: Make,
    numbers: Mapping[str, tuple[float, float]],
    *,
    start: Mapping[str, float] | None = None,
    accuracy: float = 1e-4,
    most: int = 40,
    **options: Unpack[GuessedChoices],
) -> Codesign:
    """Find the numbers of a design for which the sum of the objectives of several motions is least.

    Each design is planned from the motions of the last one, on their meshes. The gradient of the sum is that of
    ``solution.sensitivity``, without further plans. L-BFGS-B, a quasi-Newton method with bounds, finds a local
    optimum. For one motion, an unknown of its plan is cheaper: ``parameters={"length": rt.between(0.3, 0.6)}``.

    Parameters
    ----------
    make : callable
        From the numbers by name to one problem or several, in which they are fixed:
        ``rt.Phase(..., parameters={"length": case["length"]}, design={"length": rt.design.LinkLength("elbow")})``.
    numbers : mapping of str to (float, float)
        Bounds of each number, such as ``{"length": (0.3, 0.6), "ratio": (20, 150)}``.
    start : mapping of str to float, optional
        Where the search begins; by default the middle of the bounds.
    accuracy : float
        Relative change of the objective at which the search ends.
    most : int
        Largest number of designs that are planned.
    **options
        Of ``rt.plan``, without those of a single plan.

    Raises
    ------
    InputError
        A number has no range, or a start outside of it.
    NoSolutionFound
        A motion was not found; the message names the numbers.

    Notes
    -----
    Source: Byrd, Lu, Nocedal, Zhu, A limited memory algorithm for bound constrained optimization, SIAM J. Sci. Comput.
    16 (1995).
    """
    check_options("rt.applications.codesign", options, codesign)
    names, low, high = _ranges(numbers)
    first = {name: (low[i] + high[i]) / 2 for i, name in enumerate(names)} | dict(start or {})
    x0 = (np.array([first[name] for name in names]) - low) / (high - low)
    if sorted(first) != sorted(names) or not np.all((x0 >= 0.0) & (x0 <= 1.0)):
        raise InputError(f"start= is {dict(start or {})!r}; its numbers are those of numbers=, within their bounds.")
    known: list[_Design] = []

    def evaluated(x: Array) -> tuple[float, Array]:
        case = dict(zip(names, (low + x * (high - low)).tolist(), strict=True))
        known.append(_planned(make, case, known[-1] if known else None, options))
        return known[-1].objective, known[-1].gradient * (high - low)

    found = minimize(
        evaluated,
        x0,
        jac=True,
        bounds=[(0.0, 1.0)] * len(names),
        method="L-BFGS-B",
        options={"ftol": accuracy, "gtol": 0.0, "maxfun": most, "maxls": 8},
    )
    best = min(known, key=lambda each: each.objective)
    x = (np.array(list(best.case.values())) - low) / (high - low)
    return Codesign(
        best.case,
        best.objective,
        dict(zip(names, best.gradient.tolist(), strict=True)),
        tuple(name for name, own in zip(names, x, strict=True) if min(own, 1.0 - own) < AT_BOUND),
        tuple(released(each) for each in best.solutions),
        tuple((each.case, each.objective) for each in known),
        bool(found.success),
    )


@dataclass(frozen=True, eq=False)
class _Design:
    """A design that was planned."""

    case: Mapping[str, float]
    solutions: tuple[Solution, ...]
    objective: float
    gradient: Array


def _planned(make: Make, case: Mapping[str, float], last: _Design | None, options: GuessedChoices) -> _Design:
    """Plan the motions of a design, from those of the last one."""
    problems = _posed(make, case)
    solutions = []
    for i, problem in enumerate(problems):
        near = None if last is None else last.solutions[i]
        found = planned(options, problem, keep_program=True) if near is None else continued(options, problem, near)
        if not found.success:
            raise NoSolutionFound(f"motion {i} of the design {dict(case)!r} was not solved: {found.cause}", found)
        solutions.append(found)

    def slope(name: str, i: int) -> float:
        return solutions[i].sensitivity(lambda h: _posed(make, {**case, name: case[name] + h})[i])

    gradient = np.array([sum(slope(name, i) for i in range(len(problems))) for name in case])
    return _Design(case, tuple(solutions), sum(each.objective for each in solutions), gradient)


def _posed(make: Make, case: Mapping[str, float]) -> list[Problem]:
    given = made(make, case)
    return [as_problem(each) for each in (given if isinstance(given, list | tuple) else [given])]


def _ranges(numbers: Mapping[str, tuple[float, float]]) -> tuple[list[str], Array, Array]:
    """Return names and bounds of the numbers."""
    for name, bounds in numbers.items():
        if np.shape(bounds) != (2,) or not np.isfinite(bounds).all() or not bounds[0] < bounds[1]:
            raise InputError(f"numbers= has {bounds!r} for {name!r}; give (low, high), such as (0.3, 0.6).")
    if not numbers:
        raise InputError("numbers= is empty; give the bounds of the numbers of the design, {'length': (0.3, 0.6)}.")
    low, high = np.array(list(numbers.values()), dtype=float).T
    return list(numbers), low, high
