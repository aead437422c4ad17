"""Sweeps: many problems planned in parallel."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from os import PathLike
from typing import TYPE_CHECKING, Any, overload

from robotraj._util.errors import InputError
from robotraj.applications.many.case_limits import CaseLimits
from robotraj.applications.many.failure import Failure, failure_of
from robotraj.applications.many.one_of_many import check_options, continued, planned
from robotraj.applications.many.workers import Interrupted, run
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.released import attached, detached, released
from robotraj.solution.solution import Solution

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from robotraj.applications.many.options import GuessedChoices
    from robotraj.applications.studies.study import Study


@overload
def sweep(
    problems: Sequence[Problem | Phase],
    *,
    executor: Executor | None = None,
    chain: bool = False,
    **options: Unpack[GuessedChoices],
) -> list[Solution | Failure]: ...


@overload
def sweep(
    problems: Callable[[Any], Problem | Phase],
    cases: object,
    *,
    store: str | PathLike[str],
    executor: Executor | None = None,
    chain: bool = False,
    keep: str = "trajectory",
    validate: bool = False,
    part: tuple[int, int] = (0, 1),
    progress: bool | None = None,
    **options: Unpack[GuessedChoices],
) -> Study: ...


def sweep(
    problems: Sequence[Problem | Phase] | Callable[[Any], Problem | Phase],
    cases: object = None,
    *,
    store: str | PathLike[str] | None = None,
    executor: Executor | None = None,
    chain: bool = False,
    keep: str = "trajectory",
    validate: bool = False,
    part: tuple[int, int] = (0, 1),
    progress: bool | None = None,
    **options: Unpack[GuessedChoices],
) -> list[Solution | Failure] | Study:
    """Plan many problems with the same options.

    Parameters
    ----------
    problems : sequence of Problem or Phase, or callable
        Problems are sent to workers by cloudpickle, which must be able to pickle the closures of their lambdas. With a
        store, ``make(case)``, which returns the problem of a case; it is sent once.
    cases : list of dict, ndarray (n, k), or table of pandas, polars or pyarrow
        Rows of numbers and words for ``make``, such as ``[{"speed": 0.3}, {"speed": 0.4}]``. Equal ones are planned
        once. Columns of an array are ``x0``, ``x1`` ...
    store : path, optional
        Folder of the study. Every case is planned once: the same call goes on where it stopped. Cases are known by
        their numbers, the code of ``make`` and what it reads, the options and the version of the package.
    executor : concurrent.futures.Executor, optional
        Processes, threads or ``dask.distributed.Client.get_executor()``. By default the first problem is planned in
        this process; if the others are worth it, they go to one process per core. These do not import the script, and
        serve later calls. ``ThreadPoolExecutor(1)`` plans in this process, one problem after the other.
    chain : bool
        Plan in this process, each problem from the solution of the last one that was solved, on its last mesh if that
        was proved. Neighbouring problems, such as gaits of rising speed, take fewer iterations then. All may stay near
        the local optimum of the first. Problems that differ only in numbers share one program: ends, fixed parameters,
        displacements of links. Their objectives are compared on no second mesh: ``proof.unsettled`` is the neighbour's.
        With a store, each process starts a plan from the nearest case that it has solved: for cases near each other.
    keep : str
        With a store, ``"trajectory"`` keeps q, v and tau at 64 times, ``"all"`` whole solutions beside the rows.
    validate : bool
        With a store, validate every plan by simulation.
    part : (int, int)
        With a store, ``(3, 200)`` plans part 3 of 200, from 0, then what other parts have left: the jobs of an array
        need no scheduler of their own.
    progress : bool, optional
        With a store, show what is done on one line; by default on a terminal.
    **options
        Of ``rt.plan``: mesh, guess, solver, tolerance, continuation ... With ``time_limit`` or ``memory_limit`` the
        operating system also ends a problem whose own equations never return or fill the memory.

    Returns
    -------
    list of Solution or Failure, or Study
        With a store, the study; see ``rt.Study``. Otherwise a list in the order of the problems. A plan that found no
        motion is a solution with its status. A problem that raised an error, or ended its process, is a ``Failure``
        with its ``number``, ``status`` and ``message``.

    Raises
    ------
    InputError
        An entry is no problem, ``rt.plan`` has no such option, or a chain has an executor. ``make`` has no cases or no
        store, or pyarrow is not installed: ``pip install 'robotraj[study]'``.
    Interrupted
        Ctrl-C was pressed; ``found`` has the entries so far, by the numbers of their problems.

    Examples
    --------
    >>> import robotraj as rt
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    >>> moves = [
    ...     rt.Phase(
    ...         block, duration=T, start=rt.State([0, 0]), end=rt.State([1, 0]), objective=rt.Effort()
    ...     )
    ...     for T in (1.0, 2.0)
    ... ]
    >>> with ThreadPoolExecutor(1) as here:
    ...     [round(solution.objective, 3) for solution in rt.sweep(moves, executor=here, mesh=rt.Mesh(10))]
    [12.0, 1.5]
    """
    check_options("rt.sweep", options, sweep)
    if callable(problems) or store is not None or cases is not None:
        if not callable(problems) or store is None or cases is None:
            raise InputError(
                "A study takes a function, its cases and a folder: rt.sweep(make, cases, store='reaches')."
            )
        from robotraj.applications.studies.begin import StudyPart, study

        return study(
            problems,
            cases,
            store,
            executor=executor,
            chain=chain,
            keep=keep,
            validate=validate,
            part=StudyPart(*part),
            progress=progress,
            options=options,
        )
    if progress is not None:
        raise InputError("rt.sweep shows no progress without a store: leave progress= out.")
    if isinstance(problems, Problem | Phase) or not isinstance(problems, Iterable):
        raise InputError(f"rt.sweep takes a list of problems or phases; got {type(problems).__name__}.")
    posed = [Problem([problem]) if isinstance(problem, Phase) else problem for problem in problems]
    for i, problem in enumerate(posed):
        if not isinstance(problem, Problem):
            raise InputError(f"rt.sweep takes problems or phases; number {i} is a {type(problem).__name__}.")
    if chain:
        if executor is not None:
            raise InputError("rt.sweep(chain=True) plans one problem after the other: leave executor= out.")
        return _chained(posed, options)
    limits = CaseLimits(options.get("time_limit"), options.get("memory_limit"))
    try:
        found = run(planned, options, posed, executor, limits=limits, sent=_detached)
    except Interrupted as stopped:
        whole = {i: _whole(entry, posed[i]) for i, entry in stopped.found.items()}
        raise Interrupted(whole, len(posed), stopped.running) from stopped
    return [_whole(entry, problem) for entry, problem in zip(found, posed, strict=True)]


def _whole(entry: Solution | Failure, problem: Problem) -> Solution | Failure:
    return entry if isinstance(entry, Failure) else attached(entry, problem)


def _chained(problems: Sequence[Problem], options: GuessedChoices) -> list[Solution | Failure]:
    """Plan each problem from the solution of the last one that was solved."""
    found: list[Solution | Failure] = []
    last: Solution | None = None
    for number, problem in enumerate(problems):
        try:
            solution = (
                planned(options, problem, keep_program=True) if last is None else continued(options, problem, last)
            )
        except KeyboardInterrupt as stopped:
            raise Interrupted(dict(enumerate(found)), len(problems), [number]) from stopped
        except Exception as error:
            found.append(failure_of(number, error))
            continue
        found.append(released(solution))
        if solution.success:
            last = solution
    return found


def _detached(_: GuessedChoices, problem: Problem, found: Solution) -> Solution:
    return detached(found, problem)
