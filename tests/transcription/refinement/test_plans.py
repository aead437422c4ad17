"""plan(tolerance=...): meshes are refined until the error is below the tolerance; else the plan reports it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj.planning.loop import to_tolerance
from robotraj.transcription.refinement.base import Assessment, Refinement
from robotraj.transcription.refinement.error import interval_errors

PENDULUM = rt.System(["q", "w"], ["u"], lambda point: [point.x["w"], point.u["u"] - 9.81 * ca.sin(point.x["q"])])


def swing_up(**more: Any) -> rt.Phase:
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    return rt.Phase(PENDULUM, 1.5, rt.State([0, 0]), rt.State([np.pi, 0]), effort, **more)


@pytest.fixture(scope="module")
def optimum() -> float:
    return rt.plan(swing_up(), rt.Mesh(30, rt.schemes.GaussLegendre(6)), solver=rt.Ipopt(1e-11)).objective


@pytest.mark.parametrize(
    "refinement",
    [rt.refinement.SplitAndMerge(), rt.refinement.RaiseOrder(), rt.refinement.SplitOrRaise()],
    ids=lambda r: type(r).__name__,
)
@pytest.mark.parametrize(
    "scheme",
    [rt.schemes.Trapezoidal(), rt.HermiteSimpson(), rt.schemes.RadauIIA(3), rt.schemes.GaussLegendre(2)],
    ids=lambda s: type(s).__name__,
)
def test_every_refinement_of_every_family_reaches_the_tolerance(
    optimum: float, refinement: Refinement, scheme: Any
) -> None:
    solution = rt.plan(swing_up(), rt.Mesh(6, scheme), tolerance=1e-4, refinement=refinement)
    part = solution.phases[0]
    assert solution.success
    assert interval_errors(part.phase, part.trajectory).max() <= 1e-4
    assert solution.objective == pytest.approx(optimum, rel=1e-4)
    assert {type(s) for s in part.mesh.schemes} <= {type(scheme), rt.schemes.LobattoIIIA}


def test_a_tighter_tolerance_is_a_smaller_error(optimum: float) -> None:
    errors = [
        abs(rt.plan(swing_up(), tolerance=t, solver=rt.Ipopt(1e-11)).objective / optimum - 1)
        for t in (1e-3, 1e-5, 1e-8)
    ]
    assert errors[0] < 1e-3 and errors[1] < 1e-5 and errors[2] < 1e-8


def test_the_meshes_are_listed_one_by_one() -> None:
    solution = rt.plan(swing_up(), rt.Mesh(5, rt.schemes.RadauIIA(3)), tolerance=1e-6)
    steps = solution.refinement
    assert steps[0].intervals == 5 and steps[0].points == 15
    assert steps[0].error > 1e-6 >= steps[-1].error
    assert steps[-1].objective == solution.objective
    assert abs(steps[-1].objective - steps[-2].objective) <= 0.5e-6 * solution.objective
    assert steps[-1].points == len(solution.phases[0].points)
    printed = str(solution)
    for i, step in enumerate(steps, 1):
        assert f"mesh {i}: {step.intervals} intervals, {step.points} points, error {step.error:.2e}" in printed


def test_each_mesh_starts_from_the_last() -> None:
    steps = rt.plan(swing_up(), tolerance=1e-7).refinement
    assert len(steps) >= 2
    assert all(step.iterations < steps[0].iterations for step in steps[1:])


@dataclass(frozen=True)
class Stubborn(Refinement):
    """Leaves every mesh as it is."""

    def refine(self, mesh: rt.Mesh, assessment: Assessment, tolerance: float) -> rt.Mesh:
        return mesh


def test_a_tolerance_that_is_not_reached_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(to_tolerance, "MOST_MESHES", 4)
    given = {"mesh": rt.Mesh(5, rt.schemes.RadauIIA(3)), "tolerance": 1e-9, "refinement": Stubborn()}
    solution = rt.plan(swing_up(), check=False, **given)
    assert solution.status is rt.solvers.Status.TOLERANCE_NOT_REACHED
    assert not solution.success
    assert len(solution.refinement) == 4 and solution.refinement[-1].error > 1e-9
    assert "tolerance not reached" in str(solution)
    with pytest.raises(rt.NoSolutionFound, match="tolerance not reached") as caught:
        rt.plan(swing_up(), **given)
    assert caught.value.solution.refinement[-1].error == solution.refinement[-1].error


def test_a_solve_that_fails_ends_the_refinement() -> None:
    short = swing_up(controls={"u": rt.between(-0.1, 0.1)})
    solution = rt.plan(short, tolerance=1e-6, check=False)
    assert not solution.success
    assert solution.status is not rt.solvers.Status.TOLERANCE_NOT_REACHED
    assert len(solution.refinement) == 1


@pytest.mark.parametrize("tolerance", [0, 1, -1e-6, np.nan])
def test_tolerances_that_make_no_sense(tolerance: float) -> None:
    with pytest.raises(rt.InputError, match="between 0 and 1"):
        rt.plan(swing_up(), tolerance=tolerance)


STEPPED: dict[Any, float] = {
    rt.schemes.CompressedHermiteSimpson(): 1e-6,
    rt.schemes.MultipleShooting(): 1e-4,
    rt.schemes.MultipleShooting(rt.schemes.RungeKutta4(1), control=rt.schemes.LinearControl()): 1e-6,
    rt.schemes.MultipleShooting(rt.schemes.Adaptive(), control=rt.schemes.LinearControl()): 1e-5,
    rt.schemes.SingleShooting(rt.schemes.RungeKutta4(2), control=rt.schemes.LinearControl()): 1e-6,
}
"""Tolerances that take less than 200 intervals."""


@pytest.mark.parametrize(("scheme", "tolerance"), STEPPED.items(), ids=str)
def test_schemes_that_step_from_knot_to_knot_reach_the_tolerance_by_splitting(
    optimum: float, scheme: Any, tolerance: float
) -> None:
    """The motion errs by no more than the tolerance from the exact one, and the objective from its optimum."""
    solution = rt.plan(swing_up(), rt.Mesh(6, scheme), tolerance=tolerance, solver=rt.Ipopt(1e-10))
    part = solution.phases[0]
    assert set(part.mesh.schemes) == {scheme}
    assert solution.error is not None and solution.error <= tolerance
    assert local_errors(part) <= 1.25 * tolerance
    assert solution.objective == pytest.approx(optimum, rel=tolerance)
    assert solution.refinement[-1].intervals < 200


def local_errors(part: rt.solution.PhaseSolution) -> float:
    """Largest distance of an interval's motion from SciPy's from the same start under the same control; relative."""
    worst, curve = 0.0, part.trajectory.x
    size = 1 + np.max([np.abs(v).max(axis=0) for c in (curve, curve.derivative()) for v in c.values], axis=0)
    for k, span in enumerate(zip(part.knots[:-1], part.knots[1:], strict=True)):

        def rates(t: float, x: Any, k: int = k) -> Any:
            return [x[1], part.trajectory.u(t, k)[0] - 9.81 * np.sin(x[0])]

        times = np.linspace(*span, 9)
        true = solve_ivp(rates, span, curve(span[0], k), "DOP853", times, rtol=1e-12, atol=1e-13).y.T
        worst = max(worst, float(np.max(np.abs(curve(times, k) - true) / size)))
    return worst


def test_an_integrator_that_is_too_coarse_for_the_tolerance_is_tightened(optimum: float) -> None:
    scheme = rt.schemes.MultipleShooting(rt.schemes.Adaptive(1e-3), control=rt.schemes.LinearControl())
    solution = rt.plan(swing_up(), rt.Mesh(6, scheme), tolerance=1e-5)
    (used,) = {
        s.integrator.tolerance for s in solution.phases[0].mesh.schemes if isinstance(s, rt.schemes.MultipleShooting)
    }
    assert used == pytest.approx(1e-7)
    assert local_errors(solution.phases[0]) <= 1e-5
    assert solution.objective == pytest.approx(optimum, rel=1e-5)


def test_constants_do_not_pass_for_settled_where_only_the_integration_is_accurate(optimum: float) -> None:
    """Four Runge-Kutta steps hold 1e-4 on 12 intervals, whose constants cost percents of the objective."""
    first = rt.plan(swing_up(), rt.Mesh(12, rt.schemes.MultipleShooting()))
    assert first.error is not None and first.error < 1e-4
    assert first.objective > 1.005 * optimum
    last = rt.plan(swing_up(), rt.Mesh(12, rt.schemes.MultipleShooting()), tolerance=1e-4)
    assert last.objective == pytest.approx(optimum, rel=1e-4)


@pytest.mark.parametrize("scheme", STEPPED, ids=str)
def test_an_order_that_a_scheme_does_not_have_is_not_raised(scheme: Any) -> None:
    with pytest.raises(rt.InputError, match=rf"{type(scheme).__name__} has no collocation points.*SplitAndMerge"):
        rt.plan(swing_up(), rt.Mesh(5, scheme), tolerance=1e-6, refinement=rt.refinement.RaiseOrder())


def test_phases_of_shooting_and_of_collocation_are_refined_each_in_its_own_way() -> None:
    """A block brought to rest by constants, then a swing from there by Radau."""
    block = rt.System(["q", "w"], ["u"], lambda point: [point.x["w"], point.u["u"]])
    limits = {"controls": {"u": rt.between(-2, 1)}}
    fast = rt.Phase(block, (0.1, 20), rt.State([-10, 0]), rt.State([0, 0]), rt.Duration(), **limits)
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    up = rt.Phase(PENDULUM, 1.5, None, rt.State([np.pi, 0]), effort)
    meshes = [rt.Mesh(10, rt.schemes.MultipleShooting(rt.schemes.RungeKutta4(1))), rt.Mesh(6, rt.schemes.RadauIIA(3))]
    solution = rt.plan(rt.Problem([fast, up], [rt.Continuity(0, 1)]), meshes, tolerance=1e-5)
    alone = rt.plan(swing_up(), tolerance=1e-8)
    assert solution.objective == pytest.approx(np.sqrt(30) + alone.objective, rel=1e-5)
    assert {type(s) for s in solution.phases[0].mesh.schemes} == {rt.schemes.MultipleShooting}
    assert {type(s) for s in solution.phases[1].mesh.schemes} == {rt.schemes.RadauIIA}


def test_a_robot_is_refined_by_shooting() -> None:
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0)
    phase = rt.Phase(rt.load("cartpole"), 2.0, *ends, rt.Effort())
    shot = rt.plan(phase, rt.Mesh(20, rt.schemes.MultipleShooting(control=rt.schemes.LinearControl())), tolerance=1e-5)
    assert shot.objective == pytest.approx(rt.plan(phase, tolerance=1e-8).objective, rel=1e-5)


def test_more_intervals_than_help_are_not_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(to_tolerance, "MOST_INTERVALS", 40)
    solution = rt.plan(swing_up(), rt.Mesh(10, rt.schemes.MultipleShooting()), tolerance=1e-8, check=False)
    assert solution.status is rt.solvers.Status.TOLERANCE_NOT_REACHED
    assert solution.refinement[-1].intervals <= 40


def limited(limit: float = 1 / 9) -> rt.Phase:
    """Bryson and Denham's block, which touches its limit along an arc."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    effort = rt.Lagrange(lambda point: 0.5 * point.u["u"] ** 2)
    return rt.Phase(block, 1.0, rt.State([0, 1]), rt.State([0, -1]), effort, states={"x": rt.between(None, limit)})


