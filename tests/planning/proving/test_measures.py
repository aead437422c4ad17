"""Meshes that follow from the measures of a plan."""

from __future__ import annotations

import casadi as ca

import robotraj as rt
from robotraj.planning.proving.measures import measured
from robotraj.transcription.refinement.equidistribution import Equidistribute


def test_only_phases_that_miss_a_goal_get_many_more_intervals() -> None:
    """A fast oscillator errs on four intervals, and uniform motion does not."""
    block = rt.System(["x", "v"], [], lambda point: [point.x["v"], 0.0])
    spring = rt.System(["x", "v"], [], lambda point: [point.x["v"], -40.0 * ca.sin(point.x["x"])])
    start = rt.State({"x": 0.0, "v": 1.0})
    moves = [rt.Phase(system, 1.0, start=start) for system in (spring, block)]
    solution = rt.plan(rt.Problem(moves, []), rt.Mesh(4))
    measures = measured(solution, None, rt.solution.Goals())
    assert measures.errors[0].max() > measures.proof.goals.error > measures.errors[1].max()
    missing, met = measures.next_meshes(solution.phases, Equidistribute(), 1.0, 2.0)
    assert missing.count >= 8 and met.count == 4
    finer = measures.next_meshes(solution.phases, Equidistribute(), 3.0, 2.0)
    assert min(mesh.count for mesh in finer) >= 12
