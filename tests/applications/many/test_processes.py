"""Processes answer as threads do; one that dies fails its own task; all end with the process that started them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import pytest

from robotraj.applications.many.processes import Processes, WorkerDied


@pytest.fixture(scope="module")
def processes() -> Iterator[Processes]:
    executor = Processes(2)
    yield executor
    executor.shutdown()


def running(pid: int) -> bool:
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def ends(pid: int) -> bool:
    for _ in range(100):
        if not running(pid):
            return True
        time.sleep(0.1)
    return False


def test_answers_and_errors_come_back(processes: Processes) -> None:
    def refuse() -> None:
        raise LookupError("no such thing")

    assert [future.result() for future in [processes.submit(lambda i=i: i**2) for i in range(5)]] == [0, 1, 4, 9, 16]
    with pytest.raises(LookupError, match="no such thing") as caught:
        processes.submit(refuse).result()
    assert "in refuse" in str(caught.value.__cause__)
    with pytest.raises(SystemExit):
        processes.submit(sys.exit, 3).result()


def test_an_error_that_cannot_be_sent_is_described(processes: Processes) -> None:
    def refuse() -> None:
        error = ValueError("with a lock")
        error.held = threading.Lock()  # type: ignore[attr-defined]
        raise error

    with pytest.raises(RuntimeError, match="ValueError: with a lock"):
        processes.submit(refuse).result()


def test_a_process_that_dies_fails_its_task_alone(processes: Processes) -> None:
    dying = processes.submit(lambda: os.kill(os.getpid(), signal.SIGKILL))
    others = [processes.submit(pow, 2, i) for i in range(8)]
    assert [future.result() for future in others] == [2**i for i in range(8)]
    with pytest.raises(WorkerDied, match="SIGKILL"):
        dying.result()
    with pytest.raises(WorkerDied, match="ended with code 7"):
        processes.submit(os._exit, 7).result()


def test_without_waiting_running_tasks_end_at_once() -> None:
    executor = Processes(1)
    pid = executor.submit(os.getpid).result()
    long, queued = executor.submit(time.sleep, 60.0), executor.submit(time.sleep, 60.0)
    time.sleep(0.2)
    began = time.monotonic()
    executor.shutdown(wait=False)
    assert time.monotonic() - began < 5.0
    assert queued.cancelled() and isinstance(long.exception(), WorkerDied) and not running(pid)
    with pytest.raises(RuntimeError, match="shut down"):
        executor.submit(pow, 2, 3)


@pytest.mark.slow
def test_workers_end_with_a_parent_that_is_killed() -> None:
    code = (
        "import os, time\nfrom robotraj.applications.many.processes import Processes\n"
        "executor = Processes(1)\nprint(executor.submit(os.getpid).result(), flush=True)\n"
        "executor.submit(time.sleep, 60.0).result()\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        pid = int(parent.stdout.readline())
        assert running(pid)
        parent.kill()
    assert ends(pid)
