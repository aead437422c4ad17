"""Restarts of feasible problems whose first solve fails: durations guessed too short, and poor guesses."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.fixed_mesh import posed
from robotraj.fixed_mesh.at_points import solved_once
from robotraj.fixed_mesh.restarts import restarted
from robotraj.fixed_mesh.solve import solve
from robotraj.planning.settings import resolve
from robotraj.problem.problem import Problem
from robotraj.solvers.status import Status

FORCE = {"u": rt.between(-1, 1)}


def oscillator(start: float, duration: Any = (0.1, 40.0), **changes: Any) -> rt.Phase:
    """x'' = -x + u, to rest in least time."""
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], -point.x["x"] + point.u["u"]])
    return rt.Phase(system, duration, rt.State([start, 0]), rt.State([0, 0]), rt.Duration(), controls=FORCE, **changes)


@pytest.mark.parametrize("halves", [1, 2, 3, 4])
@pytest.mark.parametrize("solver", [rt.InteriorPoint(), rt.Ipopt()], ids=["interior point", "ipopt"])
def test_the_bang_bang_oscillator(halves: int, solver: rt.solvers.Solver) -> None:
    # From 2 m, m a whole number, half circles about -1 and 1 return to the origin in m pi seconds.
    solution = rt.plan(oscillator(2.0 * halves), rt.Mesh(), solver=solver)
    assert solution.duration == pytest.approx(halves * np.pi, rel=1e-2)


def test_a_restarted_plan_is_refined_to_the_tolerance() -> None:
    solution = rt.plan(oscillator(5.0), tolerance=1e-6)
    # scipy.optimize.fsolve of the switching times.
    assert solution.duration == pytest.approx(7.93741, abs=1e-5)
    assert rt.validate(solution).passed


def triple_integrator() -> rt.Phase:
    states = ["a", "b", "c"]
    system = rt.System(states, ["u"], lambda point: [point.x["b"], point.x["c"], point.u["u"]])
    start, end = rt.State([5, 1, -1]), rt.State([0, 0, 0])
    return rt.Phase(system, (0.1, 50), start, end, rt.Duration(), controls=FORCE)


def test_the_triple_integrator() -> None:
    solution = rt.plan(triple_integrator(), rt.Mesh())
    assert solution.duration == pytest.approx(5.540681, abs=1e-4)
    assert "the guess was too short" in solution.history.start


def test_what_it_took_is_counted() -> None:
    solution = rt.plan(oscillator(5.0), rt.Mesh())
    again = rt.plan(solution.problem, rt.Mesh(), guess=solution)
    assert solution.history.start.startswith("motion of") and not again.history.start
    assert solution.iterations > 3 * again.iterations


def test_a_plan_on_several_meshes_names_the_start_that_led_to_it() -> None:
    solution = rt.plan(triple_integrator(), solver=rt.Ipopt())
    assert solution.proof is not None and solution.proof.holds
    assert len(solution.refinement) > 1 and "the guess was too short" in solution.history.start


def test_an_earlier_solution_from_which_the_solver_fails_is_replaced() -> None:
    near = rt.plan(oscillator(2.0), rt.Mesh())
    far = rt.plan(near.problem.with_(start=rt.State([5, 0])), rt.Mesh(), guess=near)
    assert far.duration == pytest.approx(7.93741, abs=5e-3)


def test_phases_are_given_more_time_together() -> None:
    there = oscillator(5.0, (0.1, 20.0), name="there").with_(end=rt.State({"v": 0}))
    home = oscillator(0.0, (0.1, 20.0), name="home").with_(start=rt.State())
    solution = rt.plan(rt.Problem([there, home], [rt.Continuity(0, 1)]), rt.Mesh(20))
    assert solution.duration == pytest.approx(7.93741, rel=2e-2)


def test_what_is_infeasible_stays_so() -> None:
    solution = rt.plan(too_far(), check=False)
    assert solution.status is Status.INFEASIBLE and solution.violations


@pytest.mark.parametrize("seconds", [0.5, 6.0, 9.0])
def test_guesses_of_the_user_get_more_time_too(seconds: float) -> None:
    own = rt.guess.Keyframes([0, 1], [rt.State([5, 0]), rt.State([0, 0])], duration=seconds)
    solution = rt.plan(oscillator(5.0), guess=own)
    assert solution.duration == pytest.approx(7.93741, rel=1e-2)


def test_a_guess_that_fails_on_two_meshes_does_not_make_a_problem_infeasible() -> None:
    # Bounds of controls on whole intervals leave less than the exact 2 pi seconds need: from here both are stuck.
    own = rt.guess.Keyframes([0, 1], [rt.State([4, 0]), rt.State([0, 0])], duration=6.0)
    solution = rt.plan(oscillator(4.0, (4.0, 20.0)), guess=own)
    assert solution.duration == pytest.approx(2 * np.pi, rel=1e-2) and solution.history.start.startswith("motion of")


def test_more_equations_than_unknowns_are_called_so() -> None:
    decay = rt.System(["x"], [], lambda point: [-point.x["x"]])
    phase = rt.Phase(decay, 1.0, rt.State([1]), rt.State([0.5]))
    assert rt.plan(phase, check=False).status is Status.OVERDETERMINED
    assert rt.plan(phase.with_(end=None)).success


def too_far() -> rt.Phase:
    """10 m at 1 m/s^2 take 6.3 s, not 3."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    return rt.Phase(block, (0.1, 3.0), rt.State([0, 0]), rt.State([10, 0]), rt.Duration(), controls=FORCE)