def s_curve() -> rt.Phase:
    """4 m in least time under limits of speed, acceleration and jerk: 2.6 s."""
    states = {"x": rt.between(0, 4), "v": rt.between(-2, 2), "a": rt.between(-4, 4)}
    carriage = rt.System(["x", "v", "a"], ["j"], lambda point: [point.x["v"], point.x["a"], point.u["j"]])
    limits = {"states": states, "controls": {"j": rt.between(-40, 40)}}
    return rt.Phase(carriage, (0.1, 10), rt.State([0, 0, 0]), rt.State([4, 0, 0]), rt.Duration(), **limits)


def test_rows_are_held_between_the_knots() -> None:
    """No sample between the points lies above the limit."""
    solution = rt.plan(limited(), tolerance=1e-6)
    assert solution.objective == pytest.approx(4, rel=1e-6)
    assert solution.at(np.linspace(0, 1, 5001)).x["x"].max() <= 1 / 9 + 1e-6
    free = rt.plan(limited(), rt.Mesh(6, rt.schemes.RadauIIA(3)))
    assert free.at(np.linspace(0, 1, 5001)).x["x"].max() <= 1 / 9 + 1e-3


@pytest.mark.parametrize("solver", [rt.InteriorPoint(fallback=None), rt.Ipopt()], ids=lambda s: type(s).__name__)
def test_rows_are_held_between_the_knots_once_a_mesh_is_fine_enough_or_no_better(
    solver: rt.InteriorPoint | rt.Ipopt, monkeypatch: pytest.MonkeyPatch
) -> None:
    solved: list[rt.Solution] = []

    def watched(*arguments: Any) -> rt.Solution:
        solved.append(limited(*arguments))
        return solved[-1]

    limited = to_tolerance.limited_between
    monkeypatch.setattr(to_tolerance, "limited_between", watched)
    solution = rt.plan(s_curve(), tolerance=1e-6, solver=solver)
    held = [bool(each.added_rows) for each in solved]
    assert not held[0] and held[-1]
    assert held == sorted(held), "held from one mesh on"
    errors = [step.error for step in solution.refinement[: held.index(True)]]
    assert errors == sorted(errors, reverse=True), "every mesh before it is better than the last"
    assert not solution.interval_violations
    assert solution.objective == pytest.approx(2.6, rel=1e-6)


