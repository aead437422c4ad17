"""Links on problems with closed forms."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt

CLOSE = {"rel": 1e-8}


def test_a_motion_cut_at_a_knot_is_the_motion_uncut() -> None:
    """The same knots give the same NLP, written in two phases."""
    system = rt.System(
        ["q", "w"], ["u"], lambda point: [point.x["w"], point.u["u"] - ca.sin(point.x["q"]) * ca.cos(point.t)]
    )
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2 + point.t * point.x["w"] ** 2)
    ends = rt.State([0, 0]), rt.State([3, 0])
    whole = rt.plan(rt.Phase(system, 2.0, *ends, effort), rt.Mesh(20))
    parts = [rt.Phase(system, 0.8, ends[0], None, effort), rt.Phase(system, 1.2, None, ends[1], effort)]
    cut = rt.plan(rt.Problem(parts, [rt.Continuity(0, 1)]), [rt.Mesh(8), rt.Mesh(12)])
    assert cut.objective == pytest.approx(whole.objective, **CLOSE)
    times = np.linspace(0, 2, 41)
    np.testing.assert_allclose(cut.at(times).x["q"], whole.at(times).x["q"], atol=1e-6)
    np.testing.assert_allclose(cut.knots, whole.knots, atol=1e-12)


@pytest.mark.parametrize(("jump", "kick"), [(1.0, 1.0), (rt.between(0.5, 2), 0.5), (rt.between(-1, 1), 0.0)])
def test_a_kick_in_the_middle_costs_its_square(push: Any, jump: Any, kick: float) -> None:
    """From rest to rest over 1 m in 1 s with a kick j at half time costs 12 + j^2: of a range, the smallest is best."""
    phases = [push.phase(0.5, [0, 0]), push.phase(0.5, None, [1, 0])]
    solution = push.plan(phases, [rt.links.Jump(0, 1, {"v": jump})])
    assert solution.objective == pytest.approx(12 + kick**2, **CLOSE)
    before, after = solution.phases[0].at(0.5).x, solution.phases[1].at(0.5).x
    assert after["v"] - before["v"] == pytest.approx(kick, abs=1e-5)
    assert after["x"] == pytest.approx(before["x"], abs=1e-10)
    assert solution.at(0.5).x["v"] == after["v"]


def test_a_jump_of_all_states_left_free_joins_time_alone(push: Any) -> None:
    phases = [push.phase((0.5, 2), [0, 0], [1, 0]), push.phase((0.5, 2), [5, 0], [7, 0])]
    total = rt.links.Linkage((0, 1), lambda a, b: b.end.t - a.start.t, 2.0, 2.0, name="total")
    solution = push.plan(phases, [rt.links.Jump(0, 1, {"x": None, "v": None}), total])
    # d^2 / T^4 is the same in both where the sum of 12 d^2 / T^3 is least.
    share = np.sqrt([1, 2]) / (1 + np.sqrt(2))
    assert [part.duration for part in solution.phases] == pytest.approx(2 * share, rel=1e-6)
    assert solution.objective == pytest.approx(12 * np.sum(np.array([1, 4]) / (2 * share) ** 3), **CLOSE)


def test_phases_of_equal_duration_share_the_total_time(push: Any) -> None:
    phases = [push.phase((0.5, 2), [0, 0], [1, 0]), push.phase((0.5, 2), [1, 0], [3, 0])]
    total = rt.links.Linkage((0, -1), lambda a, b: b.end.t - a.start.t, 2.0, 2.0)
    solution = push.plan(phases, [rt.Continuity(0, 1), rt.links.EqualDuration(0, 1), total])
    assert [part.duration for part in solution.phases] == pytest.approx([1, 1], rel=1e-9)
    assert solution.objective == pytest.approx(12 * (1 + 4), **CLOSE)


def test_a_bounce_loses_speed_at_the_wall(push: Any) -> None:
    """To a wall at 0.5 m in 1 s and back in 1 s with w+ = -0.8 w-: a quadratic in w-."""
    phases = [push.phase(1.0, [0, 0], {"x": 0.5}), push.phase(1.0, {"x": 0.5}, [0, 0])]
    bounce = rt.links.Linkage((0, 1), lambda a, b: b.start.x["v"] + 0.8 * a.end.x["v"], name="restitution", unit="m/s")
    solution = push.plan(phases, [rt.links.Jump(0, 1, {"v": None}), bounce])
    # The way back, run backwards, is a push from rest over 0.5 m to the speed 0.8 w.
    speeds = np.array([0.0, 1.0, 2.0])
    a, b, c = np.polyfit(speeds, [push.cost(0.5, w) + push.cost(0.5, 0.8 * w) for w in speeds], 2)
    assert solution.phases[0].at(1.0).x["v"] == pytest.approx(-b / (2 * a), rel=1e-6)
    assert solution.objective == pytest.approx(c - b**2 / (4 * a), **CLOSE)


def test_a_linkage_of_one_phase_joins_its_own_ends(push: Any) -> None:
    """The condition is not rest but a reversed speed, v(1) = -v(0): the parabola u = -2 costs 4 instead of 12."""
    phase = push.phase(1.0, {"x": 0, "v": 1}, {"x": 0})
    turn = rt.links.Linkage((0,), lambda step: step.end.x["v"] + step.start.x["v"])
    assert push.plan([phase], [turn]).objective == pytest.approx(4, **CLOSE)


def test_a_linkage_with_bounds_holds_the_nearer_one(push: Any) -> None:
    phases = [push.phase(1.0, [0, 0]), push.phase(1.0)]
    far = rt.links.Linkage((0, 1), lambda a, b: [b.end.x["x"], b.end.x["v"]], [2, 0], [3, 0], name="target")
    solution = push.plan(phases, [rt.Continuity(0, 1), far])
    assert solution.objective == pytest.approx(push.cost(2, 0, 2.0), **CLOSE)
    assert solution.at(2.0).x["x"] == pytest.approx(2, abs=1e-8)


def test_one_parameter_of_several_phases_is_a_compromise(push: Any) -> None:
    """(p - 1)^2 + (p - 3)^2 + (p - 8)^2 is least at the mean, 4: 9 + 1 + 16."""

    def phase(target: float) -> rt.Phase:
        wish = rt.Mayer(lambda start, end: (end.p["p"] - target) ** 2)
        return push.phase(1.0, [0, 0], [0, 0], objective=wish, parameters={"p": rt.between(-10, 10)})

    phases = [phase(target) for target in (1, 3, 8)]
    shared = push.plan(phases, [rt.links.SameParameter("p")])
    assert shared.objective == pytest.approx(26, **CLOSE)
    assert [part.parameters["p"] for part in shared.phases] == pytest.approx([4, 4, 4])
    two = push.plan(phases, [rt.links.SameParameter("p", (0, 2))])
    assert two.objective == pytest.approx(2 * 3.5**2, **CLOSE)
    assert [part.parameters["p"] for part in two.phases] == pytest.approx([4.5, 3, 4.5])


FORCED = rt.System(
    ["a", "b"],
    ["u"],
    lambda point: [
        -point.x["a"] + ca.cos(point.t) + point.u["u"],
        -point.x["b"] - ca.cos(point.t) - point.u["u"],
    ],
)
"""Without u both have one periodic motion, a = (cos t + sin t) / 2 = -b."""


def forced(duration: float, **more: Any) -> rt.Phase:
    return rt.Phase(FORCED, duration, objective=rt.Lagrange(lambda point: point.u["u"] ** 2), **more)


@pytest.mark.parametrize(
    ("turns", "link"),
    [
        (1.0, rt.Periodic()),
        (0.5, rt.Mirror(negated=["a", "b"])),
        (0.5, rt.Mirror({"a": "b"})),
    ],
    ids=["periodic", "negated", "partners"],
)
def test_the_motion_that_repeats_costs_nothing(turns: float, link: rt.links.Link) -> None:
    solution = rt.plan(
        rt.Problem([forced(turns * 2 * np.pi)], [link]), rt.Mesh(8, rt.schemes.GaussLegendre(6)), solver=rt.Ipopt(1e-11)
    )
    assert solution.objective == pytest.approx(0, abs=1e-12)
    times = np.linspace(0, turns * 2 * np.pi, 20)
    np.testing.assert_allclose(solution.at(times).x["a"], (np.cos(times) + np.sin(times)) / 2, atol=1e-8)
    np.testing.assert_allclose(solution.at(times).x["b"], -(np.cos(times) + np.sin(times)) / 2, atol=1e-8)


def test_a_period_over_two_phases_gains_its_displacement(push: Any) -> None:
    """To gain 2 m in 2 s and repeat the speed, keep the speed: no force."""
    phases = [push.phase(1.0, {"x": 0}), push.phase(1.0)]
    solution = push.plan(phases, [rt.Continuity(0, 1), rt.Periodic({"x": 2.0})])
    assert solution.objective == pytest.approx(0, abs=1e-12)
    assert solution.at(np.array([0.0, 1.0, 2.0])).x["x"] == pytest.approx([0, 1, 2], abs=1e-8)


def test_a_period_whose_gain_is_free_stands_still(push: Any) -> None:
    phase = push.phase(1.0, {"x": 0}, objective=rt.Lagrange(lambda point: point.u["u"] ** 2 + (point.x["v"] - 3) ** 2))
    solution = push.plan([phase], [rt.Periodic({"x": rt.between(0, 2)})])
    assert solution.at(1.0).x["x"] == pytest.approx(2, abs=1e-8)
    assert solution.objective == pytest.approx(1, **CLOSE)
    free = push.plan([phase], [rt.Periodic({"x": None})])
    assert free.at(1.0).x["x"] == pytest.approx(3, abs=1e-8)


def test_an_integral_is_held_and_bounds_that_are_met_do_not_cost() -> None:
    """A curve x' = u from 0 to 1 over the area A: with A = 1, x = 4 t - 3 t^2 and u^2 adds up to 4; free, 1."""
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])

    def cost(*bounds: float | None) -> float:
        area = rt.constraints.IntegralConstraint(lambda point: point.x["x"], *bounds, name="area", unit="m s")
        effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
        phase = rt.Phase(system, 1.0, rt.State([0]), rt.State([1]), effort, [area])
        return rt.plan(phase, rt.Mesh(5), solver=rt.Ipopt(1e-11)).objective

    assert cost(1.0, 1.0) == pytest.approx(4, **CLOSE)
    assert cost(1.0, None) == pytest.approx(4, **CLOSE)
    assert cost(0.0, 1.0) == pytest.approx(1, **CLOSE)
    assert cost(None, 0.0) == pytest.approx(1 + 12 * 0.5**2, **CLOSE)


