"""The hybrid method: direct solutions polished to 1e-9 by Pontryagin's conditions."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj.dynamics.point import symbolic_model
from robotraj.indirect.arcs import Arc, Side
from robotraj.indirect.boundary import end_data
from robotraj.indirect.polishing import _solve
from robotraj.indirect.pontryagin import Pontryagin

HALF = np.sqrt(10.0)


@pytest.mark.parametrize(
    "mesh",
    [
        rt.Mesh(20),
        rt.Mesh(21),
        rt.Mesh(15, rt.schemes.Trapezoidal()),
        rt.Mesh(20, rt.schemes.RadauIIA(3)),
        rt.Mesh(7, rt.schemes.GaussLegendre(3)),
        rt.Mesh(21, rt.schemes.MultipleShooting()),
        rt.Mesh(21, rt.schemes.SingleShooting()),
    ],
    ids=str,
)
def test_the_block_switches_half_way(block: Any, mesh: rt.Mesh) -> None:
    polished = rt.indirect.polish(rt.plan(block(), mesh))
    assert polished.success
    assert polished.switching_times["u"] == pytest.approx([HALF], abs=1e-9)
    assert polished.duration == pytest.approx(2 * HALF, abs=1e-9)
    assert polished.objective == pytest.approx(2 * HALF, abs=1e-9)
    assert [arc.sides for arc in polished.arcs] == [(Side.UPPER,), (Side.LOWER,)]
    assert polished.at([1.0, 5.0]).u["u"] == pytest.approx([1.0, -1.0])
    assert polished.at([1.0, 5.0]).hamiltonian == pytest.approx([-1.0, -1.0], abs=1e-9)
    assert "u at its upper bound" in str(polished)


def test_the_block_as_a_robot() -> None:
    phase = rt.Phase(rt.load("block"), (0.1, 20), rt.State(q=0, v=0), rt.State(q=1.6, v=0), rt.Duration())
    polished = rt.indirect.polish(rt.plan(phase, rt.Mesh(15)))
    assert polished.duration == pytest.approx(2 * np.sqrt(1.6), abs=1e-9)
    assert polished.at(polished.duration).q == pytest.approx([1.6], abs=1e-9)


def test_kirk_to_round_off(kirk: Any) -> None:
    polished = rt.indirect.polish(rt.plan(kirk.phase(), rt.Mesh(10)))
    t = np.linspace(0, 2, 101)
    exact, sample = kirk.costates(t), polished.at(t)
    assert np.column_stack([sample.costate["x"], sample.costate["v"]]) == pytest.approx(exact, abs=1e-9)
    assert sample.u["u"] == pytest.approx(-exact[:, 1], abs=1e-9)
    # J = int lambda_v^2 / 2 in closed form.
    c2, d = exact[0, 0], exact[0, 1] - exact[0, 0]
    cost = 0.5 * (2 * c2**2 + 2 * c2 * d * (np.exp(2) - 1) + 0.5 * d**2 * (np.exp(4) - 1))
    assert polished.objective == pytest.approx(cost, abs=1e-9)


def arrives(polished: Any, rates: Any, start: Any) -> Any:
    """End of a forward simulation under the polished controls, restarted nowhere but at switching times."""
    x = np.array(start, dtype=float)
    for k, arc in enumerate(polished.arcs):
        result = solve_ivp(
            lambda t, x, k=k: rates(t, x, polished.on_arc(k, np.array([t]))[1][0]),
            (arc.start, arc.end),
            x,
            method="DOP853",
            rtol=1e-12,
            atol=1e-12,
        )
        x = result.y[:, -1]
    return x


def robot_rates(robot: rt.Robot) -> Any:
    nv, forward = robot.nv, symbolic_model(robot).forward_dynamics

    def rates(t: float, x: Any, u: Any) -> Any:
        a = forward(x[:nv], x[nv:], robot.actuation @ u, np.zeros((6, robot.model.njoints)))
        return np.concatenate([x[nv:], np.array(a).ravel()])

    return rates


@pytest.mark.slow
@pytest.mark.parametrize("force", [20.0, 12.0, 10.0])
def test_swing_up_with_and_without_saturation(swing_up: Any, force: float) -> None:
    solution = rt.plan(swing_up(force=force), rt.Mesh(50))
    polished = rt.indirect.polish(solution)
    assert polished.error <= 1e-9
    assert len(polished.arcs) == {20.0: 1, 12.0: 3, 10.0: 5}[force]
    end = arrives(polished, robot_rates(polished.equations.phase.robot), [0, 0, 0, 0])
    assert end == pytest.approx([1, np.pi, 0, 0], abs=1e-7)
    assert polished.objective == pytest.approx(solution.objective, rel=1e-4)
    if force == 20.0:
        assert polished.objective == pytest.approx(58.8076675, abs=1e-6)


@pytest.mark.slow
def test_an_arm_of_six_joints_is_polished() -> None:
    robot = rt.load("ur5")
    first, last = [0, -1.2, 1.0, 0, 0, 0], [1.0, -1.6, 1.4, 0.3, 0.5, 0]
    # In 2 s, without limits, there are many optima near each other, and rounding chooses between them.
    phase = rt.Phase(robot, 1.0, rt.State(q=first, v=0), rt.State(q=last, v=0), rt.Effort(), limits=None)
    solution = rt.plan(phase, rt.Mesh(60), solver=rt.Ipopt())
    polished = rt.indirect.polish(solution)
    assert max(polished.error, polished.residual) <= 1e-9
    assert polished.objective == pytest.approx(solution.objective, rel=1e-5)
    end = arrives(polished, robot_rates(robot), [*first, *[0] * 6])
    assert end == pytest.approx([*last, *[0] * 6], abs=1e-5)


@pytest.mark.slow
def test_the_costate_is_the_derivative_of_a_polished_cost(swing_up: Any) -> None:
    costs = [rt.indirect.polish(rt.plan(swing_up((h, 0.0)), rt.Mesh(40))) for h in (1e-3, 0.0, -1e-3)]
    slope = (costs[0].objective - costs[2].objective) / 2e-3
    assert costs[1].at(0.0).costate["q.slider"] == pytest.approx(slope, rel=1e-5)


def two_link_arm() -> rt.System:
    def rates(point: Any) -> list[Any]:
        x1, x2, x3 = point.x["x1"], point.x["x2"], point.x["x3"]
        u1, u2 = point.u["u1"], point.u["u2"]
        s, c = ca.sin(x3), ca.cos(x3)
        below = 31 / 36 + 9 / 4 * s**2
        first = (s * (9 / 4 * c * x1**2 + 2 * x2**2) + 4 / 3 * (u1 - u2) - 3 / 2 * c * u2) / below
        second = -(s * (7 / 2 * x1**2 + 9 / 4 * c * x2**2) - 7 / 3 * u2 + 3 / 2 * c * (u1 - u2)) / below
        return [first, second, x2 - x1, x1]

    return rt.System(["x1", "x2", "x3", "x4"], ["u1", "u2"], rates)


def test_two_link_arm_in_minimum_time_as_a_system_and_as_a_robot() -> None:
    # Bang-bang arcs integrated to 1e-12 elsewhere: T = 2.98227994, switches 1.49114 and 0.94314, 2.62755.
    system = rt.Phase(
        two_link_arm(),
        (1, 10),
        rt.State([0, 0, 0.5, 0]),
        rt.State([0, 0, 0.5, 0.522]),
        rt.Duration(),
        controls={"u1": rt.between(-1, 1), "u2": rt.between(-1, 1)},
    )
    robot = rt.Phase(
        rt.load("two_link_arm"), (0.3, 6), rt.State(q=[0, 0.5], v=0), rt.State(q=[0.522, 0.5], v=0), rt.Duration()
    )
    found = [rt.indirect.polish(rt.plan(phase, rt.Mesh(60), rt.guess.StraightLine(3.0))) for phase in (system, robot)]
    for polished in found:
        assert polished.duration == pytest.approx(2.98227994, abs=5e-9)
        first, second = polished.switching_times.values()
        assert first == pytest.approx([1.49114], abs=5e-6)
        assert second == pytest.approx([0.94314, 2.62755], abs=5e-6)
        assert polished.residual < 1e-12
    assert found[0].duration == pytest.approx(found[1].duration, abs=1e-9)


def test_end_cost_and_free_end_of_a_dae(algebraic: Any) -> None:
    polished = rt.indirect.polish(rt.plan(algebraic(), rt.Mesh(10)))
    end = polished.at(1.0)
    assert end.costate["x"] == pytest.approx(10 * (end.x["x"] - 2), abs=1e-9)

    # xdot = w - x with w + 0.1 w^3 = u
    def rates(t: float, x: Any, u: Any) -> Any:
        w = np.real([r for r in np.roots([0.1, 0, 1, -u[0]]) if abs(r.imag) < 1e-9][0])
        return [w - x[0]]

    assert arrives(polished, rates, [1.0]) == pytest.approx([end.x["x"]], abs=1e-9)


def test_end_constraints_on_the_pose_of_a_robot() -> None:
    arm = rt.load("two_link_arm")
    goal = np.array([1.7, 0.95])
    tip = rt.PathConstraint(lambda p: [p.frame("tip").position[i] for i in (0, 1)], goal, goal, "tip")
    phase = rt.Phase(arm, 2.0, rt.State(q=[0.3, 0.2], v=0), rt.State(v=0), rt.Effort(), constraints=[rt.AtEnd(tip)])
    solution = rt.plan(phase, rt.Mesh(40))
    polished = rt.indirect.polish(solution)
    q = polished.at(2.0).q
    reached = np.array(symbolic_model(arm).frame_placement("tip")(q)[0]).ravel()[:2]
    assert reached == pytest.approx(goal, abs=1e-9)
    assert polished.objective == pytest.approx(solution.objective, rel=1e-6)


def test_free_duration_explicit_time_and_a_fixed_parameter() -> None:
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.p["k"] * p.u["u"] - ca.sin(3 * p.t)])
    phase = rt.Phase(
        system,
        (0.5, 4),
        rt.State([0, 0]),
        rt.State([2, None]),
        parameters={"k": 2.0},
        objective=rt.Lagrange(lambda p: p.u["u"] ** 2) + rt.Duration(),
    )
    polished = rt.indirect.polish(rt.plan(phase, rt.Mesh(30)))

    def cost(duration: float) -> float:
        fixed = rt.Phase(
            system,
            duration,
            rt.State([0, 0]),
            rt.State([2, None]),
            parameters={"k": 2.0},
            objective=rt.Lagrange(lambda p: p.u["u"] ** 2),
        )
        return rt.indirect.polish(rt.plan(fixed, rt.Mesh(30))).objective + duration

    best = polished.duration
    assert cost(best) == pytest.approx(polished.objective, abs=1e-9)
    # A minimum: the first derivative is zero, and the second one positive.
    step = 1e-3
    after, before = cost(best + step), cost(best - step)
    assert after - before == pytest.approx(0.0, abs=1e-7)
    assert min(after, before) > polished.objective


def test_a_motion_without_controls() -> None:
    # x0 is free within bounds, J = x(1)^2 decreases with it: x0 is at its lower bound.
    system = rt.System(["x"], [], lambda p: [-p.x["x"]])
    cost = rt.Mayer(lambda a, b: b.x["x"] ** 2)
    polished = rt.indirect.polish(
        rt.plan(rt.Phase(system, 1.0, rt.State([rt.between(0.5, 2)]), objective=cost), rt.Mesh(5))
    )
    assert polished.objective == pytest.approx(0.25 * np.exp(-2), abs=1e-9)
    assert polished.at(0.0).costate["x"] == pytest.approx(np.exp(-2), abs=1e-9)


@pytest.mark.slow
def test_hyper_sensitive_motions_are_no_trouble() -> None:
    system = rt.System(["x"], ["u"], lambda p: [-(p.x["x"] ** 3) + p.u["u"]])
    cost = rt.Lagrange(lambda p: 0.5 * (p.x["x"] ** 2 + p.u["u"] ** 2))
    polished = rt.indirect.polish(rt.plan(rt.Phase(system, 50.0, rt.State([1.5]), rt.State([1.0]), cost), rt.Mesh(80)))
    assert polished.objective == pytest.approx(1.33080691, abs=1e-8)


def singular() -> rt.Solution:
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    phase = rt.Phase(
        system,
        (2, 8),
        rt.State([2, 0]),
        rt.State([5, 0]),
        rt.Lagrange(lambda p: 0.5 * (1 + p.x["v"] ** 2)),
        controls={"u": rt.between(-1, 1)},
    )
    return rt.plan(phase, rt.Mesh(40, rt.schemes.RadauIIA(2)), rt.guess.StraightLine(4.0))


def test_a_singular_arc_is_refused() -> None:
    with pytest.raises(rt.InputError, match="'u' enters the Hamiltonian linearly.*singular arc"):
        rt.indirect.polish(singular())


@pytest.mark.parametrize(("as_path", "name"), [(False, "state bound, x"), (True, "path constraint")])
def test_an_active_state_constraint_is_refused_by_name(bryson_denham: Any, as_path: bool, name: str) -> None:
    solution = rt.plan(bryson_denham.phase(as_path=as_path), rt.Mesh(30))
    with pytest.raises(rt.InputError, match=f"{name} is active at t = 0.33"):
        rt.indirect.polish(solution)


def test_several_phases_and_unknown_parameters_are_refused(kirk: Any) -> None:
    system = kirk.phase().subject
    cost = rt.Lagrange(lambda p: p.u["u"] ** 2)
    two = rt.Problem(
        [rt.Phase(system, 1.0, rt.State([0, 0]), None, cost), rt.Phase(system, 1.0, None, rt.State([5, 2]), cost)],
        [rt.Continuity(0, 1)],
    )
    with pytest.raises(rt.InputError, match="one phase; this one has 2"):
        rt.indirect.polish(rt.plan(two, rt.Mesh(5)))
    free = rt.System(["x"], ["u"], lambda p: [p.p["k"] * p.u["u"]])
    phase = rt.Phase(free, 1.0, rt.State([0]), rt.State([1]), cost, parameters={"k": rt.between(1, 2)})
    with pytest.raises(rt.InputError, match="'k' is unknown; fix it"):
        rt.indirect.polish(rt.plan(phase, rt.Mesh(5)))
    with pytest.raises(rt.InputError, match="above 0"):
        rt.indirect.polish(rt.plan(kirk.phase(), rt.Mesh(5)), tolerance=-1.0)


def test_the_swing_up_to_1e_9(swing_up: Any) -> None:
    polished = rt.indirect.polish(rt.plan(swing_up(), rt.Mesh(40)), tolerance=1e-9)
    assert max(polished.error, polished.residual) <= 1e-9
    assert polished.objective == pytest.approx(58.8076674582, abs=1e-9)


def test_a_tolerance_out_of_reach_is_not_claimed(swing_up: Any) -> None:
    with pytest.raises(rt.indirect.PolishFailed, match="not polished") as caught:
        rt.indirect.polish(rt.plan(swing_up(), rt.Mesh(40)), tolerance=1e-17)
    last = caught.value.solution
    assert not last.success
    assert last.trouble
    assert last.objective == pytest.approx(58.8076675, rel=1e-3)


def test_a_sequence_of_arcs_that_is_no_optimum_is_not_claimed(block: Any) -> None:
    # Braking before accelerating: no costates make that an extremal.
    solution = rt.plan(block(), rt.Mesh(20))
    costates = rt.indirect.costates(solution).phases[0]
    equations = Pontryagin(solution.phases[0].phase, np.zeros(0), np.array([[-1.0], [1.0]]))
    ends = end_data(equations, np.array([0.0, 0.0]), np.array([10.0, 0.0]), solution.duration)
    half = solution.duration / 2
    swapped = [Arc(0.0, half, (Side.LOWER,)), Arc(half, 2 * half, (Side.UPPER,))]
    found = _solve(equations, costates, swapped, ends, 1e-9)
    assert not found.success


@pytest.mark.parametrize("force", [20.0, 12.0])
def test_a_polished_plan_is_a_solution_that_the_witness_proves(swing_up: Any, force: float, tmp_path: Any) -> None:
    polished = rt.indirect.polish(rt.plan(swing_up(force=force), rt.Mesh(40)))
    solution = polished.solution()
    assert solution.success
    assert solution.objective == polished.objective
    t = np.linspace(0, 2, 41)
    assert solution.at(t).q == pytest.approx(polished.at(t).q, abs=1e-12)
    assert solution.at(t).tau == pytest.approx(polished.at(t).tau, abs=1e-5)
    report = rt.validate(solution)
    assert report.passed, str(report)
    again = rt.load_solution(solution.save(tmp_path / "polished.npz"))
    assert np.array_equal(again.at(t).q, solution.at(t).q)
    # The direct method agrees on a fine mesh of high order with knots where the arcs meet.
    direct = rt.plan(swing_up(force=force), rt.Mesh(polished.knots / 2.0, rt.schemes.LobattoIIIA(5)), guess=solution)
    assert direct.objective == pytest.approx(polished.objective, rel=1e-6)


def test_times_outside_the_motion_are_refused(kirk: Any) -> None:
    polished = rt.indirect.polish(rt.plan(kirk.phase(), rt.Mesh(10)))
    with pytest.raises(rt.InputError, match="0 s to 2 s"):
        polished.at(3.0)
