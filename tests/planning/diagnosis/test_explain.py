"""Causes of failures from the relaxed problem on a coarse mesh and on a finer one."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import robotraj as rt
from robotraj.planning.diagnosis.explain import explained
from robotraj.planning.solve import solve_relaxed
from robotraj.solvers.status import Status


def test_limits_conflict_where_only_a_coarse_mesh_has_a_motion() -> None:
    """On six intervals by Simpson's rule, a jump of five_link meets limits that it exceeds between their points."""
    jump = rt.gait.jump(rt.load("five_link", root="planar"), height=0.318, length=0.473)
    stopped = rt.plan(jump, rt.Mesh(2), solver=rt.InteriorPoint(max_iterations=2), progress=False, check=False)
    failed = replace(stopped, status=Status.INFEASIBLE, conflicts=())
    coarse = partial(solve_relaxed, settings=stopped.settings)
    on_this_mesh = explained(failed, coarse, coarse, bool)
    assert on_this_mesh.status is Status.NOT_ON_THIS_MESH and not on_this_mesh.conflicts
    in_conflict = explained(failed, coarse, partial(coarse, finer=True), bool)
    assert in_conflict.status is Status.NOT_FOUND and in_conflict.conflicts


def test_a_limit_of_the_tool_speed_that_is_too_low_is_named() -> None:
    """Many motions need the same speed of the tool, so that the relaxed problem takes 80 to 420 iterations."""
    panda = rt.load("panda")
    start, end = [-0.59, 0.1, -0.25, -0.96, 0.98, 1.07, 0.21], [0.45, -0.51, -0.43, -1.28, 0.93, 1.3, -0.61]
    slow = rt.constraints.FrameSpeed("panda_hand_tcp", linear=0.1)
    ends = rt.State(q=start, v=0), rt.State(q=end, v=0)
    solution = rt.plan(rt.Phase(panda, 1.82, *ends, rt.Effort(), [slow]), check=False)
    conflict = solution.conflicts[0]
    assert conflict.name == "linear speed, panda_hand_tcp" and 0.15 < conflict.needed < 0.25