def test_what_was_tried_in_vain_is_counted() -> None:
    problem = Problem([too_far()])
    given = {"mesh": rt.Mesh(), "solver": rt.Ipopt(), "restarts": rt.planning.Restarts(0)}
    solution = rt.plan(too_far(), rt.Mesh(), solver=rt.Ipopt(), check=False)
    once = solve(problem, None, resolve(problem, given))
    assert solution.status is once.status is Status.INFEASIBLE
    # Relaxed motions of three and nine times 0.55 s, no longer than 3 s, and of two variations.
    assert solution.iterations > 2 * once.iterations
    assert solution.conflicts[0].name == "control bound, u"
    np.testing.assert_array_equal(solution.phases[0].trajectory.x.breaks, once.phases[0].trajectory.x.breaks)


def test_a_guess_that_was_long_enough_is_not_called_short() -> None:
    solution = rt.plan(oscillator(5.0), rt.Mesh(), guess=rt.guess.StraightLine(30.0))
    assert solution.duration < 8.0 and solution.history.start == "motion of 40 s: the guess did not converge"


def test_motions_that_a_fixed_duration_makes_impossible_are_passed_over() -> None:
    # The least duration of 1 rad at 1 rad/s is 1 s: 3, 9 and 27 times 0.02 s are too short.
    robot = rt.load("pendulum")
    never = rt.PathConstraint(lambda point: point.tau[0] ** 2, upper=-1.0, name="never")
    limits = robot.limits.with_(velocity=1.0)
    ends = rt.State(q=0, v=0), rt.State(q=1, v=0)
    phase = rt.Phase(robot, (0.01, 5.0), *ends, rt.Duration(), constraints=[never], limits=limits)
    solution = rt.plan(phase, rt.Mesh(5), guess=rt.guess.StraightLine(0.02), check=False)
    assert not solution.success and "never" in str(solution.violations(1)[0])


def test_a_longer_motion_that_conflicts_is_shortened() -> None:
    """Fuel lasts for 3 s. Three times the guessed 2 s need more, which does not exclude shorter motions."""
    system = rt.System(["x", "v", "fuel"], ["u"], lambda p: [p.x["v"], p.u["u"], -1.0])
    ends = rt.State([0, 0, 3]), rt.State({"x": 1, "v": 0})
    fuel = {"fuel": rt.between(0, 3)}
    phase = rt.Phase(system, (0.1, 40.0), *ends, rt.Duration(), controls=FORCE, states=fuel)
    problem = Problem([phase])
    settings = resolve(problem, {"mesh": rt.Mesh(10), "restarts": rt.planning.Restarts(0)})
    guess = rt.guess.StraightLine(duration=2.0)
    once = replace(settings, solver=rt.InteriorPoint(max_iterations=1, fallback=None))
    failed = solved_once(problem, guess, once).changed(status=Status.INFEASIBLE)
    found = restarted(failed, guess, replace(settings, restarts=rt.planning.Restarts(1)))
    assert found.solution.success and found.solution.duration == pytest.approx(2.0, rel=1e-2)


def test_an_interruption_ends_all_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, solves, plain = Problem([too_far()]), [], rt.InteriorPoint.solve

    def stopped(self: rt.InteriorPoint, *arguments: Any) -> Any:
        outcome = plain(self, *arguments)
        solves.append(outcome)
        return outcome if len(solves) == 1 else replace(outcome, status=Status.INTERRUPTED)

    monkeypatch.setattr(rt.InteriorPoint, "solve", stopped)
    solution = rt.plan(problem, solver=rt.InteriorPoint(fallback=None), check=False)
    assert solution.status is Status.INTERRUPTED and len(solves) == 2
    assert solution.iterations == sum(outcome.iterations for outcome in solves)


def around_a_ball(duration: float = 1.0, **changes: Any) -> rt.Phase:
    """A ur5 whose tool moves around a ball to a place 0.3 m away, without joint positions at the end."""
    robot = rt.load("ur5")
    home = [0, -1.3, 1.6, -1.9, -1.57, 0]
    place = np.array([0.5854305, 0.10921554, 0.30325228])
    centre = place + [0.0, 0.15, 0.0]

    def distance(point: Any) -> Any:
        return ca.sumsqr(point.frame("tool0").position - ca.DM(centre))

    there = dict(zip("xyz", place + [0.0, 0.3, 0.0], strict=True))
    rows = [
        rt.PathConstraint(distance, lower=0.1**2, name="ball", unit="m^2"),
        rt.AtEnd(rt.FramePosition("tool0", there)),
    ]
    ends = rt.State(q=home, v=0), rt.State(v=0)
    return rt.Phase(robot, duration, *ends, rt.Effort(), constraints=rows, **changes)