@pytest.mark.parametrize("most", ["MOST_MESHES", "MOST_INTERVALS"])
def test_rows_are_held_between_the_knots_where_the_tolerance_is_not_reached(
    most: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(to_tolerance, most, {"MOST_MESHES": 2, "MOST_INTERVALS": 60}[most])
    solution = rt.plan(s_curve(), tolerance=1e-6, check=False)
    assert solution.status is rt.solvers.Status.TOLERANCE_NOT_REACHED
    assert solution.added_rows and not solution.interval_violations
    assert [step.intervals for step in solution.refinement] == [20, solution.phases[0].mesh.count]


@pytest.mark.parametrize("solver", [rt.InteriorPoint(fallback=None), rt.Ipopt()], ids=lambda s: type(s).__name__)
def test_added_rows_are_kept_on_the_intervals_that_a_mesh_keeps(solver: rt.InteriorPoint | rt.Ipopt) -> None:
    phase, scheme = s_curve(), rt.schemes.RadauIIA(3)
    before = rt.plan(
        phase, rt.Mesh(12, scheme), solver=solver, interval_limits=rt.interval_limits.ConstraintGeneration(1e-5)
    )
    first = min(each.interval for each in before.added_rows)
    assert first < 11
    knots = np.linspace(0, 1, 13)
    # The last interval is cut, and another one before the first added row: its interval's number grows by one.
    cuts = [0.5 * knots[1], 0.5 * (knots[-2] + 1)] if first > 0 else [0.5 * (knots[-2] + 1)]
    mesh = rt.Mesh(tuple(sorted([*knots, *cuts])), scheme)
    # No row is violated by 100: no further row is added.
    alone = rt.interval_limits.ConstraintGeneration(100)
    after = rt.plan(phase, mesh, before, solver, interval_limits=alone, check=False)
    kept = [each for each in before.added_rows if each.interval not in ({0, 11} if first > 0 else {11})]
    moved = [each.interval + (first > 0) for each in kept]
    assert kept and [each.interval for each in after.added_rows] == moved
    assert [(each.row, each.tau) for each in after.added_rows] == [(each.row, each.tau) for each in kept]
    assert after.success and not rt.plan(phase, mesh, solver=solver, interval_limits=alone).added_rows


@pytest.mark.parametrize(
    "scheme",
    [
        rt.schemes.RadauIIA(3, control=rt.schemes.ConstantControl()),
        rt.HermiteSimpson(control=rt.schemes.ConstantControl()),
        rt.schemes.Trapezoidal(control=rt.schemes.ConstantControl()),
        rt.schemes.GaussLegendre(3, control=rt.schemes.ConstantControl()),
    ],
    ids=str,
)
@pytest.mark.parametrize("refinement", [None, rt.refinement.SplitAndMerge()], ids=str)
def test_controls_that_are_too_coarse_for_the_optimum_are_cut(scheme: Any, refinement: Any) -> None:
    # The dynamics hold exactly on any mesh; the least effort is 6, on ten intervals 6.06.
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    effort = rt.Lagrange(lambda point: 0.5 * point.u["u"] ** 2)
    phase = rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([1, 0]), effort)
    solution = rt.plan(phase, rt.Mesh(10, scheme), tolerance=1e-4, refinement=refinement)
    assert solution.objective == pytest.approx(6.0, rel=1e-4)
    assert solution.refinement[0].objective > 6.05


