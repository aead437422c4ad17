"""The front of two objectives, with points where its gaps are largest."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine, table
from robotraj._util.values import dataclass
from robotraj.applications.many.one_of_many import check_options, continued, planned
from robotraj.applications.many.posed import posed
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.errors import NoSolutionFound
from robotraj.solution.released import released
from robotraj.solution.solution import Solution
from robotraj.solvers.checks import counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from typing_extensions import Unpack

    from robotraj.applications.many.options import GuessedChoices

SAME = 1e-3
"""Distance of a new point to its neighbour, relative to the front, below which no point lies between the two."""


@dataclass(frozen=True, eq=False)
class FrontPoint(OneLine):
    """One point of a front.

    Attributes
    ----------
    weight : float
        Weight of the second objective.
    first, second : float
        Values of both objectives.
    solution : Solution
    """

    weight: float
    first: float
    second: float
    solution: Solution


@dataclass(frozen=True, eq=False)
class Front(OneLine):
    """Motions of which none is better than another in both objectives.

    Attributes
    ----------
    points : tuple of FrontPoint
        In the order of their weights: the first objective rises, the second falls.
    """

    points: tuple[FrontPoint, ...]

    @property
    def largest_gap(self) -> float:
        """Largest distance of two neighbours, both objectives relative to the range of the front."""
        return max(_gaps(self.points), default=0.0)

    def plot(self) -> Figure:
        """Draw one objective over the other."""
        from matplotlib.figure import Figure

        figure = Figure(layout="constrained")
        axes = figure.add_subplot(xlabel="first objective", ylabel="second objective")
        axes.plot([each.first for each in self.points], [each.second for each in self.points], "o-", markersize=4)
        return figure

    def __str__(self) -> str:
        rows = [(f"{each.weight:.4g}", f"{each.first:.5g}", f"{each.second:.5g}") for each in self.points]
        return "\n".join([f"front of {len(rows)} points", *table([("weight", "first", "second"), *rows])])


def pareto(
    make: Callable[[float], Problem | Phase],
    weights: tuple[float, float],
    points: int = 10,
    **options: Unpack[GuessedChoices],
) -> Front:
    """Plan the front of two objectives between two weights, with points where its gaps are largest.

    ``make(w)`` has the objective  first + w second.  The value of the second one is the derivative of the optimum by w,
    which ``solution.sensitivity`` returns. Between the two neighbours with the largest gap, the next weight is the
    slope of their chord, so that its point is the one furthest below the chord. Each plan starts from a neighbour.

    Parameters
    ----------
    make : callable
        ``lambda w: phase.with_(objective=rt.Effort() + w * rt.Duration())``.
    weights : (float, float)
        Smallest and largest weight, above 0.
    points : int
        Number of plans. Fewer are made where all gaps are closed, or bridge a part that no weight reaches: weights
        reach the convex part of a front. The other parts need one objective at fixed values, such as durations.
    **options
        Of ``rt.plan``, without those of a single plan.

    Raises
    ------
    InputError
        The weights are not two rising numbers above 0, or there are fewer than 2 points.
    NoSolutionFound
        A point was not found; the message names its weight.

    Notes
    -----
    Source: Aneja and Nair, Bicriteria transportation problem, Management Science 25 (1979).
    """
    check_options("rt.applications.pareto", options, pareto)
    counted("rt.applications.pareto(points)", points)
    if np.shape(weights) != (2,) or not np.isfinite(weights).all() or not 0.0 < weights[0] < weights[1] or points < 2:
        raise InputError(f"weights= is {weights!r}, points= {points!r}; give 0 < low < high, and 2 points or more.")
    known = [_point(make, weights[0], None, options)]
    known.append(_point(make, weights[1], known[0].solution, options))
    closed: set[tuple[float, float]] = set()
    while len(known) < points:
        known.sort(key=lambda each: each.weight)
        pairs = list(zip(known[:-1], known[1:], _gaps(known), strict=True))
        open_pairs = [pair for pair in pairs if (pair[0].weight, pair[1].weight) not in closed and pair[2] > SAME]
        if not open_pairs:
            break
        below, above, _ = max(open_pairs, key=lambda pair: pair[2])
        weight = _between(below, above)
        if weight is None:
            closed.add((below.weight, above.weight))
            continue
        new = _point(make, weight, below.solution, options)
        known.append(new)
        known.sort(key=lambda each: each.weight)
        at, gaps = known.index(new), _gaps(known)
        for i in (at - 1, at):
            if gaps[i] < SAME:
                # The point is one of the two: nothing below their chord is left.
                other = at + 1 if i == at - 1 else at - 1
                closed.add((known[min(at, other)].weight, known[max(at, other)].weight))
    best = sorted(known, key=lambda each: each.weight)
    return Front(tuple(FrontPoint(e.weight, e.first, e.second, released(e.solution)) for e in best))


def _point(
    make: Callable[[float], Problem | Phase], weight: float, near: Solution | None, options: GuessedChoices
) -> FrontPoint:
    problem = posed(make, weight)
    found = planned(options, problem, keep_program=True) if near is None else continued(options, problem, near)
    if not found.success:
        raise NoSolutionFound(f"the point of the weight {weight:.6g} was not solved: {found.cause}", found)
    second = found.sensitivity(lambda h: make(weight + h))
    return FrontPoint(weight, found.objective - weight * second, second, found)


def _between(below: FrontPoint, above: FrontPoint) -> float | None:
    """Return the slope of the chord; None where it is no weight between those of its ends."""
    fall = below.second - above.second
    slope = (above.first - below.first) / fall if fall > 0.0 else np.nan
    apart = 1.0 + 1e-6
    return float(slope) if below.weight * apart < slope < above.weight / apart else None


def _gaps(points: list[FrontPoint] | tuple[FrontPoint, ...]) -> list[float]:
    """Return the distances of neighbours, relative to the ranges of both objectives."""
    values = np.array([(each.first, each.second) for each in points])
    ranges = np.ptp(values, axis=0)
    return np.linalg.norm(np.diff(values, axis=0) / np.where(ranges > 0.0, ranges, 1.0), axis=1).tolist()