def test_an_integral_holds_in_its_own_phase_alone(push: Any) -> None:
    """The first second may spend 1e-4, and so ends where it began at w = 0.005; the second pays for the rest."""
    spent, w = 1e-4, 0.005
    little = rt.constraints.IntegralConstraint(lambda point: point.u["u"] ** 2, upper=spent, name="energy")
    phases = [push.phase(1.0, [0, 0], {"x": 0}, constraints=[little]), push.phase(1.0, None, [1, 0])]
    solution = push.plan(phases, [rt.Continuity(0, 1)])
    assert solution.objective == pytest.approx(spent + push.cost(1 - w, -w), rel=1e-7)
    assert solution.phases[0].at(1.0).x["v"] == pytest.approx(w, abs=1e-7)


def test_time_is_continuous_where_no_link_sets_the_start_of_a_phase(push: Any) -> None:
    phases = [push.phase(1.0, [0, 0], [1, 0]), push.phase(1.0, [1, 0], [0, 0]), push.phase(0.5, [0, 0], [1, 0])]
    solution = push.plan(phases, [])
    assert [part.t0 for part in solution.phases] == pytest.approx([0, 1, 2], abs=1e-9)
    assert solution.duration == pytest.approx(2.5, abs=1e-9)
    assert solution.objective == pytest.approx(12 + 12 + 12 / 0.5**3, **CLOSE)
    assert np.all(np.isfinite(solution.at(np.linspace(0, 2.5, 2501)).x["x"]))
    assert "link time(1, 2)  continuity, time  = 0  s" in str(solution.problem)


