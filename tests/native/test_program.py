"""Stagewise programs against closed forms, IPOPT and finite differences."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest

from robotraj._util.arrays import Array
from robotraj.native import Options, Program

A = np.array([[1.0, 0.1], [0.0, 1.0]])
B = np.array([[0.005], [0.1]])
NONE = np.zeros(0)


@pytest.fixture
def regulator(shooting: Any) -> Any:
    """Double integrator from 1 m at rest, 20 steps of 0.1 s, x'x + 0.1 u'u."""
    return shooting(lambda x, u: A @ x + B @ u, 2, 1, 21, lambda x, u: x.T @ x + 0.1 * u.T @ u, [1.0, 0.0])


BOUND = np.full(60, 5.0)


def residual(written: Any, program: Program, outcome: Any) -> Array:
    """Gradient + Jacobian' lam, which vanishes at a solution."""
    gradient = program.gradient(outcome.y)
    np.add.at(
        gradient,
        written.jacobian_entries[1],
        program.jacobian(outcome.y) * outcome.lam[written.jacobian_entries[0]],
    )
    return gradient


def test_a_linear_quadratic_regulator_takes_one_step_to_the_answer_of_riccati(regulator: Any) -> None:
    written = regulator.write()
    outcome = written.build().solve(np.zeros(written.linear.shape[1]), NONE, NONE)
    cost_to_go = np.zeros((2, 2))
    for _ in range(20):
        gain = np.linalg.solve(0.1 * np.eye(1) + B.T @ cost_to_go @ B, B.T @ cost_to_go @ A)
        cost_to_go = np.eye(2) + A.T @ cost_to_go @ (A - B @ gain)
    assert outcome.status == "solved"
    assert outcome.iterations == 1
    assert outcome.objective == pytest.approx(cost_to_go[0, 0], rel=1e-12)
    u_0, x_0 = outcome.y[0], outcome.y[1:3]
    assert u_0 == pytest.approx(-(gain @ x_0)[0], rel=1e-12)


