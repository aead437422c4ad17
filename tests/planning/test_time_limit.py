"""The time limit of a whole plan, in processor time."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.diagnosis.memory import resident
from robotraj.fixed_mesh.plan_limits import LimitReached, PlanLimits
from robotraj.solvers.base import Iteration


def cartpole(**changes: object) -> rt.Phase:
    start, end = rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0)
    return rt.Phase(rt.load("cartpole"), 2.0, start, end, rt.Effort(), **changes)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"solver": rt.Ipopt()},
        {"mesh": rt.Mesh(40)},
        {"tolerance": 1e-8},
        {"continuation": [rt.planning.ContinuationStep(mesh=rt.Mesh(10))]},
    ],
    ids=["proved", "IPOPT", "mesh", "tolerance", "continuation"],
)
def test_the_last_iterate_is_kept(options: dict[str, object]) -> None:
    solution = rt.plan(cartpole(), time_limit=1e-6, check=False, **options)
    assert solution.status is rt.solvers.Status.TIME_LIMIT and not solution.success
    assert solution.message.endswith("the time limit of 1e-06 s was reached")
    assert "time_limit" in solution.status.remedy
    assert np.isfinite(solution.at(1.0).q).all()


def reach() -> rt.Phase:
    start, end = rt.State(q=[0, -1, 1, 0, 0, 0], v=0), rt.State(q=[1, -1, 1, 0, 0, 0], v=0)
    return rt.Phase(rt.load("ur5"), 1.0, start, end, rt.Effort())


def is_not_begun(solution: rt.Solution, status: rt.solvers.Status) -> None:
    assert solution.status is status and not solution.success and solution.iterations == 0
    assert "no iteration was possible" in solution.message
    assert np.isfinite(solution.at(0.5).q).all() and np.isfinite(solution.at(0.5).tau).all()


@pytest.mark.filterwarnings("ignore:Shooting on this mesh")
@pytest.mark.parametrize(
    "scheme",
    [
        rt.schemes.SingleShooting(),
        rt.schemes.MultipleShooting(),
        rt.schemes.SingleShooting(rt.schemes.Adaptive()),
        rt.schemes.MultipleShooting(rt.schemes.Adaptive()),
    ],
    ids=["single", "multiple", "single, adaptive", "multiple, adaptive"],
)
def test_differentiation_that_takes_longer_is_not_begun(scheme: rt.schemes.Scheme) -> None:
    """CasADi is not interrupted: single shooting took 11 s with a limit of 2 s. The guess is the iterate."""
    solution = rt.plan(reach(), rt.Mesh(20, scheme), check=False, time_limit=0.5)
    is_not_begun(solution, rt.solvers.Status.TIME_LIMIT)


@pytest.mark.filterwarnings("ignore:Shooting on this mesh")
def test_differentiation_that_takes_more_memory_is_not_begun() -> None:
    mesh = rt.Mesh(20, rt.schemes.MultipleShooting())
    is_not_begun(rt.plan(reach(), mesh, check=False, memory_limit=resident() + 60.0), rt.solvers.Status.MEMORY_LIMIT)


def test_cheap_derivatives_are_always_built() -> None:
    """A humanoid's program is sparse: an estimate by its size alone refused it."""
    solution = rt.plan(reach(), rt.Mesh(20), time_limit=1e-6, check=False)
    assert solution.status is rt.solvers.Status.TIME_LIMIT and "no iteration" not in solution.message