@pytest.mark.parametrize("refinement", [None, rt.refinement.SplitAndMerge(), rt.refinement.RaiseOrder()], ids=str)
@pytest.mark.parametrize(
    "scheme",
    [rt.schemes.Trapezoidal(), rt.HermiteSimpson(), rt.schemes.RadauIIA(3), rt.schemes.GaussLegendre(2)],
    ids=lambda s: type(s).__name__,
)
def test_an_objective_settles_on_a_finer_mesh_alone(scheme: Any, refinement: Any) -> None:
    # Any control leaves no residual; the least integral of exp(t) u^2 that gains 1 is 1 / (1 - exp(-1)).
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    cost = rt.Lagrange(lambda point: ca.exp(point.t) * point.u["u"] ** 2)
    phase = rt.Phase(system, 1.0, rt.State([0]), rt.State([1]), cost)
    solution = rt.plan(phase, rt.Mesh(8, scheme), tolerance=1e-6, refinement=refinement)
    assert solution.objective == pytest.approx(1 / (1 - np.exp(-1)), rel=1e-6)
    points = [step.points for step in solution.refinement]
    assert points == sorted(set(points))


@pytest.mark.parametrize("tolerance", [1e-4, 1e-5, 1e-6])
@pytest.mark.parametrize(
    "scheme", [rt.schemes.RadauIIA(5), rt.schemes.GaussLegendre(4)], ids=lambda s: type(s).__name__
)
def test_the_cost_of_bernstein_bounds_vanishes_with_the_mesh(scheme: Any, tolerance: float) -> None:
    # u = clip(c (1 - 2 t), -5, 5), with c from the integral of (1 - t) u, which is 1: scipy.optimize.brentq.
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    limits = {"u": rt.between(-5, 5)}
    phase = rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([1, 0]), effort, controls=limits)
    solution = rt.plan(phase, rt.Mesh(6, scheme), tolerance=tolerance)
    assert solution.objective == pytest.approx(12.090055512642, rel=tolerance)


