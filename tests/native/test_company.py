"""A compiled solve beside callbacks, threads, forked processes, signals and time limits."""

from __future__ import annotations

import os
import signal
import threading
import time
from typing import Any

import casadi as ca
import numpy as np
import pytest

from robotraj.native import Options

BOUND = np.full(60, 5.0)


def test_what_a_callback_raises_is_raised_and_ctrl_c_keeps_the_iterate(pendulum: Any) -> None:
    written = pendulum.write()
    program = written.build()
    start = np.zeros(written.linear.shape[1])

    def fail(*_: float) -> bool:
        raise LookupError("asked too much")

    def interrupt(iteration: int, *_: float) -> bool:
        if iteration == 3:
            raise KeyboardInterrupt
        return False

    with pytest.raises(LookupError, match="asked too much"):
        program.solve(start, -BOUND, BOUND, callback=fail)
    outcome = program.solve(start, -BOUND, BOUND, callback=interrupt)
    assert outcome.status == "interrupted"
    assert outcome.iterations == 3
    assert np.all(np.isfinite(outcome.y))


def test_a_program_is_solved_once_at_a_time(pendulum: Any) -> None:
    written = pendulum.write()
    program = written.build()
    start = np.zeros(written.linear.shape[1])

    def again(*_: float) -> bool:
        program.solve(start, -BOUND, BOUND)
        return False

    with pytest.raises(RuntimeError, match="busy in another call"):
        program.solve(start, -BOUND, BOUND, callback=again)
    assert program.solve(start, -BOUND, BOUND).status == "solved"


def test_a_program_keeps_other_calls_out_of_its_memory(pendulum: Any) -> None:
    written = pendulum.write()
    program = written.build()
    start = np.zeros(written.linear.shape[1])
    calls = [
        lambda: program.rows(start),
        lambda: program.jacobian(start),
        lambda: program.set_offsets(np.ones(written.linear.shape[0]), 1.0),
    ]
    for call in calls:
        with pytest.raises(RuntimeError, match="busy in another call"):
            program.solve(start, -BOUND, BOUND, callback=lambda *_, call=call: call() is None)
    assert program.solve(start, -BOUND, BOUND).status == "solved"


@pytest.mark.parametrize("plugin", ["fatrop", "ipopt"])
def test_a_callback_may_solve_with_casadi(pendulum: Any, plugin: str) -> None:
    written = pendulum.write()
    program, start = written.build(), np.zeros(written.linear.shape[1])
    expected = program.solve(start, -BOUND, BOUND).objective
    opti, seen = ca.Opti(), []
    x = opti.variable(2)
    opti.subject_to(x[0] + x[1] == 1)
    opti.minimize(ca.sumsqr(x))
    opti.solver(plugin, {"print_time": False}, {"print_level": 0})

    def other(*_: float) -> bool:
        seen.append(np.asarray(opti.solve().value(x)))
        return False

    assert program.solve(start, -BOUND, BOUND, callback=other).objective == expected
    np.testing.assert_allclose(seen, 0.5, atol=1e-6)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_forked_process_solves_and_frees_what_it_was_given(pendulum: Any) -> None:
    """Threads that wait for work exist in the parent only; the child starts its own and joins no others."""
    written = pendulum.write()
    written.threads = 2
    program = written.build()
    start = np.zeros(written.linear.shape[1])
    expected = program.solve(start, -BOUND, BOUND).objective
    child = os.fork()
    if child == 0:
        # No code of pytest may run here: the exit status is the result.
        same = program.solve(start, -BOUND, BOUND).objective == expected
        other = written.build()
        same = same and other.solve(start, -BOUND, BOUND).objective == expected
        del program, other
        os._exit(0 if same else 1)
    ended, until = 0, time.monotonic() + 60
    while not ended and time.monotonic() < until:
        time.sleep(0.02)
        ended, status = os.waitpid(child, os.WNOHANG)
    if not ended:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    assert ended and os.waitstatus_to_exitcode(status) == 0


@pytest.fixture
def endless(shooting: Any) -> Any:
    """Solve a problem whose objective falls for ever, along a straight line."""
    written = shooting(lambda x, u: x + u, 1, 1, 40, lambda x, u: -u, [0.0]).write()
    none, options = np.zeros(0), Options(max_iterations=10**9)
    program, start = written.build(), np.zeros(written.linear.shape[1])
    return lambda: program.solve(start, none, none, options, time_limit=60.0)


def test_signals_raise_what_their_handlers_raise(endless: Any) -> None:

    def handler(*_: object) -> None:
        raise TimeoutError("the alarm")

    before = signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.2)
    try:
        with pytest.raises(TimeoutError, match="the alarm"):
            endless()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_ctrl_c_ends_a_solve_that_calls_no_python(endless: Any) -> None:
    # Workers of pytest-xdist ignore Ctrl-C.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        pressed = threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT))
        pressed.start()
        outcome = endless()
        pressed.join()
    finally:
        signal.signal(signal.SIGINT, before)
    assert outcome.status == "interrupted"
    assert outcome.iterations > 20
    assert np.all(np.isfinite(outcome.y))


def test_a_program_that_was_interrupted_solves_as_a_new_one_does(pendulum: Any) -> None:
    written = pendulum.write()
    program, start = written.build(), np.zeros(written.linear.shape[1])

    def interrupt(iteration: int, *_: float) -> bool:
        if iteration == 5:
            raise KeyboardInterrupt
        return False

    assert program.solve(start, -BOUND, BOUND, callback=interrupt).status == "interrupted"
    after, new = program.solve(start, -BOUND, BOUND), written.build().solve(start, -BOUND, BOUND)
    assert after.status == new.status == "solved"
    assert np.array_equal(after.y, new.y)


def test_a_time_limit_ends_a_solve(pendulum: Any) -> None:
    written = pendulum.write()
    start = np.zeros(written.linear.shape[1])
    outcome = written.build().solve(start, -BOUND, BOUND, time_limit=0.0)
    assert outcome.status == "time limit"
    assert outcome.iterations == 0


def test_an_iteration_that_would_exceed_the_time_limit_does_not_begin(pendulum: Any) -> None:
    written = pendulum.write()
    start = np.zeros(written.linear.shape[1])

    def slow(iteration: int, *_: float) -> bool:
        time.sleep(0.1)
        return False

    # Two iterations of 0.1 s end at 0.2 s, and a third one would end at 0.3 s.
    outcome = written.build().solve(start, -BOUND, BOUND, time_limit=0.28, callback=slow)
    assert outcome.status == "time limit"
    assert outcome.iterations <= 2
