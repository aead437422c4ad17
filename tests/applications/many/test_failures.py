"""Whatever ends one problem of many, the others are planned, and the one is an entry that says what happened."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest

import robotraj as rt
from robotraj.applications.many import case_limits, workers
from robotraj.applications.many.case_limits import CaseLimits
from robotraj.applications.many.failure import Failure, failure_of
from robotraj.applications.many.processes import Processes, WorkerDied, kept, release_kept
from robotraj.applications.many.workers import run
from robotraj.solvers.status import Status

LIMITS = CaseLimits(seconds=50.0, megabytes=200.0)


def act(shared: None, task: object) -> object:
    """Return a number, or do what a callable does."""
    return task() if callable(task) else task


def refuse() -> None:
    raise LookupError("no such thing")


def end() -> None:
    os._exit(7)


def fill() -> None:
    kept_bytes = [bytearray(100_000_000) for _ in range(20)]
    raise AssertionError(len(kept_bytes))


def crash() -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


FAULTS: dict[str, tuple[Callable[[], None], Status, str]] = {
    "an error": (refuse, Status.ERROR, "LookupError: no such thing"),
    "an exit": (lambda: exit(3), Status.ERROR, "SystemExit"),
    "an end": (end, Status.DIED, "ended with code 7"),
    "a crash": (crash, Status.DIED, "SIGSEGV"),
    "memory": (fill, Status.MEMORY_LIMIT, "no memory was left"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_an_entry_with_its_number_and_the_others_are_there(fault: str) -> None:
    what, status, message = FAULTS[fault]
    found = run(act, None, [0, 1, what, 3, 4, what, 6], None, limits=LIMITS)
    assert [found[i] for i in (0, 1, 3, 4, 6)] == [0, 1, 3, 4, 6]
    for number in (2, 5):
        entry = found[number]
        assert isinstance(entry, Failure) and (entry.number, entry.status) == (number, status)
        assert message in entry.message and not entry.success and status.remedy in str(entry)


@pytest.mark.slow
def test_a_task_that_never_ends_is_ended_by_a_timer() -> None:
    found = run(act, None, [0, lambda: time.sleep(60.0), 2], None, limits=CaseLimits(seconds=0.1))
    assert (found[0], found[2]) == (0, 2)
    assert isinstance(found[1], Failure) and found[1].status is Status.TIME_LIMIT


def test_a_task_that_was_killed_from_outside_begins_again(tmp_path: Path) -> None:
    mark = tmp_path / "killed"

    def once() -> str:
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return "done"

    assert run(act, None, [once, 1], None, limits=LIMITS) == ["done", 1]


def test_a_task_that_is_always_killed_is_an_entry() -> None:
    found = run(act, None, [lambda: os.kill(os.getpid(), signal.SIGKILL), 1], None, limits=LIMITS)
    assert isinstance(found[0], Failure) and "SIGKILL" in found[0].message and found[1] == 1


def test_limits_hold_in_the_processes_of_another_executor() -> None:
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        found = run(act, None, [0, end, 2], pool, limits=LIMITS)
    assert (found[0], found[2]) == (0, 2)
    assert isinstance(found[1], Failure) and found[1].status is Status.DIED


def test_a_broken_pool_keeps_what_was_found() -> None:
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        found = run(act, None, [0, end, 2], pool)
    assert found[0] == 0 and isinstance(found[1], Failure)


def test_processes_serve_the_next_call_and_end_when_they_are_released() -> None:
    run(act, None, [0, 1], None, limits=LIMITS)
    pool = kept()
    assert pool is not None and pool.started
    first = {run(act, None, [os.getpid], None, limits=LIMITS)[0] for _ in range(4)}
    assert kept() is pool and len(first) <= len(os.sched_getaffinity(0))
    release_kept()
    assert kept(start=False) is None and not pool.started


def test_few_short_tasks_stay_in_this_process_and_long_ones_do_not(monkeypatch: pytest.MonkeyPatch) -> None:
    release_kept()
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {0, 1})
    assert set(run(act, None, [os.getpid] * 5, None)) == {os.getpid()}
    monkeypatch.setattr(workers, "FIRST", 0.0)
    monkeypatch.setattr(workers, "START", 0.05)

    def slowly() -> int:
        time.sleep(0.1)
        return os.getpid()

    places = run(act, None, [slowly] * 6, None)
    assert places[0] == os.getpid() and os.getpid() not in places[1:]


def test_limits_are_lifted_after_a_task() -> None:
    def left() -> tuple[float, float]:
        return signal.getitimer(signal.ITIMER_REAL)[0], signal.getitimer(signal.ITIMER_PROF)[0]

    with Processes(1) as own:
        inside = own.submit(lambda: _read_inside(left)).result()
        assert 0.0 < inside[0] <= case_limits.WALL * 2.0 + case_limits.LATE and inside[1] > 0.0
        assert own.submit(left).result() == (0.0, 0.0)


def _read_inside(left: Callable[[], tuple[float, float]]) -> tuple[float, float]:
    with CaseLimits(seconds=2.0, megabytes=500.0).imposed():
        return left()


def test_how_a_process_ended_is_told_by_its_code() -> None:
    assert failure_of(3, WorkerDied(-signal.SIGALRM)).status is Status.TIME_LIMIT
    assert failure_of(3, WorkerDied(-signal.SIGPROF)).status is Status.TIME_LIMIT
    assert failure_of(3, RuntimeError("std::bad_alloc")).status is Status.MEMORY_LIMIT
    assert "could not be started" in failure_of(3, WorkerDied(None)).message


@pytest.mark.slow
def test_a_sweep_with_faulty_equations_has_the_other_results() -> None:
    client = os.getpid()

    def moves(fault: Callable[[], None] | None = None) -> rt.Phase:
        def equations(point: object) -> list[object]:
            if fault is not None and os.getpid() != client:
                fault()
            return [point.x["v"], point.u["u"]]  # type: ignore[attr-defined]

        block = rt.System(["x", "v"], ["u"], equations)
        return rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Effort())

    faults = {7: end, 20: lambda: time.sleep(600.0), 40: fill}
    problems = [moves(faults.get(i)) for i in range(60)]
    found = rt.sweep(problems, mesh=rt.Mesh(4), time_limit=2.0, memory_limit=600.0)
    assert [i for i, entry in enumerate(found) if not entry.success] == [7, 20, 40]
    assert [found[i].status for i in (7, 20, 40)] == [Status.DIED, Status.TIME_LIMIT, Status.MEMORY_LIMIT]
    assert all(found[i].objective == pytest.approx(12.0) for i in range(60) if i not in faults)