def test_controls_within_limits_everywhere_once_refined() -> None:
    # Fuller's problem: ever shorter arcs of full force, between which polynomials would bulge.
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    cost = rt.Lagrange(lambda point: point.x["x"] ** 2)
    limits = {"u": rt.between(-1, 1)}
    phase = rt.Phase(block, 4.0, rt.State([1, 0]), rt.State([0, 0]), cost, controls=limits)
    solution = rt.plan(phase, tolerance=1e-6)
    assert solution.objective == pytest.approx(0.764017, abs=2e-6)
    report = rt.validate(solution)
    assert report.passed, str(report)


def test_intervals_are_split_where_a_path_row_is_violated_while_the_excess_falls() -> None:
    """A thrust of fixed size that turns fast: on the mesh of small errors its square is 0.7 percent above its limit."""
    rates = lambda p: [  # noqa: E731
        p.x["u"],
        p.x["v"] ** 2 / p.x["r"] - 1 / p.x["r"] ** 2 + 0.1405 / (1 - 0.0749 * p.t) * p.u["up"],
        -p.x["u"] * p.x["v"] / p.x["r"] + 0.1405 / (1 - 0.0749 * p.t) * p.u["ahead"],
    ]
    craft = rt.System(["r", "u", "v"], ["up", "ahead"], rates)
    size = rt.PathConstraint(lambda p: p.u["up"] ** 2 + p.u["ahead"] ** 2, upper=1, name="thrust")
    circular = rt.AtEnd(rt.PathConstraint(lambda p: p.x["v"] ** 2 * p.x["r"], 1, 1, name="circular"))
    start, end = rt.State([1, 0, 1]), rt.State({"u": 0})
    radius = rt.Mayer(lambda start, end: -end.x["r"])
    limits = {"r": rt.between(0.5, 3), "u": rt.between(-2, 2), "v": rt.between(0.1, 2)}
    phase = rt.Phase(craft, 3.32, start, end, radius, [size, circular], states=limits)
    guess = rt.Guess([0, 3.32], states=[[1, 0, 1], [1.5, 0, 0.8]])
    solution = rt.plan(phase, guess=guess, tolerance=1e-6)
    assert solution.objective == pytest.approx(-1.5252777, rel=1e-6)
    report = rt.validate(solution)
    assert report.passed, str(report)


