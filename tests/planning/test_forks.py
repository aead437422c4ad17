"""A fork while another thread plans: it waits, and its child plans as any other process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable

import pytest

import robotraj as rt
from robotraj._util.lazy_values import cached_property
from robotraj._util.system.forks import unforked

LIMIT = 30.0
"""Seconds after which a child hangs."""

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")


def exit_code(child: Callable[[], int]) -> int | None:
    """Fork, run the function in the child and return its exit code; None where it hangs."""
    pid = os.fork()
    if pid == 0:
        code = 1
        try:
            code = child()
        finally:
            os._exit(code)
    ends = time.monotonic() + LIMIT
    while time.monotonic() < ends:
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    return None


def test_a_fork_waits_for_other_threads() -> None:
    inside, left = threading.Event(), threading.Event()

    def hold() -> None:
        with unforked():
            inside.set()
            time.sleep(0.2)
            left.set()

    thread = threading.Thread(target=hold)
    thread.start()
    inside.wait()
    assert exit_code(lambda: 0 if left.is_set() else 2) == 0
    thread.join()


def test_a_thread_may_fork_within_its_own_plan_and_enter_again() -> None:
    def enter() -> int:
        with unforked():
            return 0

    with unforked(), unforked():
        assert exit_code(enter) == 0
    assert exit_code(enter) == 0


def test_children_plan_while_a_thread_of_the_parent_does() -> None:
    """Forks that do not wait leave a lock behind: one child in twelve hangs."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    move = rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([1, 0]), rt.Effort())
    locked, stop = threading.Lock(), threading.Event()

    class Locking(rt.InteriorPoint):
        """Needs a lock for its solve, as MUMPS and cached properties do."""

        def solve(self, nlp, progress=None, multipliers=None):  # type: ignore[no-untyped-def]
            with locked:
                time.sleep(0.02)
                return super().solve(nlp, progress, multipliers)

    def plan() -> int:
        return 0 if rt.plan(move, rt.Mesh(5), solver=Locking(), progress=False).success else 2

    def again() -> None:
        while not stop.is_set():
            plan()

    plan()
    thread = threading.Thread(target=again)
    thread.start()
    codes = [exit_code(plan) for _ in range(3)]
    stop.set()
    thread.join()
    assert codes == [0, 0, 0]


def test_a_child_computes_a_property_that_a_thread_of_the_parent_was_computing() -> None:
    """Until Python 3.11 ``functools.cached_property`` has one lock for a class: one child in twenty hung."""
    computing, over = threading.Event(), threading.Event()

    class Slow:
        @cached_property
        def value(self) -> int:
            computing.set()
            return 0 if over.wait(40.0) else 1

    thread = threading.Thread(target=lambda: Slow().value)
    thread.start()
    computing.wait(10.0)

    def read() -> int:
        over.set()
        return Slow().value

    code = exit_code(read)
    over.set()
    thread.join()
    assert code == 0


FIRST_USE = """
import os, threading, time
import robotraj as rt

begun = threading.Event()

class Slow:
    "Finds no module, slowly, while a package is imported."

    def find_spec(self, name, path=None, target=None):
        if name == "robotraj.solvers.ipopt":
            begun.set()
            time.sleep(0.5)
        return None

import sys
sys.meta_path.insert(0, Slow())
thread = threading.Thread(target=lambda: rt.Ipopt)
thread.start()
begun.wait()
pid = os.fork()
if pid == 0:
    rt.Ipopt()
    os._exit(0)
ends = time.monotonic() + 10.0
while time.monotonic() < ends and not os.waitpid(pid, os.WNOHANG)[0]:
    time.sleep(0.01)
if time.monotonic() >= ends:
    os.kill(pid, 9)
    sys.exit("the child hangs")
thread.join()
"""


def test_a_fork_waits_for_the_first_use_of_a_name() -> None:
    """The child inherited the locked import of a module, and hung at its first use."""
    done = subprocess.run([sys.executable, "-c", FIRST_USE], capture_output=True, text=True, timeout=60.0)
    assert done.returncode == 0, done.stderr
