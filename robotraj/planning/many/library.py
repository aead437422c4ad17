"""Libraries of motions: problems of a few numbers, planned from neighbour to neighbour, queried and blended."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.guess.earlier.blend import Blend
from robotraj.planning.many.failure import Failure, failure_of
from robotraj.planning.many.sweep import check_options, continued, planned
from robotraj.planning.plan import plan
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.released import released
from robotraj.solution.solution import Solution

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.planning.many.options import Choices, GuessedChoices

Array = NDArray[np.float64]
Case = Mapping[str, float]

USED = 1e-9
"""Least weight of a solution that a blend uses."""


@dataclass(frozen=True, eq=False)
class Library(OneLine):
    """Solutions of one kind of problem for several values of its numbers, returned by ``rt.planning.library``.

    Attributes
    ----------
    make : callable
        From the numbers of a case by name to its problem.
    cases : tuple of mapping of str to float
        Cases that were solved.
    solutions : tuple of Solution
        Their solutions.
    failures : tuple of (mapping of str to float, Solution or Failure)
        Cases that were not solved, with what came of them.
    """

    make: Callable[[Case], Problem | Phase]
    cases: tuple[Case, ...]
    solutions: tuple[Solution, ...]
    failures: tuple[tuple[Case, Solution | Failure], ...]

    def weights(self, case: Case) -> Array:
        """Return weights (n,) of the solutions, for a blend whose case is the one given.

        They are the solution of the linear program  min sum_i w_i |x_i - x|^2  with  sum_i w_i = 1,  sum_i w_i x_i = x
        and w >= 0, with all numbers divided by the range that they cover. These are the barycentric coordinates in the
        Delaunay triangulation of the cases. A case outside their hull takes the nearest solution alone.

        Source: Edelsbrunner and Seidel, Voronoi diagrams and arrangements, Discrete Comput. Geom. 1 (1986).

        Raises
        ------
        InputError
            The case has other numbers than those of the library, or nothing was solved.
        """
        if not self.cases:
            raise InputError("The library has no solutions: every case failed, as library.failures states.")
        names = sorted(self.cases[0])
        asked = _row(case, names)
        rows = np.array([_row(each, names) for each in self.cases])
        away = (rows - asked) / _ranges(rows)
        found = linprog(
            np.sum(away**2, axis=1),
            A_eq=np.vstack([np.ones(len(rows)), away.T]),
            b_eq=np.append(1.0, np.zeros(len(names))),
            bounds=(0.0, None),
        )
        if found.success:
            used = np.where(found.x > USED, found.x, 0.0)
            return np.asarray(used / used.sum())
        return np.eye(len(rows))[int(np.argmin(np.sum(away**2, axis=1)))]

    def guess(self, case: Case) -> Blend:
        """Return the blend of the solutions around a case, as a guess of its plan."""
        weights = self.weights(case)
        used = [int(i) for i in np.flatnonzero(weights)]
        return Blend([self.solutions[i] for i in used], weights[used])

    def plan(self, case: Case, **options: Unpack[Choices]) -> Solution:
        """Plan a case from the blend of the solutions around it; further options are those of ``rt.plan``.

        Raises
        ------
        NoSolutionFound
            No motion was found.
        """
        return plan(self.make(case), guess=self.guess(case), **options)

    def arrays(self, samples: int = 50) -> dict[str, Array]:
        """Return all motions as arrays, for learning and control: ``np.savez("gaits.npz", **library.arrays())``.

        Parameters
        ----------
        samples : int
            Number m of samples of each motion, at equal distances in time.

        Returns
        -------
        dict of str to ndarray
            Each number of the cases by its name (n,), and by "t" [s] (n, m), "q" (n, m, nq), "v" (n, m, nv) and "tau"
            (n, m, nu) the motions of robots, or by "x" and "u" those of Systems.
        """
        found: dict[str, list[Array]] = {}
        for solution in self.solutions:
            times = np.linspace(0.0, solution.duration, samples)
            sample = solution.at(times)
            names = ("q", "v", "tau") if solution.phases[0].phase.robot is not None else ("x", "u")
            for name in names:
                found.setdefault(name, []).append(np.asarray(getattr(sample, name)))
            found.setdefault("t", []).append(times)
        names_of_cases = sorted(self.cases[0]) if self.cases else []
        numbers = {name: np.array([float(case[name]) for case in self.cases]) for name in names_of_cases}
        return numbers | {name: np.array(values) for name, values in found.items()}


def library(
    make: Callable[[Case], Problem | Phase], cases: Sequence[Case], **options: Unpack[GuessedChoices]
) -> Library:
    """Plan the cases one after the other, each from the nearest one that is solved.

    The first case is planned as by ``rt.plan``. Then the unsolved case that is nearest to a solved one follows, with
    all numbers divided by the range that they cover. Plans share one program, as in a chain of ``rt.sweep``.

    Parameters
    ----------
    make : callable
        From the numbers of a case by name to its problem. All problems have the same phases, as gaits at several speeds
        or on several slopes: ``lambda case: rt.gait.trot(robot, speed=case["speed"], duration=0.3)``.
    cases : sequence of mapping of str to float
        For example ``[{"speed": 0.2}, {"speed": 0.3}]``.
    **options
        Of ``rt.plan``, without those of a single plan.

    Raises
    ------
    InputError
        There are no cases, or they have different names or numbers that are not finite.
    """
    check_options("rt.planning.library", options)
    if not len(cases) or not all(isinstance(case, Mapping) and case for case in cases):
        raise InputError(f"cases= must be mappings such as {{'speed': 0.3}}, one or more; got {cases!r}.")
    names = sorted(cases[0])
    rows = np.array([_row(case, names) for case in cases])
    rows = rows / _ranges(rows)
    known: dict[int, Solution] = {}
    failed: dict[int, Solution | Failure] = {}
    while left := [i for i in range(len(cases)) if i not in known and i not in failed]:
        at, near = left[0], None
        if known:
            pairs = [(float(np.sum((rows[i] - rows[j]) ** 2)), i, j) for i in left for j in known]
            _, at, near = min(pairs)
        try:
            posed = make(cases[at])
            problem = posed if isinstance(posed, Problem) else Problem([posed])
            found = (
                planned(options, problem, keep_program=True)
                if near is None
                else continued(options, problem, known[near])
            )
        except Exception as error:
            failed[at] = failure_of(at, error)
            continue
        (known if found.success else failed)[at] = found
    solved = sorted(known)
    return Library(
        make,
        tuple(dict(cases[i]) for i in solved),
        tuple(released(known[i]) for i in solved),
        tuple((dict(cases[i]), failed[i]) for i in sorted(failed)),
    )


def _row(case: Case, names: Sequence[str]) -> Array:
    """Return the numbers of a case in the order of their names."""
    if sorted(case) != list(names):
        raise InputError(
            f"The case {dict(case)!r} has other numbers than {', '.join(names)}, which all cases must have."
        )
    row = np.array([float(case[name]) for name in names])
    if not np.isfinite(row).all():
        raise InputError(f"The case {dict(case)!r} has numbers that are not finite.")
    return row


def _ranges(rows: Array) -> Array:
    """Return the ranges of the numbers of cases (n, d), 1 where they are equal."""
    ranges = np.ptp(rows, axis=0)
    return np.where(ranges > 0.0, ranges, 1.0)
