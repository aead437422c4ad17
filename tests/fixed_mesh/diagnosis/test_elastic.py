"""The relaxed rows are those that were made too tight."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.elastic import relaxed_again, relaxed_motion, sufficient_durations
from robotraj.fixed_mesh.solve import solve
from robotraj.planning.settings import resolve

A = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
B = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])


@pytest.fixture(scope="module")
def ur5() -> rt.Robot:
    return rt.load("ur5")


class Coarse(CoarseSolves):
    """Solves on a number of intervals."""

    def __init__(self, count: int = 15) -> None:
        object.__setattr__(self, "count", count)

    def solve(self, problem: rt.Problem, guess: rt.InitialGuess | rt.Solution | None) -> rt.Solution:
        few = {"mesh": rt.Mesh(self.__dict__["count"]), "solver": rt.InteriorPoint(max_iterations=200, fallback=None)}
        return solve(problem, guess, replace(resolve(problem, few), restarts=rt.planning.Restarts(0)))


COARSE = Coarse()


def reach(ur5: rt.Robot, **changes: Any) -> rt.Problem:
    options = {"duration": 1.0, "start": rt.State(q=A, v=0), "end": rt.State(q=B, v=0)} | changes
    return rt.Problem([rt.Phase(ur5, **options)])


def test_a_problem_that_has_a_solution_needs_no_slack(ur5: rt.Robot) -> None:
    assert relaxed_motion(reach(ur5), COARSE)[1] == ()


@pytest.mark.slow
def test_the_weak_motor_is_named_with_a_torque_that_suffices(ur5: rt.Robot) -> None:
    limits = ur5.limits.with_(effort={"shoulder_lift_joint": 20.0})
    (conflict,) = relaxed_motion(reach(ur5, limits=limits), COARSE)[1]
    assert conflict.name == "effort limit, shoulder_lift_joint" and conflict.unit == "N m"
    assert abs(conflict.bound) == 20.0 and 20.0 < abs(conflict.needed) < 60.0
    stronger = ur5.limits.with_(effort={"shoulder_lift_joint": 1.02 * abs(conflict.needed)})
    assert COARSE.solve(reach(ur5, limits=stronger), None).success


@pytest.mark.slow
def test_a_pose_out_of_reach_is_reported_with_its_distance(ur5: rt.Robot) -> None:
    far = rt.AtEnd(rt.FramePosition("tool0", [1.5, 0.0, 0.3]))
    _, found = relaxed_motion(reach(ur5, end=rt.State(v=0), constraints=[far]), COARSE)
    assert found and found[0].name.startswith("frame position") and found[0].time == pytest.approx(1.0)
    assert abs(found[0].bound - found[0].needed) > 0.3


def test_a_duration_too_short_for_the_motors_is_reported() -> None:
    """A double integrator over 1 m with force 1 on 1 kg needs 2 s from rest to rest."""
    block = rt.System(["x", "v"], ["u"], dynamics=lambda p: [p.x["v"], p.u["u"]])
    phase = rt.Phase(
        block,
        duration=1.9,
        start=rt.State({"x": 0, "v": 0}),
        end=rt.State({"x": 1, "v": 0}),
        controls={"u": rt.between(-1, 1)},
    )
    problem = rt.Problem([phase])
    motion, found = relaxed_motion(problem, COARSE)
    assert [conflict.name for conflict in found] == ["control bound, u"]
    # With force u on 1 kg a motion over 1 m takes 2 / sqrt(u).
    least = (2.0 / 1.9) ** 2
    assert least < abs(found[0].needed) < 1.03 * least
    assert motion is not None
    (longer,) = sufficient_durations(problem, COARSE, motion)
    assert 2.0 < longer.needed < 1.05 * 2.0


@pytest.mark.parametrize(("name", "end", "duration"), [("pendulum", [2.0], 0.6), ("cartpole", [0.5, np.pi], 0.8)])
def test_the_stated_bounds_suffice(name: str, end: list[float], duration: float) -> None:
    """The default call plans and proves the motion with either of the bounds that must be relaxed."""
    robot = rt.load(name)
    rest = rt.State(q=np.zeros(robot.nq), v=0), rt.State(q=end, v=0)
    phase = rt.Phase(robot, duration, *rest, rt.Effort())
    torque, longer = rt.plan(phase, check=False).conflicts
    assert torque.name.startswith("effort limit") and longer.name == "duration"
    rt.plan(phase.with_(limits=robot.limits.with_(effort=abs(torque.needed))))
    rt.plan(phase.with_(duration=longer.needed))


def test_a_swing_too_high_gives_way_before_the_knees_limit() -> None:
    """The robot's own limits are facts, with contacts too; relaxed as well, they were named beside the demand."""
    robot = rt.load("five_link", root="planar")
    solution = rt.plan(rt.gait.walk(robot, step_length=0.4, duration=0.6, clearance=0.75), check=False)
    assert solution.conflicts
    assert all(conflict.name.startswith("swing apex") for conflict in solution.conflicts)


@pytest.mark.slow
def test_rows_that_are_relaxed_on_a_coarse_mesh_are_relaxed_on_a_finer_one(ur5: rt.Robot) -> None:
    problem = reach(ur5, limits=ur5.limits.with_(effort={"shoulder_lift_joint": 20.0}))
    motion, found = relaxed_motion(problem, COARSE)
    assert motion is not None
    finer = relaxed_again(problem, Coarse(20), motion)
    assert [conflict.name for conflict in finer] == [conflict.name for conflict in found]
    assert finer[0].needed == pytest.approx(found[0].needed, rel=0.1)
    enough = reach(ur5, limits=ur5.limits.with_(effort={"shoulder_lift_joint": 1.1 * abs(found[0].needed)}))
    assert relaxed_again(enough, COARSE, motion) == ()


@pytest.mark.parametrize("duration", [1.0, (0.2, 1.0)])
def test_a_budget_too_small_is_named_with_the_least_one(duration: float | tuple[float, float]) -> None:
    # From rest to rest over 1 m within T the integral of the squared acceleration is at least 12 / T^3.
    system = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])
    effort = lambda point: point.u["u"] ** 2  # noqa: E731
    budget = rt.constraints.IntegralConstraint(effort, upper=6.0, name="budget")
    ends = rt.State({"x": 0, "v": 0}), rt.State({"x": 1, "v": 0})
    phase = rt.Phase(system, duration, *ends, rt.Lagrange(effort), constraints=[budget])
    conflict = rt.plan(phase, rt.Mesh(20), check=False).conflicts[0]
    assert conflict.name == "budget" and conflict.bound == 6.0
    assert 12.0 < conflict.needed < 12.36
