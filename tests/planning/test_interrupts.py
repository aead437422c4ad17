"""Ctrl-C ends a plan at any instant, with any solver, and leaves what was found."""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
import time
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.system import interrupts
from robotraj._util.system.interrupts import heeded
from robotraj.planning.loop import run as loop
from robotraj.planning.loop.state import Found, PlanEnd, PlanState
from robotraj.solution.errors import PlanInterrupted
from robotraj.solvers.status import Status


def reach(end: float = 1.1) -> rt.Phase:
    first, last = [-1.1, -1.8, 1.6, -1.2, -1.57, 0], [end, -0.8, 0.6, -0.6, -0.6, 1.2]
    return rt.Phase(rt.load("ur5"), 1.0, rt.State(q=first, v=0), rt.State(q=last, v=0), rt.Effort())


@contextmanager
def ctrl_c_after(seconds: float) -> Iterator[list[float]]:
    """Press Ctrl-C after a time, and again where Python drops the press in a callback outside of robotraj's calls."""
    sent: list[float] = []
    ended, dropped = threading.Event(), threading.Event()

    def press() -> None:
        again = not ended.wait(seconds)
        while again:
            dropped.clear()
            sent.append(time.process_time())
            os.kill(os.getpid(), signal.SIGINT)
            while not (ended.is_set() or dropped.wait(0.01)):
                pass
            again = not ended.is_set()

    def drop(ignored: sys.UnraisableHookArgs) -> None:
        if ignored.exc_type is KeyboardInterrupt and interrupts._before.get() is None:
            dropped.set()

    before, sys.unraisablehook = sys.unraisablehook, drop
    user = threading.Thread(target=press)
    user.start()
    try:
        yield sent
    finally:
        ended.set()
        user.join()
        sys.unraisablehook = before


@pytest.mark.slow
def test_one_press_ends_a_loop_of_plans() -> None:
    """Other calls and IPOPT are interrupted in ``tests/fuzz/test_interrupts.py``."""
    rng = np.random.default_rng(7)
    for delay in rng.uniform(0.05, 2.5, 6):
        with ctrl_c_after(delay) as sent, pytest.raises(KeyboardInterrupt) as stopped:
            for number in range(1000):
                rt.plan(reach(1.1 - number / 1000), progress=False)
        assert time.process_time() - sent[-1] < 1.0
        if isinstance(stopped.value, PlanInterrupted):
            solution = stopped.value.solution
            assert solution.status is Status.INTERRUPTED and np.isfinite(solution.at(0.5).q).all()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def press(*_: object, **__: object) -> None:
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(0.1)


def test_a_press_that_code_swallows_ends_the_plan_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    respond = loop.respond

    def swallowing(state: PlanState, found: Found) -> PlanState | PlanEnd:
        answer = respond(state, found)
        with suppress(KeyboardInterrupt):
            if isinstance(answer, PlanEnd):
                press()
        return answer

    monkeypatch.setattr(loop, "respond", swallowing)
    arm = rt.load("two_link_arm")
    phase = rt.Phase(arm, 5.0, rt.State(q=0, v=0), rt.State(q=[0.5, 0.5], v=0), rt.Effort())
    with pytest.raises(PlanInterrupted) as stopped:
        rt.plan(phase)
    found = stopped.value.solution
    assert found.at(5.0).q == pytest.approx([0.5, 0.5], abs=1e-6)
    assert pickle.loads(pickle.dumps(stopped.value)).solution.objective == found.objective
    kept = rt.plan(phase, check=False)
    assert kept.status is Status.INTERRUPTED and kept.objective == found.objective


def test_an_error_after_a_press_is_the_press() -> None:
    class Failing(rt.InteriorPoint):
        def solve(self, *_: object, **__: object) -> object:  # type: ignore[override]
            with suppress(KeyboardInterrupt):
                press()
            raise RuntimeError("a callback failed")

    phase = rt.Phase(rt.load("pendulum"), 1.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort())
    with pytest.raises(KeyboardInterrupt):
        rt.plan(phase, rt.Mesh(5), solver=Failing())
    with pytest.raises(KeyboardInterrupt):
        rt.sweep([phase, phase], mesh=rt.Mesh(5), solver=Failing())


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_press_that_python_drops_ends_what_heeds_it() -> None:
    class Gone:
        pass

    def dropping() -> None:
        gone = Gone()
        reference = weakref.ref(gone, press)  # Python ignores what its callback raises
        del gone
        assert reference() is None

    with pytest.raises(KeyboardInterrupt):
        heeded(dropping)()


def test_a_handler_of_the_users_own_stays() -> None:
    seen = []
    before = signal.signal(signal.SIGINT, lambda *_: seen.append(True))
    try:
        phase = rt.Phase(rt.load("pendulum"), 1.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort())

        class Pressing(rt.InteriorPoint):
            def solve(self, *arguments: object, **options: object) -> object:  # type: ignore[override]
                press()
                return super().solve(*arguments, **options)  # type: ignore[arg-type]

        assert rt.plan(phase, rt.Mesh(5), solver=Pressing()).success and seen
    finally:
        signal.signal(signal.SIGINT, before)