@pytest.mark.parametrize(
    "link",
    [
        rt.links.EqualDuration(0, 1),
        rt.links.Linkage((0, 1), lambda a, b: (b.end.t - b.start.t) ** 2 - (a.end.t - a.start.t) ** 2),
        rt.links.Linkage((0, 1), lambda a, b: b.end.t - a.start.t, 3.0, 3.0),
        rt.links.Linkage((0, 1), lambda a, b: b.end.x["x"] - a.end.x["x"], 1.0, 1.0),
        rt.links.SameParameter("p"),
    ],
    ids=["equal duration", "durations", "total", "place", "parameter"],
)
def test_time_is_continuous_under_a_link_without_start_times(push: Any, link: rt.links.Link) -> None:
    known = {"parameters": {"p": rt.between(0, 1)}}
    phases = [push.phase((1.5, 3), [0, 0], [1, 0], **known), push.phase((1.5, 3), [1, 0], [2, 0], **known)]
    problem = rt.Problem(phases, [link])
    assert [bound.name for bound in problem.bound_links][1:] == ["time(0, 1)"]
    first, second = push.plan(phases, [link]).phases
    assert second.t0 == pytest.approx(first.duration, abs=1e-8)


def test_a_link_may_set_the_start_of_a_phase(push: Any) -> None:
    phases = [push.phase(1.0, [0, 0], [1, 0]), push.phase(1.0, [1, 0], [0, 0]), push.phase(1.0, [1, 0], [2, 0])]
    pause = rt.links.Linkage((0, 1), lambda a, b: b.start.t - a.end.t, 0.5, 0.5, name="pause")
    solution = push.plan(phases, [pause, rt.links.Jump(0, 2, {"x": None, "v": None})])
    assert len(solution.problem.bound_links) == 2
    assert [part.t0 for part in solution.phases] == pytest.approx([0, 1.5, 1], abs=1e-9)