AT_HOME = rt.Guess([0.0, 1.0], q=np.array([[0, -1.3, 1.6, -1.9, -1.57, 0]] * 2))
"""A guess at rest, from which the solver finds no path around the ball."""


def test_an_obstacle_in_the_way_of_the_default_guess() -> None:
    # On a given mesh nothing keeps the links of the arm apart, which is no matter here.
    solution = rt.plan(around_a_ball(self_collision=False), rt.Mesh(30))
    # The best of several starts.
    assert solution.objective == pytest.approx(599.517, rel=1e-4)
    rt.validate(solution, drift=None).check(limits=1e-3)


def test_variations_of_the_default_guess_follow_one_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(posed, "default_guess", lambda problem: AT_HOME)
    solution = rt.plan(around_a_ball(), rt.Mesh(30))
    assert "variation of the guess" in solution.history.start


def test_a_given_guess_that_fails_is_varied() -> None:
    solution = rt.plan(around_a_ball(), rt.Mesh(30), guess=AT_HOME)
    assert "variation of the guess" in solution.history.start


def test_what_no_variation_can_do_is_infeasible() -> None:
    solution = rt.plan(around_a_ball(0.05), rt.Mesh(10), check=False)
    assert not solution.success and "variation" not in solution.history.start


def test_a_seed_may_be_a_number() -> None:
    phase = around_a_ball()
    one, other = (rt.guess.Perturbed(rt.guess.StraightLine(), seed).of(phase, 0) for seed in (3, (3,)))
    np.testing.assert_array_equal(one.states(np.linspace(0, 1, 5)), other.states(np.linspace(0, 1, 5)))


def test_a_weak_cartpole_is_not_called_infeasible_after_one_guess() -> None:
    """From the straight line 9 N seem necessary; the motion within 5 N swings the pole to the other side first."""
    robot = rt.load("cartpole")
    weak = robot.limits.with_(effort=5.0)
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[0.5, np.pi], v=0)
    solution = rt.plan(rt.Phase(robot, 3.0, *ends, rt.Effort(), limits=weak))
    assert "variation of the guess" in solution.history.start
    assert np.abs(solution.at(np.linspace(0, 3, 301)).tau).max() < 5.0 + 1e-3
    assert rt.validate(solution).passed


def test_a_fallback_without_result_does_not_end_the_plan() -> None:
    robot = rt.load("cartpole")
    weak = robot.limits.with_(effort=5.0)
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[0.5, np.pi], v=0)
    solver = rt.InteriorPoint(fallback=rt.Ipopt(max_iterations=3))
    solution = rt.plan(rt.Phase(robot, 3.0, *ends, rt.Effort(), limits=weak), solver=solver)
    assert "variation of the guess" in solution.history.start


def test_more_variations_are_tried_where_a_joint_has_no_motor() -> None:
    def restarts(name: str) -> rt.planning.Restarts:
        robot = rt.load(name)
        phase = rt.Phase(robot, 1.0, rt.State(q=0, v=0), rt.State(q=0.1, v=0), rt.Effort())
        return resolve(rt.Problem([phase]), {}).restarts

    assert len(restarts("acrobot").seeds) > len(restarts("two_link_arm").seeds)


def fermenter(change: float = 0.0) -> rt.Phase:
    """Ethanol from a fed batch of yeast (Chen and Hwang, Chemical Engineering Communications 97, 1990)."""

    def rates(point: Any) -> list[Any]:
        cells, sugar, ethanol, volume = (point.x[name] for name in ("cells", "sugar", "ethanol", "volume"))
        growth = 0.408 / (1 + ethanol / 16) * sugar / (0.22 + sugar) * cells
        yielded = 1 / (1 + ethanol / 71.5) * sugar / (0.44 + sugar) * cells
        thinned = point.u["feed"] / volume
        return [
            growth - thinned * cells,
            -10 * growth + thinned * (150 - sugar),
            yielded - thinned * ethanol,
            point.u["feed"],
        ]

    return rt.Phase(
        rt.System(["cells", "sugar", "ethanol", "volume"], ["feed"], rates),
        duration=(40.0, 80.0),
        start=rt.State([1.0 + change, 150.0, 0.0, 10.0]),
        objective=rt.Mayer(lambda start, end: -end.x["ethanol"] * end.x["volume"]),
        controls={"feed": rt.between(0, 12)},
        states={"cells": rt.between(0, None), "sugar": rt.between(0, None), "volume": rt.between(0, 200)},
    )


def test_a_reactor_starts_from_its_simulated_motion() -> None:
    # From a straight line, both solvers end where the violation of its rows has a local minimum.
    solution = rt.plan(fermenter())
    assert solution.success
    # The best known optimum is 20,839; another one, of the longest duration, is 19,639.
    assert -20860 < solution.objective < -19500
