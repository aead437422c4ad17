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
    on_this_mesh = explained(failed, coarse, coarse)
    assert on_this_mesh.status is Status.NOT_ON_THIS_MESH and not on_this_mesh.conflicts
    in_conflict = explained(failed, coarse, partial(coarse, finer=True))
    assert in_conflict.status is Status.NOT_FOUND and in_conflict.conflicts
