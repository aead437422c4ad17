"""Sweeps: the same answers in the same order on any executor, failures among them."""

from __future__ import annotations

import operator
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.errors import InputError
from robotraj.applications.many.case_limits import CaseLimits
from robotraj.applications.many.workers import run
from robotraj.solvers import interior_point
from robotraj.solvers.kept_multipliers import KeptMultipliers

MESH = rt.Mesh(8)


def moves() -> list[rt.Phase]:
    """Rest to rest over 1 m: effort 12 / T^3; the third is too fast for its control."""
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    bounds = [20.0, 20.0, 1.0, 20.0]
    return [
        rt.Phase(
            system,
            duration=duration,
            start=rt.State([0, 0]),
            end=rt.State([1, 0]),
            controls={"u": rt.between(-bound, bound)},
            objective=rt.Lagrange(lambda point: point.u["u"] ** 2),
        )
        for duration, bound in zip((1.0, 2.0, 0.5, 4.0), bounds, strict=True)
    ]


class Backwards(Executor):
    """Starts nothing until everything was submitted, then runs the last task first."""

    def __init__(self) -> None:
        self._tasks: list[tuple[Future, object, tuple]] = []

    def submit(self, function, /, *arguments):  # type: ignore[no-untyped-def]
        future: Future = Future()
        self._tasks.append((future, function, arguments))
        if len(self._tasks) == 4:
            threading.Thread(target=self._run).start()
        return future

    def _run(self) -> None:
        for future, function, arguments in reversed(self._tasks):
            future.set_result(function(*arguments))


def check(found: list[rt.Solution], problems: list[rt.Phase]) -> None:
    expected = [12.0, 1.5, None, 12.0 / 64.0]
    for solution, objective, phase in zip(found, expected, problems, strict=True):
        assert solution.problem.phases[0] is phase
        assert solution.phases[0].phase is phase
        if objective is None:
            assert solution.status is rt.solvers.Status.INFEASIBLE
            assert solution.violations()
        else:
            assert solution.objective == pytest.approx(objective, rel=1e-7)
            assert solution.at(0.0).x["x"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("make", [lambda: ThreadPoolExecutor(1), lambda: ThreadPoolExecutor(2), Backwards])
def test_order_and_failures_are_kept_on_threads(make: object) -> None:
    problems = moves()
    with make() as executor:
        check(rt.sweep(problems, executor=executor, mesh=MESH), problems)


@pytest.mark.slow
def test_lambdas_travel_to_processes_and_answers_are_identical() -> None:
    problems = moves()
    with ProcessPoolExecutor(2, get_context("spawn")) as executor:
        there = rt.sweep(problems, executor=executor, mesh=MESH)
    check(there, problems)
    with ThreadPoolExecutor(1) as executor:
        here = rt.sweep(problems, executor=executor, mesh=MESH)
    for one, other in zip(there, here, strict=True):
        np.testing.assert_array_equal(one.phases[0].trajectory.u.values, other.phases[0].trajectory.u.values)
        assert one.iterations == other.iterations


@pytest.mark.slow
def test_robots_travel_to_the_default_processes_of_a_script(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "import robotraj as rt\n"
        "def problem(weight):\n"
        "    ends = dict(start=rt.State(q=0, v=0), end=rt.State(q=[0.5, 0.5], v=0))\n"
        "    speed = rt.Lagrange(lambda point: weight * point.v[0] ** 2)\n"
        "    return rt.Phase(rt.load('two_link_arm'), duration=5.0, objective=rt.Effort() + speed, **ends)\n"
        "if __name__ == '__main__':\n"
        "    found = rt.sweep([problem(w) for w in (0.0, 1.0)], mesh=rt.Mesh(30))\n"
        "    assert all(s.success for s in found)\n"
        "    assert found[0].objective < found[1].objective\n"
        "    assert rt.validate(found[1]).passed\n"
        "    print('done')\n"
    )
    run = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=120)
    assert run.stdout.strip() == "done", run.stderr


@pytest.mark.slow
def test_a_script_needs_no_guard_and_its_own_classes_come_back(tmp_path: Path) -> None:
    (tmp_path / "beside.py").write_text("weight = 1.0\n")
    script = tmp_path / "script.py"
    script.write_text(
        "import robotraj as rt, beside\n"
        "class Weighted(rt.objectives.Integral):\n"
        "    def rate(self, point):\n"
        "        return beside.weight * point.u['u'] ** 2\n"
        "    def check(self, dynamics, parameters):\n"
        "        pass\n"
        "system = rt.System(['x'], ['u'], lambda point: [point.u['u']])\n"
        "phase = rt.Phase(system, duration=1.0, start=rt.State([0]), end=rt.State([1]), objective=Weighted())\n"
        "[found] = rt.sweep([phase], mesh=rt.Mesh(4))\n"
        "print(type(found.problem.phases[0].objective) is Weighted, round(found.objective, 6))\n"
    )
    run = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=120)
    assert run.stdout.split() == ["True", "1.0"], run.stderr


def test_nothing_to_plan_gives_nothing() -> None:
    assert rt.sweep([]) == []


