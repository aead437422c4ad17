"""Moving knots converge to the switching times of bang-bang problems."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from problems.case import Case
from problems.switching import Bang, arcs, bangs
from problems.written import TABLE, written

import robotraj as rt

CASES = {case.name: case for case in written(TABLE)}
BANG = rt.schemes.ConstantControl()


def plan(case: Case, mesh: rt.Mesh) -> rt.Solution:
    return rt.plan(case.problem, mesh, case.guess, rt.Ipopt(tolerance=1e-10))


@pytest.mark.parametrize("intervals", [20, 12])
def test_switching_times_of_the_two_link_arm(intervals: int) -> None:
    """Known from arcs integrated to 1e-12."""
    solution = plan(CASES["two_link_arm"], rt.schemes.MovingMesh(intervals, rt.schemes.RadauIIA(5, control=BANG)))
    assert solution.objective == pytest.approx(2.98227994, abs=1e-5)
    first, second = arcs(solution, "u1"), arcs(solution, "u2")
    assert [value for _, value in first] == pytest.approx([1, -1], abs=1e-6)
    assert [value for _, value in second] == pytest.approx([1, -1, 1], abs=1e-6)
    assert [time for time, _ in first[:-1]] == pytest.approx([1.49114], abs=1e-4)
    assert [time for time, _ in second[:-1]] == pytest.approx([0.94314, 2.62755], abs=1e-4)


@pytest.mark.parametrize("intervals", [10, 14, 20])
def test_the_s_curve_of_bounded_jerk_has_its_seven_arcs(intervals: int) -> None:
    """|v| <= 2, |a| <= 4, |j| <= 40 over 4 m: knots at 0.1, 0.5, 0.6, 2.0, 2.1, 2.5, 2.6 s, exact in three points."""
    solution = plan(CASES["min_time_bvp_jerk"], rt.schemes.MovingMesh(intervals, rt.schemes.RadauIIA(3, control=BANG)))
    assert solution.objective == pytest.approx(2.6, abs=1e-8)
    curve = arcs(solution, "j")
    assert [time for time, _ in curve] == pytest.approx([0.1, 0.5, 0.6, 2.0, 2.1, 2.5, 2.6], abs=1e-6)
    assert [value for _, value in curve] == pytest.approx([40, 0, -40, 0, -40, 0, 40], abs=1e-3)


def test_a_block_of_unequal_limits_switches_where_it_must() -> None:
    """-1 <= u <= sqrt 2 from 10 m: T = sqrt(20 (1 + 1 / sqrt 2)), the switch at sqrt 2 / (1 + sqrt 2) T."""
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    pull = np.sqrt(2)
    limits = {"controls": {"u": rt.between(-1, pull)}}
    phase = rt.Phase(system, (0.1, 200), rt.State([10, 0]), rt.State([0, 0]), rt.Duration(), **limits)
    solution = rt.plan(phase, rt.schemes.MovingMesh(3, rt.schemes.RadauIIA(2, control=BANG)), solver=rt.Ipopt(1e-11))
    total = np.sqrt(20 * (1 + 1 / pull))
    assert solution.duration == pytest.approx(total, rel=1e-9)
    assert arcs(solution, "u")[0] == pytest.approx((pull / (1 + pull) * total, -1), abs=1e-6)


@pytest.mark.parametrize("bounds", [(0.2, 3.0), (0.7, 1.2), (1.0, 1.0)])
def test_intervals_keep_their_bounds(bounds: tuple[float, float]) -> None:
    least, most = bounds
    mesh = rt.schemes.MovingMesh([0, 0.1, 0.5, 1], rt.schemes.RadauIIA(3, control=BANG), least, most)
    case: Any = CASES["double_integrator"]
    solution = rt.plan(case.problem, mesh, case.guess)
    shares = np.diff(solution.knots) / solution.duration / np.diff(mesh.knots)
    assert np.all(shares >= least - 1e-6) and np.all(shares <= most + 1e-6)
    if least == most:
        np.testing.assert_allclose(shares, 1, atol=1e-9)


@pytest.mark.parametrize("bounds", [(0.0, 3.0), (-0.1, 3.0), (1.1, 3.0), (0.5, 0.9)])
def test_bounds_that_leave_no_mesh_are_refused(bounds: tuple[float, float]) -> None:
    with pytest.raises(rt.InputError, match="0 < least <= 1 <= most"):
        rt.schemes.MovingMesh(4, rt.schemes.RadauIIA(3), *bounds)


@pytest.mark.parametrize("bang", bangs(), ids=lambda bang: bang.case.name)
def test_refinement_continues_from_the_moved_knots(bang: Bang) -> None:
    """The next meshes keep the switches on knots and move on: the optimum is met far closer than the tolerance."""
    solver = rt.Ipopt(tolerance=1e-10)
    solution = rt.plan(bang.case.problem, bang.mesh, bang.case.guess, solver, tolerance=1e-6)
    assert isinstance(solution.phases[0].mesh, rt.schemes.MovingMesh)
    assert solution.refinement[-1].error <= 1e-6
    assert len(solution.refinement) <= 3 and solution.phases[0].mesh.count <= bang.mesh.count + 2
    assert solution.objective == pytest.approx(bang.case.exact, rel=5e-9)
    for control, exact in bang.switches.items():
        assert [time for time, _ in arcs(solution, control)[:-1]] == pytest.approx(exact, abs=max(1e-6, bang.accuracy))


def test_moving_knots_are_refined_phase_by_phase() -> None:
    """A bang-bang block on moving knots, then a swing on fixed ones."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    swing = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"] - 9.81 * ca.sin(point.x["x"])])
    limits = {"controls": {"u": rt.between(-1, 1)}}
    fast = rt.Phase(block, (0.1, 20), rt.State([-4, 0]), rt.State([0, 0]), rt.Duration(), **limits)
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    up = rt.Phase(swing, 1.5, None, rt.State([np.pi, 0]), effort)
    meshes = [rt.schemes.MovingMesh(3, rt.schemes.RadauIIA(2, control=BANG)), rt.Mesh(6, rt.schemes.RadauIIA(3))]
    solution = rt.plan(rt.Problem([fast, up], [rt.Continuity(0, 1)]), meshes, tolerance=1e-6)
    alone = rt.plan(rt.Phase(swing, 1.5, rt.State([0, 0]), rt.State([np.pi, 0]), effort), tolerance=1e-6)
    assert [type(part.mesh) for part in solution.phases] == [rt.schemes.MovingMesh, rt.Mesh]
    assert solution.objective == pytest.approx(4 + alone.objective, rel=1e-6)
    assert solution.phases[0].duration == pytest.approx(4, rel=1e-7)
