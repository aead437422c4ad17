"""Costates from the NLP's multipliers against closed forms, sensitivities and each other."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.dynamics.point import symbolic_model

TIGHT = rt.Ipopt(tolerance=1e-11)
LECTURE = rt.HermiteSimpson(control=rt.schemes.LinearControl(), quadrature=rt.schemes.TrapezoidalQuadrature())


def costates_at(solution: rt.Solution, t: Any) -> Any:
    sample = rt.indirect.costates(solution).at(t)
    return np.column_stack([sample.x["x"], sample.x["v"]])


@pytest.mark.parametrize(
    "mesh",
    [
        rt.Mesh(40, rt.HermiteSimpson()),
        rt.Mesh(12, rt.schemes.LobattoIIIA(points=4)),
        rt.Mesh(8, rt.schemes.FifthDegree()),
        rt.Mesh(1, rt.schemes.LobattoIIIA(points=12)),
        rt.Mesh(60, rt.schemes.RadauIIA(points=2)),
        rt.Mesh(16, rt.schemes.RadauIIA(points=3)),
        rt.Mesh(1, rt.schemes.RadauIIA(points=10)),
        rt.Mesh(40, rt.schemes.GaussLegendre(points=2)),
        rt.Mesh(10, rt.schemes.GaussLegendre(points=3)),
        rt.Mesh(1, rt.schemes.GaussLegendre(points=10)),
        rt.Mesh(20, rt.schemes.CompressedHermiteSimpson()),
        rt.Mesh(20, rt.schemes.MultipleShooting(rt.schemes.RungeKutta4(2), control=rt.schemes.LinearControl())),
        rt.Mesh(20, rt.schemes.SingleShooting(rt.schemes.RungeKutta4(2), control=rt.schemes.LinearControl())),
        rt.Mesh(
            [0, 0.1, 0.4, 0.6, 1],
            [rt.schemes.FifthDegree(), rt.schemes.RadauIIA(5), rt.schemes.GaussLegendre(4), rt.schemes.LobattoIIIA(6)],
        ),
    ],
    ids=str,
)
def test_kirks_costates_are_the_analytic_ones_everywhere(kirk: Any, mesh: rt.Mesh) -> None:
    solution = rt.plan(kirk.phase(), mesh, solver=TIGHT)
    t = np.linspace(0, 2, 301)
    assert costates_at(solution, t) == pytest.approx(kirk.costates(t), abs=1e-4)


@pytest.mark.parametrize(
    ("scheme", "order", "counts"),
    [
        (rt.schemes.Trapezoidal(), 2, (10, 20, 40)),
        (LECTURE, 2, (20, 40, 80)),
        (rt.HermiteSimpson(), 4, (8, 16, 32)),
        (rt.schemes.LobattoIIIA(points=4), 6, (3, 6, 12)),
        (rt.schemes.RadauIIA(points=1), 1, (80, 160, 320)),
        (rt.schemes.RadauIIA(points=2), 3, (8, 16, 32)),
        (rt.schemes.RadauIIA(points=3), 5, (4, 8, 16)),
        (rt.schemes.CompressedHermiteSimpson(), 4, (8, 16, 32)),
        (rt.schemes.MultipleShooting(), 2, (10, 20, 40)),
        (rt.schemes.SingleShooting(), 2, (10, 20, 40)),
        (rt.schemes.GaussLegendre(points=1), 2, (10, 20, 40)),
        (rt.schemes.GaussLegendre(points=2), 4, (8, 16, 32)),
    ],
    ids=str,
)
def test_costates_converge_at_the_knots_with_the_order_of_the_scheme(
    kirk: Any, scheme: Any, order: int, counts: tuple[int, ...]
) -> None:
    errors = []
    for count in counts:
        solution = rt.plan(kirk.phase(), rt.Mesh(count, scheme), solver=TIGHT)
        knots = solution.knots
        errors.append(np.max(np.abs(costates_at(solution, knots) - kirk.costates(knots))))
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert slopes == pytest.approx([order] * 2, abs=0.3)


@pytest.mark.parametrize("as_path", [False, True], ids=["bound", "path row"])
@pytest.mark.parametrize(
    "mesh",
    [
        rt.Mesh(30, rt.HermiteSimpson()),
        rt.Mesh(9, rt.schemes.LobattoIIIA(points=4)),
        rt.Mesh(9, rt.schemes.FifthDegree()),
        rt.Mesh(9, rt.schemes.RadauIIA(points=3)),
    ],
    ids=str,
)
def test_bryson_denhams_costates_jump_where_the_constraint_is_touched(
    bryson_denham: Any, mesh: rt.Mesh, as_path: bool
) -> None:
    solution = rt.plan(bryson_denham.phase(as_path=as_path), mesh, solver=TIGHT)
    t = np.linspace(0, 1, 400)
    exact = bryson_denham.costates(t)
    found = costates_at(solution, t)
    size = np.max(np.abs(exact), axis=0)
    assert found / size == pytest.approx(exact / size, abs=1e-4)


def test_gauss_sees_bryson_denhams_contact_too(bryson_denham: Any) -> None:
    solution = rt.plan(bryson_denham.phase(), rt.Mesh(9, rt.schemes.GaussLegendre(points=3)), solver=TIGHT)
    t = np.linspace(0, 1, 400)
    size = np.array([18.0, 6.0])
    assert costates_at(solution, t) / size == pytest.approx(bryson_denham.costates(t) / size, abs=1e-4)


def in_three_arcs(phase: rt.Phase, top: float) -> rt.Problem:
    """Entry, arc and exit as phases of free durations; the bound is met and left without speed (tangency)."""
    touching = rt.State([top, 0])
    parts = [
        replace(phase, duration=(0.05, 0.9), end=touching, name="entry"),
        replace(phase, duration=(0.05, 0.9), start=None, end=touching, name="arc"),
        replace(phase, duration=(0.05, 0.9), start=None, name="exit"),
    ]
    in_all = rt.links.Linkage([0, 2], lambda first, last: last.end.t - first.start.t, 1.0, 1.0, name="in all", unit="s")
    return rt.Problem(parts, [rt.Continuity(0, 1), rt.Continuity(1, 2), in_all])


@pytest.mark.parametrize("top", [1 / 9, 0.08, 0.13])
@pytest.mark.parametrize(
    "mesh",
    [
        rt.Mesh(1, rt.schemes.RadauIIA(points=3)),
        rt.Mesh(3, rt.schemes.RadauIIA(points=3)),
        rt.Mesh(2, rt.schemes.GaussLegendre(points=3)),
        rt.Mesh(4, rt.HermiteSimpson()),
    ],
    ids=str,
)
def test_bryson_denhams_costates_without_knowing_the_junctions(bryson_denham: Any, mesh: rt.Mesh, top: float) -> None:
    """The plan finds the junctions to 1e-6 s, and both costates in the whole second."""
    problem = in_three_arcs(bryson_denham.phase(top=top), top)
    solution = rt.plan(problem, mesh, solver=rt.Ipopt(tolerance=1e-12))
    bryson_denham.assert_three_arcs(solution, top)


def test_refinement_alone_finds_bryson_denhams_costates_but_for_the_intervals_of_the_jumps(bryson_denham: Any) -> None:
    """The junctions fall inside intervals, which are halved until the objective has settled: 0.01 s are left."""
    solution = rt.plan(bryson_denham.phase(), tolerance=1e-6, solver=TIGHT)
    t = np.linspace(0, 1, 2001)
    t = t[np.minimum(np.abs(t - 1 / 3), np.abs(t - 2 / 3)) > 1e-2]
    size = np.array([18.0, 6.0])
    assert costates_at(solution, t) / size == pytest.approx(bryson_denham.costates(t) / size, abs=1e-4)


def sensitivity(phase: Any, mesh: rt.Mesh, start: Any, i: int, step: float, **given: Any) -> float:
    """dJ/dx0_i by central differences of solved problems."""
    costs = []
    for sign in (1, -1):
        moved = np.array(start, dtype=float)
        moved[i] += sign * step
        costs.append(rt.plan(phase(moved), mesh, solver=TIGHT, **given).objective)
    return (costs[0] - costs[1]) / (2 * step)


STEPPED = [rt.schemes.CompressedHermiteSimpson(), rt.schemes.MultipleShooting(), rt.schemes.SingleShooting()]
SCHEMES = [
    rt.schemes.Trapezoidal(),
    rt.HermiteSimpson(),
    rt.schemes.FifthDegree(),
    rt.schemes.RadauIIA(points=3),
    rt.schemes.GaussLegendre(points=2),
]


@pytest.mark.parametrize("scheme", [*SCHEMES, LECTURE, *STEPPED], ids=str)
@pytest.mark.parametrize("i", [0, 1])
def test_initial_costate_is_the_sensitivity_of_the_discrete_optimum(kirk: Any, scheme: Any, i: int) -> None:
    mesh = rt.Mesh(10, scheme)
    initial = rt.indirect.costates(rt.plan(kirk.phase(), mesh, solver=TIGHT)).phases[0].initial
    assert initial[i] == pytest.approx(sensitivity(kirk.phase, mesh, [0.0, 0.0], i, 1e-3), rel=1e-6)


def test_initial_costate_of_a_bang_bang_motion_of_free_duration(block: Any) -> None:
    # T(x0, v0) = -v0 + 2 sqrt(v0^2 / 2 + 10 - x0): dT/dx0 = -1 / sqrt(10), dT/dv0 = -1.
    initial = rt.indirect.costates(rt.plan(block(), rt.Mesh(20), solver=TIGHT)).phases[0].initial
    assert initial == pytest.approx([-1 / np.sqrt(10), -1.0], rel=1e-6)


@pytest.mark.parametrize("i", [0, 1])
def test_initial_costate_of_a_bang_bang_motion_whose_switch_is_smeared(block: Any, i: int) -> None:
    mesh = rt.Mesh(21, rt.schemes.RadauIIA(points=3))
    initial = rt.indirect.costates(rt.plan(block(), mesh, solver=TIGHT)).phases[0].initial
    assert initial[i] == pytest.approx(sensitivity(block, mesh, [0.0, 0.0], i, 1e-3), rel=1e-4)


@pytest.mark.parametrize("i", [0, 1])
@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
def test_initial_costate_of_a_robot_by_inverse_dynamics(swing_up: Any, scheme: Any, i: int) -> None:
    mesh = rt.Mesh(20, scheme)
    initial = rt.indirect.costates(rt.plan(swing_up(), mesh, solver=TIGHT)).phases[0].initial
    assert initial[i] == pytest.approx(sensitivity(swing_up, mesh, [0.0, 0.0], i, 1e-4), rel=1e-5)


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
def test_inverse_and_forward_dynamics_have_the_same_costates(swing_up: Any, scheme: Any) -> None:
    mesh, t = rt.Mesh(30, scheme), np.linspace(0, 2, 31)
    inverse, forward = (
        rt.indirect.costates(rt.plan(swing_up(dynamics=dynamics), mesh, solver=TIGHT)).phases[0].duals.costate(t)
        for dynamics in (rt.dynamics.InverseDynamics(), rt.dynamics.ForwardDynamics())
    )
    assert inverse == pytest.approx(forward, rel=1e-6, abs=1e-5)


def test_multipliers_of_the_torque_balance_are_those_of_virtual_work(swing_up: Any) -> None:
    # Stationarity in the accelerations: lambda_v + M nu = 0.
    solution = rt.plan(swing_up(), rt.Mesh(40, rt.schemes.GaussLegendre(points=3)), solver=TIGHT)
    part = rt.indirect.costates(solution).phases[0]
    mass = symbolic_model(solution.phases[0].phase.robot).mass_matrix
    for t in solution.phases[0].points[1:-1:7]:
        sample = part.at(t)
        nu = np.array([sample.z[name] for name in sample.z])
        by_v = np.array([sample.x[name] for name in sample.x])[2:]
        balance = by_v + np.array(mass(solution.at(t).q)) @ nu
        assert balance == pytest.approx([0, 0], abs=2e-2)


def test_initial_costate_of_a_dae_with_an_end_cost(algebraic: Any) -> None:
    mesh = rt.Mesh(10)
    part = rt.indirect.costates(rt.plan(algebraic(), mesh, solver=TIGHT)).phases[0]
    costs = [rt.plan(algebraic(1.0 + h), mesh, solver=TIGHT).objective for h in (1e-4, -1e-4)]
    assert part.initial[0] == pytest.approx((costs[0] - costs[1]) / 2e-4, rel=1e-6)
    end = part.solution.trajectory.x(1.0)[0]
    assert part.final[0] == pytest.approx(10 * (end - 2), rel=1e-8)


def test_added_rows_between_collocation_points_change_the_costates_too(bryson_denham: Any) -> None:
    # On 4 intervals of two Gauss points the bound is violated between them, where rows are added.
    mesh = rt.Mesh(5, rt.schemes.GaussLegendre(points=2))
    solution = rt.plan(bryson_denham.phase(), mesh, solver=TIGHT)
    part = rt.indirect.costates(solution).phases[0]
    assert solution.added_rows and len(part.duals.costate.breaks) > len(solution.knots)
    # The perturbed problems start from this solution and keep its rows: rows at other times have another optimum.
    slope = sensitivity(bryson_denham.phase, mesh, [0.0, 1.0], 1, 1e-5, guess=solution)
    assert part.initial[1] == pytest.approx(slope, rel=1e-6)


def test_the_hamiltonian_of_an_autonomous_motion_is_constant_and_minus_one_in_minimum_time(block: Any) -> None:
    solution = rt.plan(block(), rt.Mesh(20), solver=TIGHT)
    t = np.linspace(0, solution.duration, 50)
    # Only in the two intervals beside the switch is the control not at its bound.
    t = t[np.abs(t - solution.duration / 2) > solution.duration / 19]
    assert rt.indirect.costates(solution).at(t).hamiltonian == pytest.approx(-np.ones(len(t)), abs=1e-6)


def test_costates_run_on_across_phases_that_are_linked(kirk: Any) -> None:
    system = kirk.phase().subject
    first = rt.Phase(system, 0.8, rt.State([0, 0]), None, rt.Lagrange(lambda point: 0.5 * point.u["u"] ** 2))
    second = rt.Phase(system, 1.2, None, rt.State([5, 2]), rt.Lagrange(lambda point: 0.5 * point.u["u"] ** 2))
    solution = rt.plan(
        rt.Problem([first, second], [rt.Continuity(0, 1)]), rt.Mesh(8, rt.schemes.FifthDegree()), solver=TIGHT
    )
    parts = rt.indirect.costates(solution).phases
    assert parts[0].final == pytest.approx(parts[1].initial, rel=1e-8)
    for part in parts:
        t = part.solution.knots
        assert part.duals.costate(t) == pytest.approx(kirk.costates(t), abs=1e-5)
    assert rt.indirect.costates(solution).at(1.5).x["x"] == pytest.approx(
        kirk.costates(np.array([1.5]))[0, 0], abs=1e-5
    )


def test_costates_are_saved_with_a_solution(kirk: Any, tmp_path: Any) -> None:
    solution = rt.plan(kirk.phase(), rt.Mesh(10))
    again = rt.load_solution(solution.save(tmp_path / "kirk.npz"), kirk.phase())
    t = np.linspace(0, 2, 11)
    assert np.array_equal(costates_at(again, t), costates_at(solution, t))


def test_a_motion_that_was_not_found_has_no_costates(kirk: Any) -> None:
    failed = rt.plan(kirk.phase(), rt.Mesh(10), solver=rt.Ipopt(max_iterations=1), check=False)
    assert not failed.success
    with pytest.raises(rt.InputError, match="no costates"):
        rt.indirect.costates(failed)


def test_times_outside_the_motion_and_unknown_states_are_refused(kirk: Any) -> None:
    costates = rt.indirect.costates(rt.plan(kirk.phase(), rt.Mesh(10)))
    with pytest.raises(rt.InputError, match="from 0 s to 2 s"):
        costates.at(2.5)
    with pytest.raises(rt.UnknownName, match="speed"):
        _ = costates.at(1.0).x["speed"]