def test_problems_and_phases_keep_no_derived_state_when_pickled() -> None:
    import cloudpickle

    phase = moves()[0]
    _ = phase.bound_constraints, phase.dae
    again = cloudpickle.loads(cloudpickle.dumps(rt.Problem([phase])))
    assert set(vars(again.phases[0])) <= set(vars(moves()[0])) | {"bound_links"}
    assert rt.plan(again, mesh=MESH).objective == pytest.approx(12.0, rel=1e-7)


def test_wrong_arguments_are_named() -> None:
    with pytest.raises(InputError, match="number 1 is a int"):
        rt.sweep([moves()[0], 3])
    with pytest.raises(InputError, match="check="):
        rt.sweep(moves(), check=False)
    with pytest.raises(InputError, match="executor"):
        rt.sweep(moves(), executor=2)
    lock = threading.Lock()
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"] * (1 if lock else 0)])
    phase = rt.Phase(system, duration=1.0)
    with ProcessPoolExecutor(1, get_context("spawn")) as executor:
        (entry,) = rt.sweep([phase], executor=executor)
    assert isinstance(entry, rt.applications.Failure) and "pickle" in entry.message


def test_tasks_that_are_not_needed_are_not_begun() -> None:
    begun: list[int] = []
    release = threading.Event()

    def work(shared: list[int], task: int) -> int:
        begun.append(task)
        if task > 2:
            release.wait()
        return shared[0] * task

    with ThreadPoolExecutor(2) as executor:
        assert run(work, [10], range(100), executor, lambda found: len(found) == 3) == [0, 10, 20]
        release.set()
    assert len(begun) < 100


def test_enough_counts_results_in_the_order_of_the_tasks() -> None:
    with Backwards() as executor:
        assert run(operator.mul, 10, range(4), executor, lambda found: len(found) == 3) == [0, 10, 20]


def test_threads_hand_over_the_answer_itself() -> None:
    with ThreadPoolExecutor(1) as executor:
        (solution,) = rt.sweep(moves()[:1], executor=executor, mesh=MESH, solver=rt.InteriorPoint())
    assert isinstance(solution.multipliers, KeptMultipliers)
    assert "plain" not in vars(solution.multipliers), "multipliers are computed when they are read"


class Pressed(Future[bytes]):
    """A task during which the user presses Ctrl-C."""

    def result(self, timeout: float | None = None) -> bytes:
        raise KeyboardInterrupt


class PressedAt(Executor):
    """Runs every task at once, except one that never ends."""

    def __init__(self, number: int) -> None:
        self.number, self.count = number, 0

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **more: Any) -> Future[Any]:
        self.count += 1
        if self.count == self.number:
            return Pressed()
        done: Future[Any] = Future()
        done.set_result(function(*arguments, **more))
        return done


def test_ctrl_c_keeps_the_solutions_that_were_there() -> None:
    with pytest.raises(rt.applications.Interrupted, match="3 of 4 done") as stopped:
        rt.sweep(moves(), executor=PressedAt(3), mesh=MESH)
    found = stopped.value.found
    assert sorted(found) == [0, 1, 3]
    assert found[0].objective == pytest.approx(12.0, rel=1e-3)
    assert found[0].at(0.5).x["x"] == pytest.approx(0.5, abs=1e-3)
    assert isinstance(stopped.value, KeyboardInterrupt)


def test_ctrl_c_does_not_wait_for_fresh_processes() -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    began = time.monotonic()
    try:
        for limits in (CaseLimits(), CaseLimits(seconds=100.0)):
            pressed = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
            pressed.start()
            with pytest.raises(rt.applications.Interrupted) as stopped:
                run(_slow, None, [20.0] * 6, None, limits=limits)
            pressed.cancel()
            assert not stopped.value.found and 1 <= len(stopped.value.running) + len(stopped.value.left) == 6
    finally:
        signal.signal(signal.SIGINT, before)
    assert time.monotonic() - began < 10.0


def test_ctrl_c_while_tasks_are_handed_over() -> None:
    class Pressed(ThreadPoolExecutor):
        """Never runs the third task."""

        left = 2

        def submit(self, *given: Any, **named: Any) -> Any:
            """Hand over, or have Ctrl-C pressed."""
            if not self.left:
                raise KeyboardInterrupt
            self.left -= 1
            future = super().submit(*given, **named)
            future.result()
            return future

    with Pressed(1) as executor, pytest.raises(rt.applications.Interrupted) as pressed:
        run(_twice, None, [1.0, 2.0, 3.0], executor, None)
    assert pressed.value.found == {0: 2.0, 1: 4.0} and "3" in str(pressed.value)


def _twice(shared: None, number: float) -> float:
    return 2 * number


def _slow(shared: None, seconds: float) -> None:
    time.sleep(seconds)


def test_a_robot_that_was_shot_keeps_the_dynamics_of_its_plan() -> None:
    pendulum = rt.load("pendulum")
    phase = rt.Phase(pendulum, 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort())
    shooting = rt.Mesh(8, rt.schemes.MultipleShooting())
    alone = rt.plan(phase, shooting)
    with ThreadPoolExecutor(1) as here:
        (swept,) = rt.sweep([phase], executor=here, mesh=shooting)
    assert swept.error == pytest.approx(alone.error)
    assert swept.phases[0].phase.dynamics == alone.phases[0].phase.dynamics
    assert rt.plan(phase, rt.Mesh(8), guess=swept).success


