"""Causes of failures from the relaxed problem on a coarse mesh and on a finer one."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.explain import explained
from robotraj.solvers.status import Status


@pytest.mark.slow
def test_limits_conflict_where_only_a_coarse_mesh_has_a_motion() -> None:
    """On six intervals by Simpson's rule, a jump of five_link meets limits that it exceeds between their points."""
    jump = rt.gait.jump(rt.load("five_link", root="planar"), height=0.318, length=0.473, margin=0.0)
    stopped = rt.plan(jump, rt.Mesh(2), solver=rt.InteriorPoint(max_iterations=2), progress=False, check=False)
    failed = replace(stopped, status=Status.INFEASIBLE, conflicts=())
    coarse = CoarseSolves(stopped.settings)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(CoarseSolves, "on_finer", property(lambda self: self))
        on_this_mesh = explained(failed, coarse)
    assert on_this_mesh.status is Status.NOT_ON_THIS_MESH and not on_this_mesh.conflicts
    in_conflict = explained(failed, coarse)
    assert in_conflict.status is Status.NOT_FOUND and in_conflict.conflicts


@pytest.mark.slow
def test_a_limit_of_the_tool_speed_that_is_too_low_is_named() -> None:
    """Many motions need the same speed of the tool, so that the relaxed problem takes 80 to 420 iterations."""
    panda = rt.load("panda")
    start, end = [-0.59, 0.1, -0.25, -0.96, 0.98, 1.07, 0.21], [0.45, -0.51, -0.43, -1.28, 0.93, 1.3, -0.61]
    slow = rt.constraints.FrameSpeed("panda_hand_tcp", linear=0.1)
    # The last joint is free, so that the way of the tool is not known before the solve.
    ends = rt.State(q=start, v=0), rt.State(q=dict(zip(panda.position_names[:-1], end[:-1], strict=True)), v=0)
    solution = rt.plan(rt.Phase(panda, 1.82, *ends, rt.Effort(), [slow]), check=False)
    conflict = solution.conflicts[0]
    assert conflict.name == "linear speed, panda_hand_tcp" and 0.15 < conflict.needed < 0.25


def on_a_line() -> rt.Problem:
    """Pose a drive over 9 m in two phases of 3.5 s together, at up to 2 m/s."""
    car = rt.System(["x", "v"], ["a"], dynamics=lambda point: [point.x["v"], point.u["a"]])
    bounds = {"controls": {"a": rt.between(-5, 5)}, "states": {"v": rt.between(-2, 2)}}
    first = rt.Phase(car, 2.0, rt.State({"x": 0, "v": 0}), None, name="first", **bounds)
    second = rt.Phase(car, 1.5, None, rt.State({"x": 9, "v": 0}), name="second", **bounds)
    return rt.Problem([first, second], [rt.Continuity(0, 1)])


def test_durations_of_several_phases_are_stated_that_suffice_together() -> None:
    problem = on_a_line()
    solution = rt.plan(problem, check=False)
    longer = {each.phase: each.needed for each in solution.conflicts if each.name == "duration"}
    assert longer
    phases = [phase.with_(duration=longer.get(phase.name, phase.duration)) for phase in problem.phases]
    # 9 m at 2 m/s, and 0.4 s each to speed up and to brake, on average at half the speed.
    assert 4.9 < sum(phase.duration for phase in phases) < 1.05 * 4.9
    assert rt.plan(rt.Problem(phases, problem.links)).success


def test_a_duration_that_mean_speeds_exclude_is_stated_as_one_that_suffices() -> None:
    """The mean speed is necessary alone: the stated duration was too short for a start and an end at rest."""
    panda = rt.load("panda")
    start = np.array([0, -0.5, 0, -2, 0, 1.5, 0.8])
    pick = rt.Phase(panda, 0.3, rt.State(q=start, v=0), rt.State(q=start + 0.2, v=0), rt.Effort(), name="pick")
    end = rt.State(q=[0.5, 0.2, 0, -1.2, 0.5, 2.5, 0.8], v=0)
    place = rt.Phase(panda, 0.25, None, end, rt.Effort(), name="place")
    solution = rt.plan(rt.Problem([pick, place], [rt.Continuity(0, 1)]), check=False)
    assert solution.status is Status.INFEASIBLE
    (longer,) = solution.conflicts
    assert (longer.phase, longer.name) == ("place", "duration")
    enough = place.with_(duration=longer.needed)
    assert rt.plan(rt.Problem([pick, enough], [rt.Continuity(0, 1)])).success


def test_a_duration_is_stated_where_the_equations_have_no_motion_within_it() -> None:
    """A plane at 2 m/s does not cover 8.6 m in 4 s, whatever its controls."""
    plane = rt.System(
        ["x", "y", "heading"],
        ["turn"],
        dynamics=lambda p: [2 * ca.cos(p.x["heading"]), 2 * ca.sin(p.x["heading"]), p.u["turn"]],
    )
    ends = rt.State({"x": 0, "y": 0, "heading": 0}), rt.State({"x": 7, "y": 5, "heading": 0})
    flight = rt.Phase(plane, 4.0, *ends, rt.Lagrange(lambda p: p.u["turn"] ** 2), controls={"turn": rt.between(-1, 1)})
    (longer,) = rt.plan(flight, check=False).conflicts
    assert longer.name == "duration" and rt.plan(flight.with_(duration=longer.needed)).success
