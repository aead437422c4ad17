"""One solve on one mesh: limits between the collocation points, and data of an earlier solution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh.between import limits_between
from robotraj.planning.loop import to_tolerance

RADAU = rt.Mesh(5, rt.schemes.RadauIIA(3))


def block() -> rt.System:
    return rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])


def turning(*constraints: Any) -> rt.Phase:
    """Return a motion there and back in a second."""
    ends = rt.State([0, 1.0]), rt.State([0, -1.0])
    return rt.Phase(block(), 1.0, *ends, rt.Effort(), constraints=list(constraints))


def below(bound: float) -> rt.PathConstraint:
    return rt.PathConstraint(lambda p: p.x["x"], upper=bound)


@pytest.mark.parametrize(
    "other",
    [
        lambda: rt.AtEnd(rt.PathConstraint(lambda p: p.x["x"] + 0.1 * p.x["v"], upper=0.1)),
        lambda: rt.constraints.IntegralConstraint(lambda p: p.x["x"], upper=0.2, name="path constraint"),
        lambda: rt.PathConstraint(lambda p: p.u["u"], lower=-100, upper=100),
    ],
    ids=["at the end", "integral", "of a control"],
)
def test_rows_of_the_same_name_that_hold_elsewhere_are_not_added(other: Callable[[], Any]) -> None:
    known = rt.plan(turning(below(0.1)), RADAU, interval_limits=rt.interval_limits.ConstraintGeneration(1e-5))
    assert known.added_rows
    warm, cold = (rt.plan(turning(other()), RADAU, guess=guess) for guess in (known, None))
    assert warm.objective == pytest.approx(cold.objective, rel=1e-6)
    assert not warm.added_rows


def test_without_rounds_no_row_of_the_guess_is_imposed() -> None:
    known = rt.plan(turning(below(0.1)), RADAU, interval_limits=rt.interval_limits.ConstraintGeneration(1e-5))
    assert known.added_rows
    for problem in (known.problem, turning(below(0.1))):
        warm, cold = (
            rt.plan(problem, RADAU, guess=g, interval_limits=rt.interval_limits.ConstraintGeneration(rounds=0))
            for g in (known, None)
        )
        assert not warm.added_rows
        assert warm.objective == pytest.approx(cold.objective, rel=1e-8)
        assert warm.interval_violations[0].amount == pytest.approx(cold.interval_violations[0].amount, rel=1e-6)


def on_a_circle() -> rt.Phase:
    point = rt.System(["x", "y", "vx", "vy"], ["a", "b"], lambda p: [p.x["vx"], p.x["vy"], p.u["a"], p.u["b"]])
    circle = rt.PathConstraint(lambda p: p.x["x"] ** 2 + p.x["y"] ** 2, lower=1, upper=1, name="circle")
    ends = rt.State({"x": 1, "y": 0}), rt.State({"x": 0, "y": 1})
    return rt.Phase(point, 1.0, *ends, rt.Effort(), constraints=[circle])


@pytest.mark.parametrize("scheme", [rt.schemes.Trapezoidal(), rt.schemes.RadauIIA(3)], ids=["trapezoidal", "radau"])
@pytest.mark.parametrize("count", [1, 2])
def test_equations_between_the_points_do_not_take_a_solution_away(scheme: Any, count: int) -> None:
    mesh = rt.Mesh(count, scheme)
    assert rt.plan(
        on_a_circle(), mesh, interval_limits=rt.interval_limits.ConstraintGeneration(rounds=0), check=False
    ).success
    assert rt.plan(
        on_a_circle(), mesh, interval_limits=rt.interval_limits.ConstraintGeneration(1e-6), check=False
    ).success


def test_a_failed_solve_with_further_rows_leaves_the_solution_without(monkeypatch: pytest.MonkeyPatch) -> None:
    once = limits_between.solve_nlp

    def failing(nlp: Any, guess: Any, *arguments: Any) -> Any:
        solution, w = once(nlp, guess, *arguments)
        if isinstance(guess, rt.Solution):
            object.__setattr__(solution, "status", rt.solvers.Status.INFEASIBLE)
        return solution, w

    monkeypatch.setattr(limits_between, "solve_nlp", failing)
    solution = rt.plan(turning(below(0.1)), RADAU, check=False)
    assert solution.success and not solution.added_rows
    assert solution.interval_violations[0].amount > 5e-4


def test_the_first_knot_of_radau_is_looked_at() -> None:
    free = rt.Mayer(lambda start, end: -start.x["x"]) + 1e-3 * rt.Effort()
    phase = rt.Phase(
        block(), 1.0, None, rt.State([-1, 0]), free, states={"v": rt.between(-5, 5)}, constraints=[below(0.1)]
    )
    open_ended = rt.plan(phase, RADAU, interval_limits=rt.interval_limits.ConstraintGeneration(rounds=0))
    assert open_ended.at(0.0).x["x"] > 0.102
    assert open_ended.interval_violations[0].time == 0.0
    assert rt.plan(phase, RADAU).at(0.0).x["x"] <= 0.1 + 5e-4


@pytest.mark.slow
def test_peaks_between_the_sampled_places_are_found() -> None:
    """A motion at the limits of all joints on 17 intervals, whose speeds fall off by twice their limits in some."""
    panda = rt.load("panda")
    start, end = [0.5, -0.5, 0.3, -1.2, 0.5, 1.0, -0.5], [-0.9, 0.6, -0.8, -0.6, -0.9, 1.4, 1.0]
    phase = rt.Phase(panda, 1.5, rt.State(q=start, v=0), rt.State(q=end, v=0), rt.Effort())
    solution = rt.plan(phase, rt.Mesh(17), solver=rt.Ipopt())
    assert not solution.interval_violations
    fast = np.abs(solution.at(np.linspace(0, 1.5, 40001)).v) - panda.limits.velocity
    assert fast.max() <= 5e-4


def hurried() -> rt.Phase:
    start, end = rt.State(q=[-1.1, -1.8, 1.6, -1.2, -1.57, 0], v=0), rt.State(q=[1.1, -0.8, 0.6, -0.6, -0.6, 1.2], v=0)
    return rt.Phase(rt.load("ur5"), (0.3, 3), start, end, rt.Duration())


def largest_share_of_effort(solution: rt.Solution) -> float:
    (part,) = solution.phases
    assert part.robot is not None
    tau = solution.at(np.linspace(0, solution.duration, 20001)).tau
    assert tau is not None
    return float(np.max(np.abs(tau) / part.robot.limits.effort))


def test_torques_that_exceed_their_limits_between_points_are_reported_and_bounded_on_request() -> None:
    bulging = rt.plan(hurried(), rt.Mesh(20))
    share = largest_share_of_effort(bulging)
    assert share > 1.05
    worst = bulging.control_interval_violations[0]
    assert worst.name.startswith("effort limit")
    assert "controls=True" in str(bulging)
    held = rt.plan(hurried())
    assert not held.control_interval_violations
    assert largest_share_of_effort(held) <= 1 + 1e-3


def largest_acceleration(solution: rt.Solution) -> float:
    """Between the points, to the left and the right of every knot."""
    (part,) = solution.phases
    tau = np.linspace(0, 1, 101)
    knots = enumerate(zip(part.knots[:-1], part.knots[1:], strict=True))
    every = (part.at(first + (last - first) * tau, interval=k).a for k, (first, last) in knots)
    return max(float(np.abs(a).max()) for a in every)


def test_accelerations_that_exceed_their_limits_between_points_are_reported_and_bounded_with_torques() -> None:
    phase = hurried()
    phase = phase.with_(objective=rt.Duration() + 1e-4 * rt.Effort(), limits=phase.limits.with_(acceleration=6.0))
    for scheme in (rt.HermiteSimpson(), rt.schemes.RadauIIA(3)):
        bulging = rt.plan(phase, rt.Mesh(15, scheme))
        assert largest_acceleration(bulging) > 6.6
        assert bulging.control_interval_violations[0].name.startswith("acceleration limit")
        assert bulging.control_interval_violations[0].amount == pytest.approx(
            largest_acceleration(bulging) - 6.0, rel=0.1
        )
        assert "acceleration limit" in str(bulging)
        held = rt.plan(phase, rt.Mesh(15, scheme), interval_limits=rt.interval_limits.BernsteinBounds(controls=True))
        assert not held.control_interval_violations
        assert largest_acceleration(held) <= 6.0 + 1e-5
        assert bulging.objective < held.objective < 1.01 * bulging.objective
    assert largest_acceleration(rt.plan(phase, tolerance=1e-3)) <= 6.0 + 1e-5


@pytest.mark.parametrize(
    "scheme",
    [
        rt.schemes.MultipleShooting(control=rt.schemes.LinearControl()),
        rt.schemes.SingleShooting(control=rt.schemes.LinearControl()),
        rt.schemes.CompressedHermiteSimpson(),
        rt.schemes.Trapezoidal(),
        rt.schemes.GaussLegendre(2),
    ],
    ids=["multiple shooting", "single shooting", "compressed", "trapezoidal", "Gauss"],
)
@pytest.mark.parametrize("kind", ["acceleration", "power"])
def test_rows_of_forward_dynamics_that_are_broken_between_the_points_are_reported(
    scheme: rt.schemes.Scheme, kind: str
) -> None:
    """Accelerations and powers depend on controls, and are imposed at points alone: nobody said what they reach."""
    limit = 3.5 if kind == "acceleration" else 2.5
    row = (
        rt.constraints.JointAcceleration(rt.between(-limit, limit))
        if kind == "acceleration"
        else rt.PathConstraint(lambda point: point.tau[0] * point.v[0], -limit, limit, name="power", unit="W")
    )
    objective = rt.Effort() + 20 * rt.Duration()
    ends = rt.State(q=0, v=0), rt.State(q=2.2, v=0)
    phase = rt.Phase(rt.load("pendulum"), (0.5, 3.5), *ends, objective, [row], dynamics=rt.dynamics.ForwardDynamics())
    solution = rt.plan(phase, rt.Mesh(8, scheme))
    sample = solution.at(np.linspace(1e-9, solution.duration - 1e-9, 4001))
    reached = np.abs(sample.a if kind == "acceleration" else sample.tau * sample.v).max()
    listed = [violation for violation in solution.control_interval_violations if violation.name.startswith(kind)]
    assert listed or reached < limit * 1.001
    if kind == "power":
        assert reached > limit * 1.05
        assert listed[0].amount == pytest.approx(reached - limit, rel=0.05)


def test_torques_of_refined_plans_are_held_between_the_points() -> None:
    solution = rt.plan(hurried(), tolerance=1e-3)
    assert largest_share_of_effort(solution) <= 1 + 1e-3
    assert not solution.control_interval_violations
    assert solution.objective == pytest.approx(0.72573, rel=3e-4)


@pytest.mark.slow
def test_a_refined_effort_is_that_of_the_limits_themselves() -> None:
    """Bernstein bounds of the speeds would cost 4e-6 more."""
    phase = hurried().with_(duration=1.0, objective=rt.Effort())
    assert rt.plan(phase, tolerance=1e-6).objective == pytest.approx(1071.8077, rel=1e-6)


def test_an_interrupted_last_solve_of_a_refinement_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    states = {"x": rt.between(0, 4), "v": rt.between(-2, 2), "a": rt.between(-4, 4)}
    carriage = rt.System(["x", "v", "a"], ["j"], lambda p: [p.x["v"], p.x["a"], p.u["j"]])
    limits = {"states": states, "controls": {"j": rt.between(-40, 40)}}
    phase = rt.Phase(carriage, (0.1, 10), rt.State([0, 0, 0]), rt.State([4, 0, 0]), rt.Duration(), **limits)
    once = to_tolerance.limited_between

    def interrupted(*arguments: Any) -> rt.Solution:
        solution = once(*arguments)
        return replace(solution, status=rt.solvers.Status.INTERRUPTED) if arguments[3] else solution

    monkeypatch.setattr(to_tolerance, "limited_between", interrupted)
    monkeypatch.setattr(to_tolerance, "MOST_MESHES", 2)
    assert rt.plan(phase, tolerance=1e-6, check=False).status is rt.solvers.Status.INTERRUPTED