@pytest.mark.parametrize("processes", [False, True])
def test_a_problem_that_cannot_be_planned_is_named_by_its_number(processes: bool) -> None:
    one, two = moves()[:2]
    problems = [rt.Problem(one), rt.Problem([one, two])]
    pool = ProcessPoolExecutor(1, get_context("spawn")) if processes else ThreadPoolExecutor(1)
    with pool:
        solution, failure = rt.sweep(problems, executor=pool, mesh=[MESH])
    assert solution.success and not failure.success
    assert (failure.number, failure.status) == (1, rt.solvers.Status.ERROR)
    assert "The problem has 2 phases but 1 meshes" in str(failure) and str(failure).startswith("problem 1: error")


@pytest.mark.parametrize("problems", [moves()[0], rt.Problem(moves()[0]), None, 3])
def test_what_is_no_list_of_problems_is_refused(problems: Any) -> None:
    with pytest.raises(InputError, match=f"takes a list of problems or phases; got {type(problems).__name__}"):
        rt.sweep(problems)


@pytest.mark.parametrize("search", [lambda **o: rt.sweep(moves(), **o), lambda **o: rt.multistart(moves()[0], 2, **o)])
def test_options_that_a_plan_does_not_have_are_refused_before_any_worker(search: Any) -> None:
    class Never:
        def submit(self, *_: Any) -> Any:
            raise AssertionError("a worker was asked")

    with pytest.raises(rt.UnknownName, match="argument of rt.(sweep|multistart) named 'msh'. Did you mean 'mesh'"):
        search(executor=Never(), msh=rt.Mesh(3))


def test_a_chain_starts_each_plan_from_the_last_one_solved() -> None:
    """The third problem is too fast for its control; the fourth starts from the second."""
    problems = moves()
    chained = rt.sweep(problems, chain=True, mesh=MESH)
    assert [solution.success for solution in chained] == [True, True, False, True]
    assert [chained[i].objective for i in (0, 1, 3)] == pytest.approx([12.0, 1.5, 12 / 64], rel=1e-6)


def test_a_chain_of_gaits_takes_fewer_iterations_than_cold_plans() -> None:
    """Each cold one takes 10 iterations, from its neighbour 6 or 8, without rows between the points."""
    robot = rt.load("solo12", root="floating", limits={"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7})
    steps = [rt.gait.trot(robot, step_length=length, duration=0.2, clearance=0.04) for length in (0.06, 0.07, 0.08)]
    at_points = rt.interval_limits.ConstraintGeneration(rounds=0)
    options = {
        "mesh": rt.Mesh(4, rt.HermiteSimpson()),
        "solver": rt.InteriorPoint(threads=1),
        "interval_limits": at_points,
    }
    chained = rt.sweep(steps, chain=True, **options)
    cold = [rt.plan(step, **options) for step in steps[1:]]
    for one, other in zip(chained[1:], cold, strict=True):
        assert one.objective == pytest.approx(other.objective, rel=1e-6)
    assert sum(one.iterations for one in chained[1:]) < 0.8 * sum(one.iterations for one in cold)


def test_a_chain_of_default_plans_stays_on_a_proved_mesh_with_its_program(monkeypatch: pytest.MonkeyPatch) -> None:
    built: list[object] = []
    compiled = interior_point.native_program
    monkeypatch.setattr(interior_point, "native_program", lambda *a: built.append(compiled(*a)) or built[-1])
    robot = rt.load("five_link", root="planar")
    steps = [rt.gait.walk(robot, step_length=length, duration=0.6, clearance=0.05) for length in (0.4, 0.41, 0.42)]
    rt.sweep(steps[:1], chain=True)
    of_first = len(built)
    chained = rt.sweep(steps, chain=True)
    assert len(built) == 2 * of_first
    cold = [rt.plan(step, progress=False) for step in steps]
    for one, other in zip(chained, cold, strict=True):
        assert one.proof is not None
        assert one.proof.holds
        assert one.objective == pytest.approx(other.objective, rel=2e-3)
    assert [len(solution.refinement) for solution in chained[1:]] == [1, 1]
    assert sum(one.iterations for one in chained[1:]) < 0.5 * sum(one.iterations for one in cold[1:])


def test_a_chain_of_default_plans_goes_on_after_one_that_is_not_solved() -> None:
    """The third is tried on the mesh of the second, then on a mesh of its own."""
    chained = rt.sweep(moves(), chain=True)
    assert [solution.success for solution in chained] == [True, True, False, True]
    assert [chained[i].objective for i in (0, 1, 3)] == pytest.approx([12.0, 1.5, 12 / 64], rel=1e-3)


def test_a_chain_has_no_executor() -> None:
    with pytest.raises(InputError, match="leave executor= out"):
        rt.sweep(moves(), chain=True, executor=Backwards())