@pytest.mark.parametrize("solves", [1, 2])
def test_a_limit_between_the_forms_of_a_compressed_scheme_keeps_a_solution(
    solves: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """rt.plan raised LimitReached where the limit was reached after the separated form."""
    before, count = PlanLimits.before_solve, []

    def late(self: PlanLimits, *program: object) -> None:
        count.append(1)
        if len(count) > solves:
            self._end = -np.inf
        before(self, *program)

    monkeypatch.setattr(PlanLimits, "before_solve", late)
    mesh = rt.Mesh(10, rt.schemes.CompressedHermiteSimpson())
    solution = rt.plan(cartpole(), mesh, time_limit=1e3, check=False)
    assert np.isfinite(solution.at(1.0).q).all()
    assert solution.success == (len(count) <= solves)


def test_a_limit_between_two_candidates_keeps_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """rt.plan raised LimitReached."""
    before, count = PlanLimits.before_solve, []

    def late(self: PlanLimits, *program: object) -> None:
        count.append(1)
        if len(count) > 1:
            self._end = -np.inf
        before(self, *program)

    monkeypatch.setattr(PlanLimits, "before_solve", late)
    places = [rt.FramePosition("tool0", [0.4, y, 0.4]) for y in (0.3, -0.3)]
    phase = reach().with_(end=rt.State(v=0), constraints=[rt.AtEnd(rt.constraints.OneOf(places))])
    solution = rt.plan(phase, rt.Mesh(8), time_limit=1e3, check=False)
    assert len(count) == 2 and solution.status is rt.solvers.Status.TIME_LIMIT
    assert np.isfinite(solution.at(0.5).q).all()


def test_restarts_are_part_of_the_plan() -> None:
    """The goal is out of reach; without a limit the plan takes many times as long."""
    far = cartpole().with_(duration=0.05)
    began = time.process_time()
    solution = rt.plan(far, time_limit=0.3, check=False)
    assert solution.status is rt.solvers.Status.TIME_LIMIT or not solution.success
    assert time.process_time() - began < 3.0


def test_a_failure_that_is_not_explained_in_time_is_returned(monkeypatch: pytest.MonkeyPatch) -> None:
    """The limit was reached between the failure and its explanation, and rt.plan raised LimitReached."""

    def late(solution: rt.Solution, *solves: object) -> rt.Solution:
        raise LimitReached("The time limit of 60 s was reached.")

    monkeypatch.setattr("robotraj.fixed_mesh.diagnosis.explain.explained", late)
    solution = rt.plan(cartpole(), rt.Mesh(10), solver=rt.InteriorPoint(max_iterations=2), restarts=None, check=False)
    assert solution.status is rt.solvers.Status.ITERATION_LIMIT and not solution.conflicts


def test_a_motion_that_was_proved_in_time_is_a_success(monkeypatch: pytest.MonkeyPatch) -> None:
    goals = rt.solution.Goals(objective=1e-9)
    read = PlanLimits._read

    def late(self: PlanLimits) -> None:
        """Let the clock run out once two meshes are solved."""
        self.solves = getattr(self, "solves", 0)
        if self.solves >= 3:
            self._end = -np.inf
        read(self)

    def counted(self: PlanLimits, *program: object) -> None:
        self.solves = getattr(self, "solves", 0) + 1
        before(self, *program)

    before = PlanLimits.before_solve
    monkeypatch.setattr(PlanLimits, "_read", late)
    monkeypatch.setattr(PlanLimits, "before_solve", counted)
    solution = rt.plan(cartpole(), goals=goals, time_limit=1e3)
    assert solution.success and solution.proof is not None
    assert solution.proof.motion_holds and not solution.proof.holds
    assert "time limit" in solution.message


def test_many_phases_are_not_written_in_stages_where_the_time_is_over() -> None:
    robot = rt.load("pendulum")
    ends = {0: {"start": rt.State(q=0.0, v=0.0)}, 149: {"end": rt.State(q=0.5, v=0.0)}}
    phases = [rt.Phase(robot, 0.1, objective=rt.Effort(), **ends.get(k, {})) for k in range(150)]
    problem = rt.Problem(phases)
    rt.plan(rt.Problem(phases[:2]), check=False)
    began = time.process_time()
    solution = rt.plan(problem, check=False, time_limit=1.0)
    assert solution.status is rt.solvers.Status.TIME_LIMIT
    # The transcription makes the iterate that is returned.
    assert time.process_time() - began < 6.0


def test_ample_time_changes_nothing() -> None:
    assert rt.plan(cartpole(), time_limit=1e3).objective == rt.plan(cartpole()).objective


def test_the_clock_is_read_at_every_iteration() -> None:
    seen: list[Iteration] = []
    deadline = PlanLimits(1e-9, np.inf, seen.append)
    deadline.before_solve(rt.Problem([cartpole()]), rt.Mesh(2))
    with pytest.raises(LimitReached, match="1e-09 s"):
        deadline(Iteration(0, 0.0, 0.0))
    with pytest.raises(LimitReached):
        deadline.before_solve(rt.Problem([cartpole()]), rt.Mesh(2))
    assert len(seen) == 1 and deadline.reached
    deadline.begin()
    deadline.before_solve(rt.Problem([cartpole()]), rt.Mesh(2))


@pytest.mark.parametrize("limit", [0.0, -1.0, "60"])
def test_a_limit_must_be_seconds_above_zero(limit: object) -> None:
    with pytest.raises(rt.InputError, match="time_limit must be a number above 0 s"):
        rt.plan(cartpole(), time_limit=limit)  # type: ignore[arg-type]


def test_compilers_are_part_of_the_plan_and_stop_at_its_limit(tmp_path: Path) -> None:
    """A compiler that never ends, with a child of its own, leaves neither of them behind."""
    fake = tmp_path / "slow-cc"
    fake.write_text('#!/bin/sh\n[ "$1" = -v ] && exit 0\nsleep 61.803 & wait\n')
    fake.chmod(0o755)
    engine = rt.engines.Compiled(compiler=str(fake), cache=tmp_path / "cache", least=1)
    began = time.monotonic()
    solution = rt.plan(cartpole(), mesh=rt.Mesh(20), engine=engine, time_limit=1.0, check=False)
    assert time.monotonic() - began < 10.0
    assert np.isfinite(solution.at(1.0).q).all()
    commands = [path.read_bytes() for path in Path("/proc").glob("[0-9]*/cmdline") if path.exists()]
    assert not any(b"61.803" in command for command in commands)


def test_a_plan_stops_at_its_memory_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    held = iter([100.0, 100.0, *[300.0] * 100])
    monkeypatch.setattr("robotraj.fixed_mesh.plan_limits.resident", lambda: next(held))
    solution = rt.plan(cartpole(), memory_limit=200.0, check=False)
    assert solution.status is rt.solvers.Status.MEMORY_LIMIT and not solution.success
    assert solution.message.endswith("the memory limit of 200 MB was reached")
    assert "memory_limit" in solution.status.remedy
    assert np.isfinite(solution.at(1.0).q).all()


def test_a_mesh_that_takes_too_much_memory_is_refused_before_it_is_built() -> None:
    began = time.process_time()
    with pytest.raises(rt.InputError, match=r"memory_limit is .* MB, of which .* takes at least another"):
        rt.plan(cartpole(), mesh=rt.Mesh(100_000), memory_limit=resident() + 50.0)
    assert time.process_time() - began < 1.0


def test_ample_memory_changes_nothing() -> None:
    assert rt.plan(cartpole(), memory_limit=1e6).objective == rt.plan(cartpole()).objective


@pytest.mark.parametrize("limit", [0.0, -1.0, np.nan, "big"])
def test_a_memory_limit_is_a_positive_number(limit: object) -> None:
    with pytest.raises(rt.InputError, match="memory_limit"):
        rt.plan(cartpole(), memory_limit=limit)
