"""Motions divided where bounds on states become active and inactive: junctions and costates are exact."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import robotraj as rt

TIGHT = rt.Ipopt(tolerance=1e-13)
MESHES = [
    rt.Mesh(1, rt.schemes.RadauIIA(points=3)),
    rt.Mesh(3, rt.schemes.RadauIIA(points=3)),
    rt.Mesh(2, rt.schemes.GaussLegendre(points=3)),
    rt.Mesh(4, rt.HermiteSimpson()),
]
BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
EFFORT = rt.Lagrange(lambda point: 0.5 * point.u["u"] ** 2)
PEAK, REACH = 1.2, 0.25


def cut(phase: rt.Phase, mesh: rt.Mesh) -> rt.Solution:
    """Plan without knowledge of the arcs, divide the motion at the junctions, and plan again."""
    problem, guess = rt.indirect.cut_at_junctions(rt.plan(phase, tolerance=1e-6))
    return rt.plan(problem, mesh, guess, TIGHT)


@pytest.fixture(scope="module", params=[1 / 9, 0.08, 0.13])
def bounce(bryson_denham: Any, request: pytest.FixtureRequest) -> tuple[float, rt.Solution]:
    """A top, and its plan without a division into arcs."""
    return request.param, rt.plan(bryson_denham.phase(top=request.param), tolerance=1e-6)


@pytest.mark.parametrize("mesh", MESHES, ids=str)
def test_bryson_denhams_costates_from_a_plan_without_its_arcs(
    bryson_denham: Any, bounce: tuple[float, rt.Solution], mesh: rt.Mesh
) -> None:
    """Second order: the bound is met without speed, and the costate of x jumps there. Each side has its limit."""
    top, direct = bounce
    problem, guess = rt.indirect.cut_at_junctions(direct)
    solution = rt.plan(problem, mesh, guess, TIGHT)
    bryson_denham.assert_three_arcs(solution, top)


def hurry(**more: Any) -> rt.Phase:
    """One metre in one second from rest to rest, least effort, v <= 1.2.

    The force falls on a line from 2 v / a = 9.6 to 0 at a = 3/2 (1 - 1 / v) = 1/4 s, and mirrors after 3/4 s.
    """
    limit = {"v": rt.between(None, PEAK)}
    return rt.Phase(BLOCK, 1.0, rt.State([0, 0]), rt.State([1, 0]), EFFORT, states=limit, **more)


@pytest.mark.parametrize(
    "mesh", [MESHES[0], MESHES[1], MESHES[3], rt.Mesh(3, rt.schemes.LobattoIIIA(points=4))], ids=str
)
def test_a_speed_limit_is_of_first_order_and_its_costates_run_on(mesh: rt.Mesh) -> None:
    solution = cut(hurry(), mesh)
    force = 2 * PEAK / REACH
    assert solution.objective == pytest.approx(force**2 * REACH / 3, rel=1e-9)
    assert [part.t0 for part in solution.phases] == pytest.approx([0, REACH, 1 - REACH], abs=1e-6)
    for part in rt.indirect.costates(solution).phases:
        t = np.linspace(part.solution.t0, part.solution.t0 + part.solution.duration, 201)
        rising = np.maximum(1 - t / REACH, 0) - np.maximum(1 - (1 - t) / REACH, 0)
        exact = np.column_stack([np.full(len(t), -force / REACH), -force * rising])
        assert part.duals.costate(t) / [force / REACH, force] == pytest.approx(exact / [force / REACH, force], abs=1e-4)


def test_a_robot_at_its_speed_limit_is_cut_too() -> None:
    robot = rt.load("block")
    limits = robot.limits.with_(velocity=PEAK, effort=100.0)
    phase = rt.Phase(robot, 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort(), limits=limits)
    solution = cut(phase, rt.Mesh(2, rt.schemes.RadauIIA(3)))
    assert [part.t0 for part in solution.phases] == pytest.approx([0, REACH, 1 - REACH], abs=1e-6)
    assert solution.at(0.5).v == pytest.approx([PEAK], abs=1e-8)


def test_a_free_duration_stays_free() -> None:
    """Effort and 20 a second: from 4 v^2 / (3 a) + 20 (1 / v + 2 a / 3) the ramps last a = v / sqrt 10."""
    phase = rt.Phase(
        BLOCK,
        (0.2, 5.0),
        rt.State([0, 0]),
        rt.State([1, 0]),
        EFFORT + 20 * rt.Duration(),
        states={"v": rt.between(None, PEAK)},
    )
    solution, ramp = cut(phase, rt.Mesh(2, rt.schemes.RadauIIA(3))), PEAK / np.sqrt(10)
    total = 1 / PEAK + 2 * ramp / 3
    assert solution.objective == pytest.approx(4 * PEAK**2 / (3 * ramp) + 20 * total, rel=1e-9)
    assert [part.duration for part in solution.phases] == pytest.approx([ramp, total - 2 * ramp, ramp], abs=1e-6)
    # Time is a Mayer term: the Hamiltonian contains the effort alone, and equals minus the price of time throughout.
    for part in rt.indirect.costates(solution).phases:
        t = np.linspace(part.solution.t0, part.solution.t0 + part.solution.duration, 21)
        assert part.at(t).hamiltonian == pytest.approx(np.full(21, -20.0), rel=1e-5)


def test_constraints_of_the_ends_go_with_the_ends() -> None:
    at_rest = rt.PathConstraint(lambda point: point.x["v"], 0.0, 0.0)
    phase = rt.Phase(
        BLOCK,
        1.0,
        rt.State([0, None]),
        rt.State([1, None]),
        EFFORT,
        [rt.AtStart(at_rest), rt.AtEnd(at_rest)],
        states={"v": rt.between(None, PEAK)},
    )
    problem, _ = rt.indirect.cut_at_junctions(rt.plan(phase, tolerance=1e-6))
    kinds = [[type(constraint) for constraint in part.constraints] for part in problem.phases]
    assert kinds == [[rt.AtStart, rt.AtEnd], [rt.AtEnd], [rt.AtEnd]]
    solution = cut(phase, rt.Mesh(2, rt.schemes.RadauIIA(3)))
    assert solution.objective == pytest.approx((2 * PEAK / REACH) ** 2 * REACH / 3, rel=1e-8)


def test_what_cannot_be_cut_is_refused(kirk: Any) -> None:
    with pytest.raises(rt.InputError, match="has no junction"):
        rt.indirect.cut_at_junctions(rt.plan(kirk.phase(), rt.Mesh(10)))
    two = rt.Problem([hurry(), hurry()], [])
    with pytest.raises(rt.InputError, match="one phase; this one has 2"):
        rt.indirect.cut_at_junctions(rt.plan(two, rt.Mesh(10)))
    mayer = rt.Phase(BLOCK, 1.0, rt.State([0, 0]), None, EFFORT + rt.Mayer(lambda a, b: (b.x["x"] - 1) ** 2))
    with pytest.raises(rt.InputError, match="a cost of its ends"):
        rt.indirect.cut_at_junctions(rt.plan(mayer, rt.Mesh(10)))
    scaled = rt.System(["x"], ["u"], lambda point: [point.p["k"] * point.u["u"]])
    unknown = rt.Phase(scaled, 1.0, rt.State([0]), rt.State([1]), EFFORT, parameters={"k": rt.between(1, 2)})
    with pytest.raises(rt.InputError, match="unknown parameters"):
        rt.indirect.cut_at_junctions(rt.plan(unknown, rt.Mesh(10)))
