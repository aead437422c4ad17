"""Multistart: seeded initial guesses and the distinct local optima of their solutions."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine, wrapped
from robotraj._util.values import dataclass
from robotraj.applications.many.case_limits import CaseLimits
from robotraj.applications.many.failure import Failure
from robotraj.applications.many.local_optima import equal_objectives, same_optimum
from robotraj.applications.many.one_of_many import check_options
from robotraj.applications.many.workers import Interrupted, run
from robotraj.fixed_mesh.starts import Shared, Start
from robotraj.guess.default import as_guess, default_guess, other_guess
from robotraj.planning.plan import plan
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.released import attached, detached
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.applications.many.options import Choices


@dataclass(frozen=True, eq=False)
class Optimum(OneLine):
    """A local optimum and the starts that reached it.

    Attributes
    ----------
    solution : Solution
        The solution with the lowest objective.
    starts : tuple of int
        Numbers of the starts; 0 is the guess without perturbation.
    """

    solution: Solution
    starts: tuple[int, ...]

    @property
    def objective(self) -> float:
        """Objective of the best solution."""
        return self.solution.objective


@dataclass(frozen=True, eq=False)
class Multistart(OneLine):
    """The result of a multistart.

    Attributes
    ----------
    optima : tuple of Optimum
        Distinct local optima, the lowest objective first.
    failures : mapping of Status to int
        Number of starts that ended without a solution, by status.
    starts : int
        Number of starts that were run.
    iterations : int
        Iterations of all starts.
    left : int
        Number of starts that were not run because of Ctrl-C.
    objective_tolerance, trajectory_tolerance : float
        Tolerances within which two solutions count as one.
    """

    optima: tuple[Optimum, ...]
    failures: Mapping[Status, int]
    starts: int
    iterations: int
    objective_tolerance: float
    trajectory_tolerance: float
    left: int = 0

    @property
    def best(self) -> Solution:
        """The lowest optimum found.

        Raises
        ------
        InputError
            No start reached a solution.
        """
        if not self.optima:
            raise InputError(f"None of the {self.starts} starts reached a solution.\n{self}")
        return self.optima[0].solution

    def __str__(self) -> str:
        failed = sum(self.failures.values())
        count = len(self.optima)
        plural = "um" if count == 1 else "a"
        lines = [
            f"{self.starts} starts, {self.iterations} iterations: "
            f"{count} distinct local optim{plural}, {failed} failed"
            + (f"; interrupted with {self.left} starts to go" if self.left else ""),
            "        objective  duration [s]  starts  iterations  first start",
        ]
        lines += [
            f"{i:>3}  {o.objective:>12.8g}  {o.solution.duration:>12.6g}  {len(o.starts):>6}  "
            f"{o.solution.iterations:>10}  {o.starts[0]:>11}"
            for i, o in enumerate(self.optima, 1)
        ]
        lines += [f"failed, {status.value}: {number}" for status, number in self.failures.items()]
        lines += wrapped(
            f"one optimum: objectives within {self.objective_tolerance:g} (relative) and states within "
            f"{self.trajectory_tolerance:g} of their range"
        )
        return "\n".join(lines)


def multistart(
    problem: Problem | Phase,
    starts: int = 20,
    seed: int = 0,
    *,
    spread: float = 0.2,
    patience: int | None = None,
    guess: InitialGuess | Solution | Sequence[InitialGuess] | None = None,
    executor: Executor | None = None,
    objective_tolerance: float = 1e-5,
    trajectory_tolerance: float = 1e-2,
    **options: Unpack[Choices],
) -> Multistart:
    """Plan from a guess and from seeded random variations of it; return the distinct local optima.

    All starts of a process share one transcription, scaled at the guess, and the program of the solver. A later start
    takes little more than its iterations. No number of starts proves that the lowest optimum found is global.

    Parameters
    ----------
    problem : Problem or Phase
    starts : int
        Number of starts. The first is the guess, the others are ``rt.guess.Perturbed`` variations of it.
    seed : int
        The same seed gives the same starts and the same result, with any executor.
    spread : float
        Size of the perturbations, relative to the ranges of the variables; see ``rt.guess.Perturbed``.
    patience : int, optional
        Stop when this many starts in a row found no lower optimum; by default all starts are run.
    guess : InitialGuess, Solution or sequence of InitialGuess, optional
        A straight line by default. Where an end is given by a pose, every start takes another branch of inverse
        kinematics. Among obstacles every start takes another path.
    executor : concurrent.futures.Executor, optional
        As for ``rt.sweep``: one new process per core by default. A process takes about a second to begin.
        ``ThreadPoolExecutor(1)`` is faster where a start takes less.
    objective_tolerance : float
        Two solutions are one optimum if their trajectories agree and their objectives differ by less than this times
        1 + |objective|.
    trajectory_tolerance : float
        Trajectories agree if no state differs by more than this times its range at equal fractions of each phase. No
        duration may differ by more than this relative to the longer one.
    **options
        Of ``rt.plan``: mesh, solver, tolerance, continuation ... With ``rt.InteriorPoint(fallback=None)`` failed starts
        are not repeated by IPOPT, which takes longer for them than for all others.

    Returns
    -------
    Multistart
        It prints as a table of optima and failures.

    Raises
    ------
    InputError
        ``starts`` or ``patience`` is below 1. A spread, seed or tolerance is negative or no number. The problem cannot
        be posed, or ``rt.plan`` does not have an option.
    Interrupted
        Ctrl-C was pressed; ``result`` is the Multistart of the starts so far, and its ``left`` counts the others.
    """
    problem = Problem([problem]) if isinstance(problem, Phase) else problem
    if not isinstance(problem, Problem):
        raise InputError(f"rt.multistart takes an rt.Problem or an rt.Phase; got {type(problem).__name__}.")
    if not _is_count(starts, 1) or not _is_size(spread):
        raise InputError(
            f"rt.multistart needs at least 1 start and a spread of 0 or more; got {starts!r} and {spread!r}."
        )
    if patience is not None and not _is_count(patience, 1):
        raise InputError(f"rt.multistart needs a patience of at least 1 start, or None; got {patience!r}.")
    if not _is_count(seed, 0):
        raise InputError(f"rt.multistart takes a whole number of 0 or more as seed; got {seed!r}.")
    for name, value in (("objective_tolerance", objective_tolerance), ("trajectory_tolerance", trajectory_tolerance)):
        if not _is_size(value):
            raise InputError(f"rt.multistart needs {name}= of 0 or more; got {value!r}.")
    check_options("rt.multistart", options, multistart)
    given = as_guess(guess)
    first = given or default_guess(problem)
    varied = (other_guess(problem, i, (seed, i), spread, given) for i in range(1, starts))
    guesses = [first, *varied]
    try:
        limits = CaseLimits(options.get("time_limit"), options.get("memory_limit"))
        search, enough = _Search(problem, first, options), _patience_reached(patience, objective_tolerance)
        entries = run(_plan, search, guesses, executor, enough, limits, _detached)
    except Interrupted as stopped:
        found = dict(stopped.found)
        result = _result(problem, found, starts - len(found), objective_tolerance, trajectory_tolerance)
        raise Interrupted(found, starts, stopped.running, result) from stopped
    found = dict(enumerate(entries))
    _require_posed(found)
    return _result(problem, found, 0, objective_tolerance, trajectory_tolerance)


def _result(
    problem: Problem,
    found: Mapping[int, Solution | Failure],
    left: int,
    objective_tolerance: float,
    trajectory_tolerance: float,
) -> Multistart:
    """Group the solutions of the starts into local optima."""
    solutions = {i: s for i, s in found.items() if isinstance(s, Solution)}
    solved = sorted((s.objective, i) for i, s in solutions.items() if s.success)
    groups: list[list[int]] = []
    for _, i in solved:
        for group in groups:
            if same_optimum(solutions[group[0]], solutions[i], objective_tolerance, trajectory_tolerance, problem):
                group.append(i)
                break
        else:
            groups.append([i])
    failures = Counter(s.status for s in found.values() if not s.success)
    return Multistart(
        tuple(Optimum(attached(solutions[group[0]], problem), tuple(sorted(group))) for group in groups),
        dict(sorted(failures.items(), key=lambda entry: entry[0].value)),
        len(found),
        sum(s.iterations for s in found.values()),
        objective_tolerance,
        trajectory_tolerance,
        left,
    )


@dataclass(frozen=True, eq=False)
class _Search:
    """Data that all starts share."""

    problem: Problem
    first: InitialGuess
    options: Choices


class _OfThread(threading.local):
    """Data that the starts of a thread share: a compiled program is used by one thread at a time."""

    def __init__(self) -> None:
        self.shared: WeakKeyDictionary[_Search, Shared] = WeakKeyDictionary()


_of_thread = _OfThread()


def _plan(search: _Search, guess: InitialGuess) -> Solution:
    shared = _of_thread.shared.setdefault(search, Shared(search.first))
    start = Start(guess, shared)
    found = plan(search.problem, guess=start, check=False, progress=False, **search.options)
    if found.status is Status.INTERRUPTED:
        raise KeyboardInterrupt
    return found


def _detached(search: _Search, _: InitialGuess, found: Solution) -> Solution:
    return detached(found, search.problem)


def _require_posed(found: Mapping[int, Solution | Failure]) -> None:
    """Raise the error of all starts: they share the problem and the options.

    Raises
    ------
    InputError
        Every start raised an error.
    """
    errors = [entry for entry in found.values() if isinstance(entry, Failure) and entry.status is Status.ERROR]
    if errors and len(errors) == len(found):
        raise InputError(f"rt.multistart: every start failed. {errors[0].message}")


def _is_count(value: object, least: int) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool) and bool(value >= least)


def _is_size(value: object) -> bool:
    return is_finite(value) and value >= 0


def _patience_reached(patience: int | None, tolerance: float) -> Callable[[Sequence[Solution | Failure]], bool] | None:
    """Return a test whether the last ``patience`` starts found no lower optimum; None without a limit."""
    if patience is None:
        return None

    def stop(found: Sequence[Solution | Failure]) -> bool:
        costs = [s.objective if s.success else np.inf for s in found]
        lowest = min(costs)
        first = next((i for i, cost in enumerate(costs) if equal_objectives(cost, lowest, tolerance)), len(costs))
        return len(costs) - 1 - first >= patience

    return stop
