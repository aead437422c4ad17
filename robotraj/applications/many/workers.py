"""Work in any ``concurrent.futures`` executor, with results in the order of the tasks.

Data shared by all tasks is sent with each task and unpacked once per worker, so that all tasks use the same graphs.
Processes exchange data by cloudpickle. Equations of Systems and expressions of constraints are mostly lambdas, which
the standard library cannot pickle. Threads share memory and send nothing.

A task that fails in any way is a ``Failure`` among the results: an error, a process that ended, a limit.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Generic, TypeVar, cast

import cloudpickle

from robotraj._util.errors import InputError
from robotraj.applications.many.case_limits import CaseLimits
from robotraj.applications.many.failure import Failure, failure_of
from robotraj.applications.many.processes import WorkerDied, kept, release_kept
from robotraj.applications.many.task_messages import TaskPacker, unpack
from robotraj.robot.robot import Robot
from robotraj.solution.solution import Solution

S = TypeVar("S")
T = TypeVar("T")
R = TypeVar("R")

NO_LIMITS = CaseLimits()
START = 2.5
"""Time until fresh processes have begun their first tasks, which a few tasks in this process need not wait for [s]."""
FIRST = 1.5
"""Time of a first task that later ones in the same process do not need: imports, and functions of the robot [s]."""
KILLED = 2
"""Number of times that a task begins again whose process was killed from outside."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C stopped work on many problems; ``found`` holds the solutions so far.

    Attributes
    ----------
    found : dict of int to robotraj.Solution
        Solutions and failures by the number of their problem.
    running, left : tuple of int
        Numbers of the problems that were being planned, and of those that had not begun.
    result : robotraj.applications.Multistart or None
        What ``rt.multistart`` makes of the solutions so far.
    """

    def __init__(
        self,
        found: Mapping[int, Solution | Failure],
        count: int,
        running: Sequence[int] = (),
        result: object = None,
    ) -> None:
        super().__init__(f"Interrupted with {len(found)} of {count} done; they are in this error's `found`.")
        self.found = found
        self.count = count
        self.running = tuple(running)
        self.result = result
        self.left = tuple(i for i in range(count) if i not in found and i not in self.running)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.found, self.count, self.running, self.result)


def _whole(shared: object, task: object, result: object) -> object:
    return result


@dataclass(frozen=True)
class _Sent(Generic[S, T, R]):
    """Work whose results are made ready to be sent."""

    work: Callable[[S, T], R]
    sent: Callable[[S, T, R], object]

    def __call__(self, shared: S, task: T) -> object:
        return self.sent(shared, task, self.work(shared, task))


def run(
    work: Callable[[S, T], R],
    shared: S,
    tasks: Sequence[T],
    executor: Executor | None,
    enough: Callable[[Sequence[R | Failure]], bool] | None = None,
    limits: CaseLimits = NO_LIMITS,
    sent: Callable[[S, T, R], object] = _whole,
) -> list[R | Failure]:
    """Return ``[work(shared, task) for task in tasks]``, computed by an executor.

    Parameters
    ----------
    work : callable
        ``work(shared, task)``, a function defined in a module.
    shared, tasks : picklable by cloudpickle
    executor : concurrent.futures.Executor, optional
        Threads, processes or Dask's ``client.get_executor()``. By default the first tasks run in this process, as long
        as this is faster, then one process per core, which inherits nothing from this process. Processes serve later
        calls, too. With limits all tasks run in processes.
    enough : callable, optional
        ``enough(results)`` returns whether the first results suffice. Only these are returned then, and tasks that have
        not begun are not computed. The result does not depend on the executor.
    limits : CaseLimits
        Limits on each task. The operating system enforces them in processes of this machine; with another executor the
        process of the executor starts one of its own.
    sent : callable
        ``sent(shared, task, result)``, a function defined in a module, returns what a process sends in place of a
        result, such as a smaller one. It is not called in this process: Ctrl-C during such a call would lose a result.

    Returns
    -------
    list
        A ``Failure`` in place of each result of a task that raised an error or ended its process.

    Raises
    ------
    InputError
        The shared data cannot be pickled, or ``executor`` is not an executor.
    Interrupted
        Ctrl-C was pressed; ``found`` has the results so far. Tasks that have not begun are not computed.
    """
    if executor is not None and not hasattr(executor, "submit"):
        raise InputError(f"executor= must be a concurrent.futures executor; got {type(executor).__name__}.")
    if isinstance(executor, ThreadPoolExecutor):
        return _first(lambda i: executor.submit(_here, work, shared, i, tasks[i]), len(tasks), enough, [], _same)
    results = _first_here(work, shared, tasks, enough) if executor is None and not limits else []
    if len(results) == len(tasks) or (results and enough is not None and enough(results)):
        return results
    packer, first = TaskPacker(), len(results)
    packed = [_packed(packer, task) for task in tasks[first:]]
    common = sendable((_Sent(work, sent), shared, packer.robots), "The options")
    own = kept() if executor is None else None
    pool = cast("Executor", own or executor)

    def submit(i: int) -> Future[bytes]:
        call = _call if own is not None or not limits else _guarded
        refused: Future[bytes] = Future()
        task = packed[i - first]
        if isinstance(task, bytes):
            try:
                return pool.submit(call, common, i, task, limits)
            except RuntimeError as error:
                # A pool that broke refuses further tasks.
                task = error
        refused.set_exception(task)
        return refused

    try:
        return _first(submit, len(tasks), enough, results, cloudpickle.loads)
    except KeyboardInterrupt:
        if own is not None:
            release_kept()
        raise


def sendable(value: object, what: str) -> bytes:
    """Return the pickle of a value; ``what`` names it in messages.

    Raises
    ------
    InputError
        A part cannot be pickled.
    """
    try:
        return cast("bytes", cloudpickle.dumps(value))
    except (TypeError, AttributeError, RuntimeError, NotImplementedError) as error:
        raise InputError(f"{what} cannot be sent to workers, because a part cannot be pickled: {error}") from error


def _packed(packer: TaskPacker, task: object) -> bytes | Exception:
    """Return a task for a worker, or the error where a part of it cannot be pickled."""
    try:
        return packer.pack(task)
    except Exception as error:
        return error


def _first_here(
    work: Callable[[S, T], R],
    shared: S,
    tasks: Sequence[T],
    enough: Callable[[Sequence[R | Failure]], bool] | None,
) -> list[R | Failure]:
    """Compute the first tasks in this process, until the others are worth the start of processes."""
    results: list[R | Failure] = []
    running = kept(start=False)
    workers = len(os.sched_getaffinity(0))
    for number, task in enumerate(tasks):
        began = time.perf_counter()
        try:
            results.append(_here(work, shared, number, task))
        except KeyboardInterrupt as pressed:
            found = cast("dict[int, Solution | Failure]", dict(enumerate(results)))
            raise Interrupted(found, len(tasks), [number] if number not in found else ()) from pressed
        if enough is not None and enough(results):
            break
        took = time.perf_counter() - began - (FIRST if number == 0 else 0.0)
        waits = 0.0 if running is not None and running.started else START
        if (len(tasks) - number - 1) * max(took, 0.0) * (1.0 - 1.0 / workers) > waits and workers > 1:
            break
    return results


def _first(
    submit: Callable[[int], Future[S]],
    count: int,
    enough: Callable[[Sequence[R | Failure]], bool] | None,
    results: list[R | Failure],
    unpacked: Callable[[S], R | Failure],
) -> list[R | Failure]:
    """Submit the tasks after the first results, and wait for theirs in order until there are enough."""
    futures: dict[int, Future[S]] = {}
    given = len(results)
    try:
        # Processes start while tasks are submitted, which takes seconds. Ctrl-C is handled during that time as well.
        for i in range(given, count):
            futures[i] = submit(i)
        for i in range(given, count):
            results.append(_outcome(i, futures, partial(submit, i), unpacked))
            if enough is not None and enough(results):
                break
    except KeyboardInterrupt as pressed:
        done = {i: f for i, f in futures.items() if f.done() and not f.cancelled() and f.exception() is None}
        found = dict(enumerate(results)) | {i: unpacked(f.result()) for i, f in done.items()}
        running = [i for i, future in futures.items() if future.running()]
        raise Interrupted(cast("dict[int, Solution | Failure]", found), count, running) from pressed
    finally:
        for i, future in futures.items():
            if i >= len(results):
                future.cancel()
    return results


def _same(result: R | Failure) -> R | Failure:
    return result


def _outcome(
    number: int, futures: dict[int, Future[S]], again: Callable[[], Future[S]], unpacked: Callable[[S], R | Failure]
) -> R | Failure:
    """Return the result of a task, or its failure; a task that was killed from outside begins again."""
    for attempt in range(KILLED + 1):
        try:
            return unpacked(futures[number].result())
        except WorkerDied as died:
            if died.code != -signal.SIGKILL or attempt == KILLED:
                return failure_of(number, died)
            futures[number] = again()
        except (Exception, SystemExit, CancelledError) as error:
            return failure_of(number, error)
    raise AssertionError


def _here(work: Callable[[S, T], R], shared: S, number: int, task: T) -> R | Failure:
    try:
        return work(shared, task)
    except (Exception, SystemExit) as error:
        return failure_of(number, error)


def _call(common: bytes, number: int, task: bytes, limits: CaseLimits) -> bytes:
    """Compute a task of another process, under limits of the operating system where there are any."""
    work, shared, robots = _unpacked(common)
    try:
        if not limits:
            return cloudpickle.dumps(_here(work, shared, number, unpack(task, robots)))
        with limits.imposed():
            return cloudpickle.dumps(_here(work, shared, number, unpack(task, robots)))
    except (Exception, SystemExit) as error:
        return cloudpickle.dumps(failure_of(number, error))


def _guarded(common: bytes, number: int, task: bytes, limits: CaseLimits) -> bytes:
    """Compute a task in a process of the executor's process, which may end without harm."""
    own = kept()
    assert own is not None
    try:
        return own.submit(_call, common, number, task, limits).result()
    except WorkerDied as died:
        return cloudpickle.dumps(failure_of(number, died))


@lru_cache(maxsize=4)
def _unpacked(common: bytes) -> tuple[Callable[[object, object], object], object, list[Robot]]:
    work, shared, robots = cloudpickle.loads(common)
    return work, shared, robots
