"""Libraries of motions: problems of a few numbers, planned from neighbour to neighbour, queried and blended."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from scipy.optimize import linprog

from robotraj._util.arrays import Array
from robotraj._util.checks import is_number
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine, brief
from robotraj._util.values import dataclass
from robotraj.applications.many.failure import Failure, failure_of
from robotraj.applications.many.libraries.neighbours import Neighbours, row_of, without_program
from robotraj.applications.many.one_of_many import check_options
from robotraj.applications.many.posed import posed
from robotraj.applications.replanning.replanner import Replanner
from robotraj.guess.earlier.blend import Blend
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.solution.errors import NoSolutionFound
from robotraj.solution.released import released
from robotraj.solution.solution import Solution
from robotraj.transcription.reuse import same_but_numbers
from robotraj.transcription.schemes.mesh import Mesh

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.applications.many.options import Choices, GuessedChoices
    from robotraj.applications.replanning.replan import Replan

Case = Mapping[str, float]

ANSWERED = 16
"""Intervals of an answer without a proof."""
USED = 1e-9
"""Least weight of a solution that a blend uses."""


@dataclass(frozen=True, eq=False)
class Library(OneLine):
    """Solutions of one kind of problem for several values of its numbers, returned by ``rt.applications.library``.

    Attributes
    ----------
    make : callable
        From the numbers of a case by name to its problem.
    cases : tuple of mapping of str to float
        Cases that were solved.
    solutions : sequence of Solution
        Their solutions.
    failures : tuple of (mapping of str to float, Solution or Failure)
        Cases that were not solved, with what came of them.
    """

    make: Callable[[Any], Problem | Phase]
    cases: tuple[Case, ...]
    solutions: Sequence[Solution]
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
        asked = row_of(case, names)
        rows = np.array([row_of(each, names) for each in self.cases])
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

    def nearest(self, case: Case) -> Solution:
        """Return the solution of the nearest case.

        Raises
        ------
        InputError
            The case has other numbers than those of the library, or nothing was solved.
        """
        found = self._neighbours.nearest(case)
        if found is None:
            raise InputError("The library has no solutions: every case failed, as library.failures states.")
        return found

    def plan(self, case: Case, **options: Unpack[Choices]) -> Solution:
        """Plan a case from the nearest solution: its mesh, program and multipliers; further options are of ``rt.plan``.

        The plan is proved as every other. Only its objective is compared on no second mesh: ``proof.unsettled`` is the
        neighbour's. The first plan on a mesh builds its program, which later ones use.

        Raises
        ------
        NoSolutionFound
            No motion was found.
        """
        check_options("library.plan", options, self.plan)
        self.nearest(case)
        chosen = cast("GuessedChoices", options)
        found = self._neighbours.plan(chosen, posed(self.make, case), case)
        if not found.success:
            raise NoSolutionFound(f"the case {dict(case)!r} was not solved: {found.cause}\n{found}", found)
        return released(found)

    def answer(self, case: Case) -> Replan:
        """Return a motion of a case within milliseconds, without a proof: a step of ``rt.Replanner``.

        The first answer builds the program of the step, on ``ANSWERED`` intervals. Its limits hold at their points.

        Raises
        ------
        InputError
            The problems are of several phases, or their starts are not fixed, as of every ``rt.Replanner``.
        """
        near, problem = self.nearest(case), posed(self.make, case)
        phase, steps = problem.phases[0], self.__dict__.get("_steps")
        if steps is None or len(problem.phases) != 1 or not same_but_numbers(phase, steps.phase):
            steps = self.__dict__["_steps"] = Replanner(problem, Mesh(ANSWERED), guess=near)
        numbers = {name: float(value) for name, value in phase.parameters.items() if is_number(value)}
        return steps.step(0.0, phase.start or State(), phase.end, numbers, guess=near)

    @cached_property
    def _neighbours(self) -> Neighbours:
        names = sorted(self.cases[0]) if self.cases else []
        rows = np.array([row_of(each, names) for each in self.cases]).reshape(len(self.cases), len(names))
        ranges = _ranges(rows) if len(rows) else np.ones(0)
        found = Neighbours(dict(zip(names, ranges.tolist(), strict=True)))
        for number, case in enumerate(self.cases):
            found.add(case, partial(self.solutions.__getitem__, number))
        return found

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
    make: Callable[[Any], Problem | Phase], cases: Sequence[Case], **options: Unpack[GuessedChoices]
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
    check_options("rt.applications.library", options, library)
    if not callable(make):
        raise InputError(
            f"rt.applications.library takes a function, make(case) -> problem, and cases; got {brief(make)}."
        )
    if not len(cases) or not all(isinstance(case, Mapping) and case for case in cases):
        raise InputError(f"cases= must be mappings such as {{'speed': 0.3}}, one or more; got {cases!r}.")
    names = sorted(cases[0])
    rows = np.array([row_of(case, names) for case in cases])
    ranges = _ranges(rows)
    neighbours = Neighbours(dict(zip(names, ranges.tolist(), strict=True)))
    rows = rows / ranges
    known: dict[int, Solution] = {}
    failed: dict[int, Solution | Failure] = {}
    # Squared distance of each case to the nearest one that is solved; NaN where it was planned.
    away = np.full(len(cases), np.inf)
    for _ in cases:
        at = int(np.nanargmin(away))
        away[at] = np.nan
        try:
            found = neighbours.plan(options, posed(make, cases[at]), cases[at])
        except Exception as error:
            failed[at] = failure_of(at, error)
            continue
        if not found.success:
            failed[at] = found
            continue
        known[at] = without_program(found)
        neighbours.add(cases[at], found)
        away = np.minimum(away, np.sum((rows - rows[at]) ** 2, axis=1))
    solved = sorted(known)
    made = Library(
        make,
        tuple(dict(cases[i]) for i in solved),
        tuple(known[i] for i in solved),
        tuple((dict(cases[i]), failed[i]) for i in sorted(failed)),
    )
    # Later plans use the program of the first one as well.
    made.__dict__["_neighbours"] = neighbours
    return made


def _ranges(rows: Array) -> Array:
    """Return the ranges of the numbers of cases (n, d), 1 where they are equal."""
    ranges = np.ptp(rows, axis=0)
    return np.where(ranges > 0.0, ranges, 1.0)