def test_free_duration_carried_as_a_state_reaches_the_minimum_time(shooting: Any) -> None:
    # Rest to rest over 10 m with |u| <= 1: bang-bang, T = 2 sqrt(10), exact with constant controls on an even mesh.
    n = 10

    def step(x: Any, u: Any) -> Any:
        h = x[2] / n
        return ca.vertcat(x[0] + h * x[1] + h**2 / 2 * u, x[1] + h * u, x[2])

    def limited(x: Any, u: Any) -> Any:
        return ca.vertcat(u, x[2])

    problem = shooting(step, 3, 1, n + 1, lambda x, u: x[2] / n, [0.0, 0.0, 0.0], [10.0, 0.0, 0.0], limited)
    written = problem.write()
    # The carried duration is free: the rows that fix it at the two ends are removed.
    dynamics = 3 * n
    keep = np.setdiff1d(np.arange(written.linear.shape[0]), [dynamics + 2, dynamics + 5])
    written.linear, written.offset = written.linear[keep], written.offset[keep]
    written.points[0].scatter = written.points[0].scatter[keep]
    written.stages[2][0] = written.stages[2][-1] = 2
    y = np.tile([0.0, 0.0, 0.0, 5.0], n + 1)[:-1]
    y[-3:] = 0.0, 0.0, 5.0
    lower, upper = np.tile([-1.0, 0.1], n), np.tile([1.0, 20.0], n)
    outcome = written.build().solve(y, lower, upper, Options(tolerance=1e-10))
    assert outcome.status == "solved"
    assert outcome.objective == pytest.approx(2 * np.sqrt(10), rel=1e-7)
    np.testing.assert_allclose(outcome.y[0 : 4 * n : 4], np.repeat([1.0, -1.0], n // 2), atol=1e-6)


def test_active_bounds_have_the_multipliers_of_the_closed_form(shooting: Any) -> None:
    # One step x_1 = x_0 + u, x_0 = 0, min (u - 3)^2 with u <= 1: u = 1, and 2 (u - 3) + z = 0 gives z = 4.
    written = shooting(lambda x, u: x + u, 1, 1, 2, lambda x, u: (u - 3) ** 2, [0.0], None, lambda x, u: u).write()
    program = written.build()
    outcome = program.solve(np.zeros(3), np.array([-np.inf]), np.array([1.0]), Options(tolerance=1e-10))
    assert outcome.status == "solved"
    assert outcome.y[0] == pytest.approx(1.0, abs=1e-7)
    assert outcome.upper_duals == pytest.approx([4.0], abs=1e-6)
    assert outcome.lower_duals == pytest.approx([0.0])
    assert outcome.lam[-1] == pytest.approx(4.0, abs=1e-6)
    np.testing.assert_allclose(residual(written, program, outcome), 0.0, atol=1e-8)


@pytest.mark.parametrize("scale", [1e-2, 30.0])
def test_multipliers_and_the_log_are_of_the_objective_as_it_is(pendulum: Any, scale: float) -> None:
    written = pendulum.write()
    program = written.build()
    start = np.zeros(written.linear.shape[1])
    plain = program.solve(start, -BOUND, BOUND, Options(tolerance=1e-10))
    objectives = []
    scaled = program.solve(
        start,
        -BOUND,
        BOUND,
        Options(tolerance=1e-10 * scale),
        objective_scale=scale,
        callback=lambda number, objective, infeasibility: objectives.append(objective),
    )
    assert scaled.status == "solved"
    assert scaled.objective == pytest.approx(plain.objective, rel=1e-8)
    assert objectives[-1] == pytest.approx(plain.objective, rel=1e-4)
    assert scaled.trace[-1][0] == pytest.approx(plain.objective, rel=1e-8)
    for name in ("lam", "lower_duals", "upper_duals"):
        np.testing.assert_allclose(getattr(scaled, name), getattr(plain, name), atol=1e-5)
    again = program.solve(
        scaled.y, -BOUND, BOUND, lam=scaled.lam, options=Options(initial_barrier=scaled.mu), objective_scale=scale
    )
    assert again.iterations <= 2
    np.testing.assert_allclose(residual(written, program, scaled), 0.0, atol=1e-7)


def test_a_swing_up_agrees_with_ipopt(pendulum: Any) -> None:
    written = pendulum.write()
    program = written.build()
    outcome = program.solve(np.zeros(written.linear.shape[1]), -BOUND, BOUND, Options(tolerance=1e-10))
    assert outcome.status == "solved"
    assert outcome.violation < 1e-7
    np.testing.assert_allclose(residual(written, program, outcome), 0.0, atol=1e-8)

    y = ca.SX.sym("y", written.linear.shape[1])
    points = written.points[0]
    values = ca.Function("values", [points.v], [points.y]).map(60)(ca.reshape(points.gather @ y, 3, 60))
    rows = written.linear @ y + written.offset + points.scatter @ ca.vec(values)
    solver = ca.nlpsol(
        "swing",
        "ipopt",
        {"x": y, "f": ca.sum2(values[-1, :]), "g": rows},
        {"ipopt": {"print_level": 0, "tol": 1e-10}, "print_time": False},
    )
    equalities = np.zeros(rows.numel() - 60)
    other = solver(x0=0, lbg=np.r_[equalities, -BOUND], ubg=np.r_[equalities, BOUND])
    assert outcome.objective == pytest.approx(float(other["f"]), rel=1e-7)
    np.testing.assert_allclose(outcome.y, np.array(other["x"]).ravel(), atol=1e-5)
    np.testing.assert_allclose(outcome.lam, np.array(other["lam_g"]).ravel(), atol=1e-4)


def test_active_bounds_do_not_end_the_convergence_of_newton(shooting: Any) -> None:
    # Some 40 of 90 bounds on combinations of 6 controls are active: 1 / mu on their diagonals must not hide curvature.
    rng = np.random.default_rng(0)
    a, b = 0.8 * np.eye(4) + 0.1 * rng.standard_normal((4, 4)), 0.3 * rng.standard_normal((4, 6))
    bounded = rng.standard_normal((9, 6))
    written = shooting(
        lambda x, u: a @ x + b @ u + 0.1 * ca.sin(x),
        4,
        6,
        11,
        lambda x, u: 10 * ca.sumsqr(x) + ca.sumsqr(u),
        [3.0, -3.0, 3.0, -3.0],
        inequality=lambda x, u: bounded @ u,
    ).write()
    program = written.build()
    start, side = np.zeros(written.linear.shape[1]), np.ones(90)
    outcome = program.solve(start, -side, side)
    assert np.sum(outcome.lower_duals + outcome.upper_duals > 1e-3) > 30
    assert outcome.status == "solved"
    assert outcome.iterations <= 20
    assert (
        program.solve(start, -side, side, Options(pivot_tolerance=1e-6, max_iterations=40)).status == "iteration limit"
    )


def test_derivatives_agree_with_finite_differences(pendulum: Any) -> None:
    pendulum.batch = 4  # does not divide 60 points a thread evenly with 7 threads
    pendulum.threads = 7
    written = pendulum.write()
    program = written.build()
    rng = np.random.default_rng(0)
    rows, columns = written.linear.shape
    y, lam = rng.standard_normal(columns), rng.standard_normal(rows)
    h = 1e-6
    steps = [(y + h * e, y - h * e) for e in np.eye(columns)]

    jacobian = np.zeros((rows, columns))
    jacobian[written.jacobian_entries] = program.jacobian(y)
    differences = np.array([(program.rows(a) - program.rows(b)) / (2 * h) for a, b in steps]).T
    np.testing.assert_allclose(jacobian, differences, atol=1e-8)

    gradient = program.gradient(y)
    np.testing.assert_allclose(
        gradient, [(program.objective(a) - program.objective(b)) / (2 * h) for a, b in steps], atol=1e-8
    )

    def lagrangian(point: Array) -> Array:
        matrix = np.zeros((rows, columns))
        matrix[written.jacobian_entries] = program.jacobian(point)
        return 0.7 * program.gradient(point) + matrix.T @ lam

    hessian = np.zeros((columns, columns))
    hessian[written.hessian_entries] = program.hessian(y, lam, 0.7)
    hessian += np.tril(hessian, -1).T
    np.testing.assert_allclose(hessian, [(lagrangian(a) - lagrangian(b)) / (2 * h) for a, b in steps], atol=1e-7)


def test_one_thread_and_two_give_the_same_bits(pendulum: Any) -> None:
    outcomes = []
    for threads in (1, 2):
        pendulum.threads = threads
        written = pendulum.write()
        outcomes.append(written.build().solve(np.zeros(written.linear.shape[1]), -BOUND, BOUND))
    one, two = outcomes
    assert one.iterations == two.iterations
    assert np.array_equal(one.y, two.y)
    assert np.array_equal(one.lam, two.lam)


def test_a_solve_again_with_other_numbers_is_a_fresh_one(pendulum: Any) -> None:
    written = pendulum.write()
    columns = written.linear.shape[1]
    reused = written.build()
    reused.solve(np.zeros(columns), -BOUND, BOUND, Options(initial_barrier=1e-2, max_iterations=3))
    pendulum.start, pendulum.end = [0.3, -0.1], [-np.pi, 0.2]
    other = pendulum.write()
    reused.set_offsets(other.offset, 2.0)
    again = reused.solve(np.zeros(columns), -1.2 * BOUND, BOUND)
    fresh = other.build().solve(np.zeros(columns), -1.2 * BOUND, BOUND)
    assert again.status == "solved"
    assert again.iterations == fresh.iterations
    assert np.array_equal(again.y, fresh.y)
    assert again.objective == pytest.approx(fresh.objective + 2.0, rel=1e-14)


def test_constants_and_gathered_offsets_enter_the_point_functions(points: Any, written: Any) -> None:
    v, c = ca.SX.sym("v", 2), ca.SX.sym("c", 1)
    # Two points of one function of the single stage's unknowns; their costs weigh 1 and 10.
    part = points(
        v,
        c,
        (v[0] - c) ** 2 + v[1] ** 2,
        np.vstack([np.eye(2), 2 * np.eye(2)]),
        np.zeros((0, 2)),
        np.array([[1.0, 2.0]]),
        np.zeros(4),
        0,
        np.array([1.0, 10.0]),
    )
    program = written(([1], [1], [0], [0]), np.zeros((0, 2)), NONE, np.zeros(2), 0.0, [part]).build()
    y = np.array([0.5, 0.25])

    def cost(c: tuple[float, float], d: tuple[float, float]) -> float:
        first = (y[0] + d[0] - c[0]) ** 2 + (y[1] + d[0]) ** 2
        return float(first + 10 * ((2 * y[0] + d[1] - c[1]) ** 2 + (2 * y[1] + d[1]) ** 2))

    assert program.objective(y) == pytest.approx(cost((1, 2), (0, 0)))
    program.set_constants(0, np.array([3.0, 4.0]))
    assert program.objective(y) == pytest.approx(cost((3, 4), (0, 0)))
    program.set_block_offsets(0, np.array([0.1, 0.1, 0.2, 0.2]))
    assert program.objective(y) == pytest.approx(cost((3, 4), (0.1, 0.2)))
    assert program.solve(y, NONE, NONE).iterations <= 1


def test_a_warm_start_from_the_solution_needs_next_to_no_iterations(pendulum: Any) -> None:
    written = pendulum.write()
    program = written.build()
    cold = program.solve(np.zeros(written.linear.shape[1]), -BOUND, BOUND)
    same = program.solve(cold.y, -BOUND, BOUND, lam=cold.lam, options=Options(initial_barrier=cold.mu))
    assert same.status == "solved"
    assert same.iterations <= 1
    tighter = 0.98 * BOUND
    near = program.solve(cold.y, -tighter, tighter, lam=cold.lam, options=Options(initial_barrier=1e-4))
    far = program.solve(np.zeros_like(cold.y), -tighter, tighter)
    assert near.status == far.status == "solved"
    assert near.objective == pytest.approx(far.objective, rel=1e-6)
    assert near.iterations < far.iterations / 2


def test_a_warm_start_moves_a_bound_that_hardly_pushes_by_the_root_of_the_barrier_at_most(shooting: Any) -> None:
    """The control's bound is where its optimum is without: at the solution both its slack and its multiplier vanish."""
    written = shooting(
        lambda x, u: A @ x + B @ u,
        2,
        1,
        21,
        lambda x, u: x.T @ x + 0.1 * u.T @ u,
        [1.0, 0.0],
        inequality=lambda x, u: u,
    ).write()
    program = written.build()
    far = np.full(20, 100.0)
    free = program.solve(np.zeros(written.linear.shape[1]), -far, far)
    bound = np.full(20, float(np.abs(program.rows(free.y)[-20:]).max()))
    touching = program.solve(free.y, -bound, bound)
    assert touching.status == "solved" and np.abs(touching.lam[-20:]).max() < 1e-3
    again = program.solve(touching.y, -bound, bound, lam=touching.lam, options=Options(initial_barrier=1e-4))
    assert again.status == "solved"
    assert max(again.trace[0][1:3]) <= 1.01 * np.sqrt(1e-4)
    assert again.objective == pytest.approx(free.objective, rel=1e-6)


def test_a_callback_stops_a_solve_and_the_iterate_stays(pendulum: Any) -> None:
    written = pendulum.write()
    program = written.build()
    start = np.zeros(written.linear.shape[1])
    seen: list[tuple[int, float, float]] = []

    def stop_at_five(iteration: int, objective: float, infeasibility: float) -> bool:
        seen.append((iteration, objective, infeasibility))
        return iteration == 5

    stopped = program.solve(start, -BOUND, BOUND, callback=stop_at_five)
    limited = program.solve(start, -BOUND, BOUND, Options(max_iterations=5))
    assert stopped.status == "stopped"
    assert limited.status == "iteration limit"
    assert [line[0] for line in seen] == [0, 1, 2, 3, 4, 5]
    assert stopped.iterations == limited.iterations == 5
    assert np.array_equal(stopped.y, limited.y)
    assert [line[0] for line in stopped.trace] == [line[1] for line in seen]
    assert program.solve(start, -BOUND, BOUND).status == "solved"


def test_a_problem_without_a_lowest_value_ends(shooting: Any) -> None:
    """The curvature is negative at every iterate: steps come from the inertia correction; no bound limits them."""
    written = shooting(lambda x, u: x + u, 1, 1, 4, lambda x, u: -(u**2), [0.0]).write()
    start = np.full(written.linear.shape[1], 0.1)
    outcome = written.build().solve(start, NONE, NONE, Options(max_iterations=200), time_limit=20.0)
    assert outcome.status in ("iteration limit", "step failed", "line search failed")
    assert outcome.objective < -1e3


@pytest.mark.parametrize("adaptive", [False, True], ids=["monotone", "adaptive"])
def test_barriers_fall_to_the_same_optimum(pendulum: Any, adaptive: bool) -> None:
    written = pendulum.write()
    start = np.zeros(written.linear.shape[1])
    plain = written.build().solve(start, -BOUND, BOUND, Options(tolerance=1e-10))
    chosen = written.build().solve(start, -BOUND, BOUND, Options(tolerance=1e-10, adaptive_barrier=adaptive))
    assert chosen.status == "solved"
    assert chosen.objective == pytest.approx(plain.objective, rel=1e-9)
    falls = np.diff([line[3] for line in chosen.trace]) <= 0
    assert falls.all() or adaptive


def test_the_iterate_can_be_read_while_a_solve_runs(pendulum: Any) -> None:
    written = pendulum.write()
    program = written.build()
    seen = []
    outcome = program.solve(
        np.zeros(written.linear.shape[1]), -BOUND, BOUND, callback=lambda *_: seen.append(program.iterate) is not None
    )
    assert len(seen) == outcome.iterations
    assert np.array_equal(seen[0], np.zeros(written.linear.shape[1]))
    assert np.abs(seen[-1] - outcome.y).max() < 1e-3
    assert np.array_equal(program.iterate, outcome.y)


def test_processor_seconds_end_a_solve(pendulum: Any) -> None:
    written = pendulum.write()
    start = np.zeros(written.linear.shape[1])
    outcome = written.build().solve(start, -BOUND, BOUND, Options(processor_limit=0.0))
    assert outcome.status == "time limit"
    assert outcome.iterations <= 1


def test_contradicting_bounds_are_reported(shooting: Any) -> None:
    written = shooting(lambda x, u: x + u, 1, 1, 4, lambda x, u: u**2, [0.0], [10.0], lambda x, u: u).write()
    outcome = written.build().solve(np.zeros(7), -np.ones(3), np.ones(3), Options(max_iterations=200))
    assert outcome.status in ("infeasible", "line search failed", "iteration limit")
    assert outcome.violation > 1.0


@pytest.mark.parametrize("options", [{}, {"row_correction": 0.0}], ids=["", "not damped"])
@pytest.mark.parametrize("other", [1.0, 2.0], ids=["the same twice", "contradicting"])
def test_dependent_equalities_end(shooting: Any, other: float, options: dict[str, float]) -> None:
    written = shooting(lambda x, u: A @ x + B @ u, 2, 1, 9, lambda x, u: u**2, [0.0, 0.0], [1.0, 0.0]).write()
    last = written.linear.shape[0] - 1
    written.linear[last] = written.linear[last - 1]
    written.offset[last] = -other
    start = np.zeros(written.linear.shape[1])
    outcome = written.build().solve(start, NONE, NONE, Options(max_iterations=50, **options), time_limit=20.0)
    assert outcome.status != "time limit"
    assert (outcome.violation < 1e-6) == (other == 1.0)


def test_functions_that_are_no_numbers_fail_without_a_crash(shooting: Any) -> None:
    written = shooting(lambda x, u: x + u, 1, 1, 4, lambda x, u: ca.log(u), [0.0], [1.0]).write()
    program = written.build()
    outcome = program.solve(np.full(7, -1.0), NONE, NONE, Options(max_iterations=20))
    assert outcome.status not in ("solved", "acceptable")
    assert np.isnan(outcome.objective)


def test_rows_that_are_not_finite_have_the_violation_nan(shooting: Any) -> None:
    written = shooting(lambda x, u: x + ca.sqrt(u), 1, 1, 4, lambda x, u: u**2, [0.0], [1.0]).write()
    outcome = written.build().solve(np.full(7, -1.0), NONE, NONE, Options(max_iterations=20))
    assert outcome.status not in ("solved", "acceptable")
    assert np.isnan(outcome.violation)


def test_unknown_options_are_refused_with_those_that_exist() -> None:
    with pytest.raises(ValueError, match="no option 'tolerence'; there are .*tolerance "):
        Options(tolerence=1e-6)
    with pytest.raises(ValueError, match="'max_iterations' is no number"):
        Options(max_iterations="many")
    assert Options(initial_barrier=0.3).initial_barrier == 0.3


def test_arrays_of_the_wrong_length_are_named(pendulum: Any) -> None:
    written = pendulum.write()
    program = written.build()
    start = np.zeros(written.linear.shape[1])
    with pytest.raises(ValueError, match="lower has 59 entries, expected 60"):
        program.solve(start, -BOUND[1:], BOUND)
    with pytest.raises(ValueError, match="y has 181 entries, expected 182"):
        program.rows(start[1:])


def test_entries_that_join_stages_are_refused(regulator: Any) -> None:
    written = regulator.write()
    written.linear[0, 5] = 1.0
    with pytest.raises(ValueError, match=r"Jacobian entry \(0, 5\) joins stage 0 with another"):
        written.build()
    written = regulator.write()
    written.linear[0, 4] = -2.0
    with pytest.raises(ValueError, match="row 0 is dynamics, so it has -1 at column 4"):
        written.build()