def test_an_excess_that_does_not_fall_is_left_to_the_report() -> None:
    """A force in least time, limited by a path row; the polynomial of the interval of the switch exceeds it."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    load = rt.PathConstraint(lambda point: point.u["u"] * (1 + 0.1 * point.x["v"]), -1, 1, name="load")
    phase = rt.Phase(block, (0.1, 20.0), rt.State([0, 0]), rt.State([10, 0.3]), rt.Duration(), constraints=[load])
    solution = rt.plan(phase, tolerance=1e-6)
    assert solution.success and len(solution.refinement) <= 8
    assert "between collocation points: load" in " ".join(str(solution).split())


def test_refinement_stops_where_meshes_come_no_closer_to_the_tolerance(monkeypatch: pytest.MonkeyPatch) -> None:
    errors = [1e-2, 1e-3, 1e-3, 9e-4, 9e-4, 9e-4]
    stagnates = to_tolerance.stagnates
    assert stagnates(errors) and not stagnates([*errors, 1e-4]) and not stagnates(errors[:5])
    assert not stagnates([1.0, 0.5, 0.25, 0.12, 0.06, 0.03, 0.015])
    # A swing without an objective, by whatever motion: the next mesh was fine enough.
    assert not stagnates([1e-3, 9e-6, 4e-8, 1.2e-8, 4e-8, 4e-8, 1e-7, 2e-8])
    meshes: dict[int, float] = {}
    assess = to_tolerance.assess

    def same(*arguments: Any) -> Assessment:
        found = assess(*arguments)
        error = meshes.setdefault(len(found.errors), errors[min(len(meshes), len(errors) - 1)])
        return replace(found, errors=np.full(len(found.errors), error))

    monkeypatch.setattr(to_tolerance, "assess", same)
    solution = rt.plan(swing_up(), rt.Mesh(5, rt.HermiteSimpson()), tolerance=1e-6, check=False)
    # On the third mesh, four times as fine as the second, controls become lines. Four meshes of lines come no closer.
    assert solution.status is rt.solvers.Status.TOLERANCE_NOT_REACHED
    assert len(solution.refinement) == 3 + 1 + to_tolerance.PATIENCE


def test_a_small_objective_is_as_accurate_as_a_large_one() -> None:
    """The last barrier leaves a nanounit of the objective at every active bound, more than the tolerance of 0.015.

    A mass is moved by 1 m in 3 s with the least impulse: burn for a, coast, burn for a, where a (3 - a) = 1.
    """
    slider = rt.System(["x", "v"], ["ahead", "back"], lambda point: [point.x["v"], point.u["ahead"] - point.u["back"]])
    solution = rt.plan(
        rt.Phase(
            slider,
            duration=3.0,
            start=rt.State([0, 0]),
            end=rt.State([1, 0]),
            objective=0.02 * rt.Lagrange(lambda point: point.u["ahead"] + point.u["back"]),
            controls={"ahead": rt.between(0, 1), "back": rt.between(0, 1)},
        ),
        tolerance=1e-6,
        solver=rt.Ipopt(),
    )
    assert solution.objective == pytest.approx(0.02 * (3 - np.sqrt(5)), rel=1e-6)


def test_the_users_complementarity_is_kept() -> None:
    plain = rt.Ipopt(tolerance=1e-7)
    assert plain.with_smaller_gap(0.1).options == {"compl_inf_tol": pytest.approx(1e-8)}
    assert plain.with_smaller_gap(1e-9) == plain.with_smaller_gap(1e-10)
    own = rt.Ipopt(options={"compl_inf_tol": 1e-5})
    assert own.with_smaller_gap(0.1) is own


def test_a_solver_with_a_smaller_gap_that_fails_is_not_called_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The plan is the one of the solver as it was given."""

    def with_smaller_gap(self: rt.Ipopt, factor: float) -> rt.Ipopt:
        return replace(self, options={"max_iter": 0, "compl_inf_tol": factor * self.tolerance})

    monkeypatch.setattr(rt.Ipopt, "with_smaller_gap", with_smaller_gap)
    monkeypatch.setattr(to_tolerance, "duality_gap", lambda solution: 1.0)
    solution = rt.plan(swing_up(), tolerance=1e-6, solver=rt.Ipopt())
    assert solution.success and solution.refinement[-1].error <= 1e-6
    assert sum(each.iterations == 0 for each in solution.history) == 1
