"""Work in any ``concurrent.futures`` executor, with results in the order of the tasks.

Data shared by all tasks is sent with each task and unpacked once per worker, so that all tasks use the same graphs.
Processes exchange data by cloudpickle. Equations of Systems and expressions of constraints are mostly lambdas, which
the standard library cannot pickle. Threads share memory and send nothing. Values that are computed at first use, such
as costates, are then computed later; between processes they are computed before they are sent.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar, cast

import cloudpickle

from robotraj._util.errors import InputError, RobotrajError
from robotraj.planning.many.processes import Processes

if TYPE_CHECKING:
    from robotraj.solution.solution import Solution

S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")


class Interrupted(KeyboardInterrupt):
    """Ctrl-C stopped work on many problems; ``found`` holds the solutions so far.

    Attributes
    ----------
    found : dict of int to robotraj.Solution
        Solutions by the number of their problem.
    """

    def __init__(self, found: Mapping[int, Solution], count: int) -> None:
        super().__init__(f"Interrupted with {len(found)} of {count} done; they are in this error's `found`.")
        self.found = found
        self.count = count

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.found, self.count)


def run(
    work: Callable[[S, T], R],
    shared: S,
    tasks: Sequence[T],
    executor: Executor | None,
    enough: Callable[[Sequence[R]], bool] | None = None,
) -> list[R]:
    """Return ``[work(shared, task) for task in tasks]``, computed by an executor.

    Parameters
    ----------
    work : callable
        ``work(shared, task)``, a function defined in a module.
    shared, tasks : picklable by cloudpickle
    executor : concurrent.futures.Executor, optional
        Threads, processes or Dask's ``client.get_executor()``. By default one new process per core, which
        inherits nothing from this process.
    enough : callable, optional
        ``enough(results)`` returns whether the first results suffice. Only these are returned then, and tasks that have
        not begun are not computed. The result does not depend on the executor.

    Raises
    ------
    InputError
        A part of a task cannot be pickled, ``executor`` is not an executor, or a task was refused.
    RobotrajError
        A worker process died.
    Interrupted
        Ctrl-C was pressed; ``found`` has the results so far. Tasks that have not begun are not computed.
    """
    if executor is None:
        if not tasks:
            return []
        workers = min(len(tasks), os.cpu_count() or 1)
        own = Processes(workers)
        waiting = True
        try:
            return run(work, shared, tasks, own, enough)
        except KeyboardInterrupt:
            # Results of running tasks are not needed.
            waiting = False
            raise
        finally:
            own.shutdown(wait=waiting, cancel_futures=True)
    if not hasattr(executor, "submit"):
        raise InputError(f"executor= must be a concurrent.futures executor; got {type(executor).__name__}.")
    if isinstance(executor, ThreadPoolExecutor):
        return _first(lambda task: executor.submit(work, shared, task), tasks, lambda result: result, enough)
    try:
        common = cloudpickle.dumps((work, shared))
        packed = [cloudpickle.dumps(task) for task in tasks]
    except (TypeError, AttributeError, RuntimeError, NotImplementedError) as error:
        raise InputError(
            f"A problem cannot be sent to workers, because a part of it cannot be pickled: {error}"
        ) from error
    try:
        return _first(lambda task: executor.submit(_call, common, task), packed, cloudpickle.loads, enough)
    except BrokenProcessPool as error:
        raise RobotrajError(
            f"{error} It ran out of memory or was ended from outside: give an executor= of fewer workers. Workers of "
            "a ProcessPoolExecutor import the script: put its call under `if __name__ == '__main__':`."
        ) from error


def _first(
    submit: Callable[[T], Future[S]],
    tasks: Sequence[T],
    unpacked: Callable[[S], R],
    enough: Callable[[Sequence[R]], bool] | None,
) -> list[R]:
    """Submit the tasks, and wait for results in their order until there are enough."""
    futures: list[Future[S]] = []
    results: list[R] = []
    try:
        # Processes start while tasks are submitted, which takes seconds. Ctrl-C is handled during that time as well.
        for task in tasks:
            futures.append(submit(task))
        for future in futures:
            results.append(unpacked(future.result()))
            if enough is not None and enough(results):
                break
    except KeyboardInterrupt as pressed:
        done = {i: f for i, f in enumerate(futures) if f.done() and not f.cancelled() and f.exception() is None}
        found = {i: unpacked(future.result()) for i, future in done.items()}
        raise Interrupted(cast("dict[int, Solution]", found), len(tasks)) from pressed
    finally:
        for future in futures[len(results) :]:
            future.cancel()
    return results


def _call(common: bytes, task: bytes) -> bytes:
    work, shared = _unpacked(common)
    return cloudpickle.dumps(work(shared, cloudpickle.loads(task)))


@lru_cache(maxsize=4)
def _unpacked(common: bytes) -> tuple[Callable[[object, object], object], object]:
    work, shared = cloudpickle.loads(common)
    return work, shared
