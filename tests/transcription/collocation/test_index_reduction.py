"""Index reduction of path equalities: their orders, the places of their rows and rates, and the motions they give."""

from __future__ import annotations

from typing import Any

import casadi as ca
import cloudpickle
import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import least_squares

import robotraj as rt
from robotraj._util.arrays import Array
from robotraj.transcription.collocation.index_reduction import path_equalities
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.reuse import transcribed_again
from tests.programs import nlp_of

SCHEMES: list[tuple[Any, int]] = [
    (rt.HermiteSimpson(), 20),
    (rt.schemes.LobattoIIIA(4), 12),
    (rt.schemes.FifthDegree(), 12),
    (rt.schemes.RadauIIA(1), 40),
    (rt.schemes.RadauIIA(2), 20),
    (rt.schemes.RadauIIA(3), 12),
    (rt.schemes.RadauIIA(5), 8),
    (rt.schemes.GaussLegendre(2), 20),
    (rt.schemes.GaussLegendre(3), 12),
    (rt.schemes.Trapezoidal(), 40),
]
each_scheme = pytest.mark.parametrize(("scheme", "intervals"), SCHEMES, ids=lambda value: str(value)[:16])
ALONE = rt.InteriorPoint(fallback=None)
LINE = rt.FramePosition("tool0", {"x": 0.45, "z": 0.1})
DOWN = rt.PathConstraint(
    lambda point: [point.frame("tool0").rotation[0, 2], point.frame("tool0").rotation[1, 2]], 0, 0, name="down"
)


def plane() -> rt.System:
    """A point of two masses along x and y."""
    names = ["x", "y", "vx", "vy"]
    return rt.System(names, ["fx", "fy"], lambda p: [p.x["vx"], p.x["vy"], p.u["fx"], p.u["fy"] / 2])


def effort() -> rt.Lagrange:
    return rt.Lagrange(lambda p: p.u["fx"] ** 2 + p.u["fy"] ** 2)


def moved(
    *constraints: rt.constraints.Constraint, start: Any = (0, 0, 0, 0), end: Any = (1, 1, 0, 0), **more: Any
) -> rt.Phase:
    return rt.Phase(plane(), 1.0, rt.State(start), rt.State(end), effort(), constraints=list(constraints), **more)


def diagonal(expression: Any = lambda p: p.x["x"] - p.x["y"], value: float = 0.0) -> rt.PathConstraint:
    return rt.PathConstraint(expression, value, value, name="diagonal")


@pytest.fixture(scope="module")
def ur5() -> rt.Robot:
    return rt.load("ur5")


def tool(robot: rt.Robot, q: Array) -> pin.SE3:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.frame("tool0")]


def reach(robot: rt.Robot, y: float) -> Array:
    goal = pin.SE3(np.diag([1.0, -1.0, -1.0]), np.array([0.45, y, 0.1]))
    near = [0.3, -1.2, 1.6, -2.0, -1.57, 0.0]
    missed = lambda q: pin.log6(goal.actInv(tool(robot, q))).vector  # noqa: E731
    return np.asarray(least_squares(missed, near, xtol=1e-15, ftol=1e-15, gtol=1e-15).x)


def drawing(
    robot: rt.Robot, objective: rt.objectives.Objective, end: rt.State | None = None, *more: rt.constraints.Constraint
) -> rt.Phase:
    duration = (0.2, 3.0) if isinstance(objective, rt.Duration) else 1.5
    start, end = rt.State(q=reach(robot, 0.3), v=0), end or rt.State(q=reach(robot, -0.3), v=0)
    return rt.Phase(robot, duration, start, end, objective, constraints=[LINE, DOWN, *more])


def places(nlp: Nlp, name: str) -> list[float]:
    numbers = [i for i, entry in enumerate(nlp.rows.entries) if str(entry) == name]
    return np.sort(nlp.rows.fraction[np.isin(nlp.rows.meaning, numbers)]).tolist()


def off(robot: rt.Robot, solution: rt.Solution) -> float:
    """Distance of the tool from line and vertical, anywhere [m or rad]."""
    poses = [tool(robot, q) for q in solution.at(np.linspace(0, solution.duration, 701)).q]
    by = [[*(pose.translation[[0, 2]] - [0.45, 0.1]), *pose.rotation[:2, 2]] for pose in poses]
    return float(np.abs(by).max())


@pytest.mark.parametrize(
    ("expression", "order"),
    [
        (lambda p: p.x["x"] - p.x["y"], 2),
        (lambda p: p.x["x"] - ca.sin(p.t) * p.x["y"], 2),
        (lambda p: p.x["vx"] - p.x["vy"], None),
        (lambda p: p.u["fx"] - p.u["fy"], None),
        (lambda p: p.t - p.t, None),
    ],
    ids=["position", "in time", "velocity", "control", "nothing"],
)
def test_the_order_is_the_number_of_rates_until_controls_appear(expression: Any, order: int | None) -> None:
    found = path_equalities(moved(diagonal(expression)))
    assert [equality.order for equality in found] == ([] if order is None else [order])


def test_orders_beyond_two_and_inequalities() -> None:
    chain = rt.System(["a", "b", "c"], ["u"], lambda p: [p.x["b"], p.x["c"], p.u["u"]])
    held = rt.PathConstraint(lambda p: p.x["a"] - p.t**3, 0, 0)
    (equality,) = path_equalities(rt.Phase(chain, 1.0, rt.State([0, 0, 0]), constraints=[held]))
    assert equality.order == 3
    values = np.array(equality.values(2.0, [1, 4, 9], [])).ravel()
    np.testing.assert_allclose(values, [1 - 8, 4 - 12, 9 - 12])
    assert not path_equalities(moved(rt.PathConstraint(lambda p: p.x["x"] - p.x["y"], 0, 0.1)))


@pytest.mark.parametrize("objective", [rt.Effort(), rt.objectives.Jerk()], ids=["accelerations", "jerks"])
def test_poses_are_of_the_order_of_accelerations(ur5: rt.Robot, objective: rt.objectives.Objective) -> None:
    phase = drawing(ur5, objective)
    assert [equality.order for equality in path_equalities(phase)] == [2] * 4
    # Where rates of torques are chosen, the accelerations that the phase starts with follow from the torques.
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(3))
    assert places(nlp, "rate 2 of frame position x, tool0") == ([0.0] if isinstance(objective, rt.Effort) else [])


@pytest.mark.parametrize(
    ("scheme", "held", "rates"),
    [
        (rt.HermiteSimpson(), [0, 1 / 3, 2 / 3, 1], [1 / 3, 2 / 3]),
        (rt.schemes.Trapezoidal(), [0, 1 / 3, 1], []),
        (rt.schemes.RadauIIA(2), [1 / 3, 2 / 3, 1], [1 / 3, 2 / 3]),
        (rt.schemes.LobattoIIIA(3), [0, 1 / 3, 2 / 3, 1], [1 / 3, 2 / 3]),
    ],
    ids=str,
)
def test_rows_are_imposed_at_knots_with_their_rates(scheme: Any, held: list[float], rates: list[float]) -> None:
    nlp = nlp_of(rt.Problem([moved(diagonal())]), rt.Mesh(3, scheme))
    np.testing.assert_allclose(places(nlp, "diagonal"), held)
    np.testing.assert_allclose(places(nlp, "rate of diagonal"), rates)


@pytest.mark.parametrize(("end", "last"), [((1, 1, 0, 0), 2 / 3), ((1, 1, None, 0), 1.0), ((1, 1, 1, 0), 1.0)], ids=str)
def test_a_rate_is_imposed_at_an_end_that_does_not_determine_it(end: Any, last: float) -> None:
    nlp = nlp_of(rt.Problem([moved(diagonal(), end=end)]), rt.Mesh(3))
    assert places(nlp, "rate of diagonal")[-1] == pytest.approx(last)
    free = nlp_of(rt.Problem([moved(diagonal(), start=(0, 0, None, None))]), rt.Mesh(3))
    assert places(free, "rate of diagonal")[0] == 0.0


@each_scheme
@pytest.mark.parametrize("solver", [ALONE, rt.Ipopt()], ids=["interior point", "ipopt"])
def test_a_straight_line_is_the_closed_form(scheme: Any, intervals: int, solver: rt.solvers.Solver) -> None:
    """Along x = y both move by the same acceleration a: 12 times the distance squared of (1 + 4) a^2, 60."""
    solution = rt.plan(moved(diagonal()), rt.Mesh(intervals, scheme), solver=solver, progress=False)
    exact = scheme not in (rt.schemes.Trapezoidal(), rt.schemes.RadauIIA(1))
    assert solution.objective == pytest.approx(60.0, rel=1e-8 if exact else 0.08)
    assert solution.iterations < 30
    x = solution.at(np.linspace(0, 1, 101)).x
    np.testing.assert_allclose(x["x"], x["y"], atol=1e-9)


@each_scheme
def test_a_tool_keeps_to_a_line_and_upright(ur5: rt.Robot, scheme: Any, intervals: int) -> None:
    """Four equalities at every point, at rest at both ends: unreduced, there would be more rows than unknowns."""
    solution = rt.plan(drawing(ur5, rt.Effort()), rt.Mesh(intervals, scheme), solver=ALONE, progress=False)
    assert solution.objective == pytest.approx(1021.8, rel=0.01)
    assert solution.iterations < 60
    assert off(ur5, solution) < 5e-4
    assert not solution.violations()
    assert not solution.added_rows


def test_between_the_points_it_is_of_the_order_of_the_scheme(ur5: rt.Robot) -> None:
    phase = drawing(ur5, rt.Effort())
    coarse, fine = (off(ur5, rt.plan(phase, rt.Mesh(n), solver=ALONE, progress=False)) for n in (10, 20))
    assert fine < coarse / 7
    few = rt.plan(phase, rt.Mesh(2), solver=ALONE, progress=False, check=False)
    assert any("frame position" in violation.name for violation in few.interval_violations)
    assert not few.added_rows


def test_both_solvers_find_one_optimum(ur5: rt.Robot) -> None:
    phase = drawing(ur5, rt.Effort())
    one, other = (
        rt.plan(
            phase,
            rt.Mesh(12),
            solver=solver,
            interval_limits=rt.interval_limits.ConstraintGeneration(rounds=0),
            progress=False,
        )
        for solver in (ALONE, rt.Ipopt())
    )
    assert one.objective == pytest.approx(other.objective, rel=1e-7)


@pytest.mark.parametrize("free", [{}, {"z": 0.1}], ids=["alone", "at a height"])
def test_an_orientation_is_held_with_free_positions(ur5: rt.Robot, free: dict[str, float]) -> None:
    down = np.diag([1.0, -1.0, -1.0])
    ends = rt.State(q=reach(ur5, 0.3), v=0), rt.State(q=reach(ur5, -0.3), v=0)
    held = rt.FramePose("tool0", (free or [None] * 3, down))
    phase = rt.Phase(ur5, 1.5, *ends, rt.Effort(), constraints=[held])
    solution = rt.plan(phase, rt.Mesh(20), solver=ALONE, progress=False)
    assert solution.iterations < 60
    poses = [tool(ur5, q) for q in solution.at(np.linspace(0, 1.5, 301)).q]
    assert max(np.abs(pose.rotation - down).max() for pose in poses) < 1e-3
    heights = np.abs([pose.translation[2] - 0.1 for pose in poses]).max()
    assert (heights < 1e-4) == bool(free)


@pytest.mark.parametrize(
    "scheme", [rt.HermiteSimpson(), rt.schemes.RadauIIA(3), rt.schemes.GaussLegendre(3)], ids=lambda s: str(s)[:9]
)
def test_an_end_of_the_line_may_be_left_open(ur5: rt.Robot, scheme: Any) -> None:
    goal = rt.AtEnd(rt.FramePosition("tool0", {"y": -0.2}))
    phase = drawing(ur5, rt.Effort(), rt.State(v=0), goal)
    solution = rt.plan(phase, rt.Mesh(12, scheme), solver=ALONE, progress=False)
    pose = tool(ur5, solution.at(solution.duration).q)
    np.testing.assert_allclose(pose.translation, [0.45, -0.2, 0.1], atol=1e-4)
    assert off(ur5, solution) < 5e-4


def test_a_figure_followed_in_time_needs_no_ends(ur5: rt.Robot) -> None:
    def missed(point: Any) -> list[Any]:
        x, y, z = (point.frame("tool0").position[i] for i in range(3))
        return [x - 0.45 - 0.08 * ca.cos(np.pi * point.t), y - 0.08 * ca.sin(np.pi * point.t), z - 0.3]

    circle = rt.PathConstraint(missed, 0, 0, name="circle")
    solution = rt.plan(rt.Phase(ur5, 2.0, objective=rt.Effort(), constraints=[circle]), solver=ALONE, progress=False)
    times = np.linspace(0, 2, 201)
    places = [tool(ur5, q).translation for q in solution.at(times).q]
    wanted = np.column_stack([0.45 + 0.08 * np.cos(np.pi * times), 0.08 * np.sin(np.pi * times), 0.3 + 0 * times])
    np.testing.assert_allclose(places, wanted, atol=1e-4)


def test_accelerations_do_not_oscillate_from_knot_to_knot(ur5: rt.Robot) -> None:
    """Least time does not determine them; along the line they are those of a spline through the tool's positions."""
    solution = rt.plan(drawing(ur5, rt.Duration()), rt.Mesh(40), solver=ALONE, progress=False)
    nlp = nlp_of(rt.Problem([drawing(ur5, rt.Duration())]), rt.Mesh(40))
    assert places(nlp, "rate 2 of frame position x, tool0") == [0.0]
    model, data, frame = ur5.model, ur5.model.createData(), ur5.frame("tool0")
    found = []
    for t in solution.knots[1:-1]:
        now = solution.at(t)
        pin.forwardKinematics(model, data, now.q, now.v, now.a)
        found.append(pin.getFrameClassicalAcceleration(model, data, frame, pin.LOCAL_WORLD_ALIGNED).linear[[0, 2]])
    along = np.abs(np.array(found)).max()
    assert along < 1.0


def test_velocities_across_the_equality_are_named() -> None:
    phase = moved(diagonal(), end=(1, 1, 1, 0))
    solution = rt.plan(phase, rt.Mesh(10), solver=rt.Ipopt(max_iterations=50), check=False, progress=False)
    assert not solution.success
    assert any("rate of diagonal" in violation.name for violation in solution.violations(20))


def test_another_goal_takes_the_transcription_over_where_its_rows_are_the_same() -> None:
    problem, mesh = rt.Problem([moved(diagonal())]), rt.Mesh(10)
    first = rt.plan(problem, mesh, solver=ALONE, progress=False)
    for end, again in (((2, 2, 0, 0), True), ((2, 2, 1, 1), True), ((2, 2, None, None), False)):
        other = problem.with_(end=rt.State(end))
        solution = rt.plan(other, mesh, first, solver=ALONE, progress=False)
        alone = rt.plan(other, mesh, solver=ALONE, progress=False)
        assert solution.objective == pytest.approx(alone.objective, rel=1e-7)
        known = nlp_of(problem, mesh)
        assert (
            transcribed_again(known, other, mesh, None, rt.interval_limits.ConstraintGeneration(), 0.0, known.guess)
            is not None
        ) == again


def test_an_end_across_the_equality_is_not_taken_over() -> None:
    problem = rt.Problem([moved(diagonal())])
    first = rt.plan(problem, rt.Mesh(10), solver=ALONE, progress=False)
    other = problem.with_(end=rt.State((1, 1, 1, 0)))
    solution = rt.plan(other, rt.Mesh(10), first, solver=rt.Ipopt(max_iterations=50), check=False, progress=False)
    assert not solution.success


def test_phases_that_hold_the_same_equality_run_on() -> None:
    whole = rt.plan(moved(diagonal()), rt.Mesh(20), solver=ALONE, progress=False)
    parts = [
        rt.Phase(
            plane(), 0.5, rt.State([0, 0, 0, 0]), rt.State([0.5, None, None, None]), effort(), constraints=[diagonal()]
        ),
        rt.Phase(plane(), 0.5, end=rt.State([1, 1, 0, 0]), objective=effort(), constraints=[diagonal()]),
    ]
    for solver in (ALONE, rt.Ipopt()):
        joined = rt.Problem(parts, [rt.Continuity(0, 1)])
        solution = rt.plan(joined, rt.Mesh(10), solver=solver, progress=False)
        assert solution.objective == pytest.approx(whole.objective, rel=1e-8)


@pytest.mark.parametrize("name", ["diagonal", "other"])
def test_another_equality_of_the_same_name_begins_at_its_own_start(name: str) -> None:
    """Along x = y to (0.5, 0.5), then along x - 2 y = -0.5: no velocity is along both: it rests at the corner."""
    second = rt.PathConstraint(lambda p: p.x["x"] - 2 * p.x["y"] + 0.5, 0, 0, name=name)
    parts = [
        rt.Phase(
            plane(), 0.5, rt.State([0, 0, 0, 0]), rt.State([0.5, 0.5, None, None]), effort(), constraints=[diagonal()]
        ),
        rt.Phase(plane(), 0.5, end=rt.State([1, 0.75, 0, 0]), objective=effort(), constraints=[second]),
    ]
    for solver in (ALONE, rt.Ipopt()):
        solution = rt.plan(rt.Problem(parts, [rt.Continuity(0, 1)]), rt.Mesh(10), solver=solver, progress=False)
        # 12 d^2 / T^3 of each axis, weighted by 1 and 4.
        assert solution.objective == pytest.approx(96 * (0.25 * 5) + 96 * (0.25 + 4 * 0.0625), rel=1e-7)


def test_a_motion_that_repeats_holds_the_equality_where_it_begins_again() -> None:
    """y = sin(2 t) is not where it was after a second."""
    wave = diagonal(lambda p: p.x["y"] - ca.sin(2 * p.t))
    phase = rt.Phase(plane(), 1.0, rt.State([0, None, None, None]), rt.State(), effort(), constraints=[wave])
    solver = rt.Ipopt(max_iterations=100)
    assert not rt.plan(rt.Problem([phase], [rt.Periodic()]), rt.Mesh(10), solver=solver, check=False).success
    free = phase.with_(duration=(1.0, 4.0))
    solution = rt.plan(rt.Problem([free], [rt.Periodic()]), rt.Mesh(20), solver=ALONE, progress=False)
    assert solution.duration == pytest.approx(np.pi, rel=1e-6)


@each_scheme
def test_an_open_start_is_on_the_equality_and_along_it(scheme: Any, intervals: int) -> None:
    """From 0 at 1 m/s to rest at 1 m in 1 s a cubic has the integral 4 of a^2, five times."""
    phase = moved(diagonal(), start=(0, None, 1, None))
    solution = rt.plan(phase, rt.Mesh(intervals, scheme), solver=ALONE, progress=False)
    exact = scheme not in (rt.schemes.Trapezoidal(), rt.schemes.RadauIIA(1))
    assert solution.objective == pytest.approx(20.0, rel=1e-7 if exact else 0.1)
    first = solution.at(0.0).x
    assert first["y"] == pytest.approx(0.0, abs=1e-8)
    assert first["vy"] == pytest.approx(1.0, abs=1e-8)


def test_an_equality_that_begins_with_a_phase_begins_with_its_rate() -> None:
    parts = [
        rt.Phase(plane(), 0.5, rt.State([0, 0, 0, 0]), rt.State([0.5, 0.5, None, None]), effort()),
        rt.Phase(plane(), 0.5, end=rt.State([1, 1, 0, 0]), objective=effort(), constraints=[diagonal()]),
    ]
    solution = rt.plan(rt.Problem(parts, [rt.Continuity(0, 1)]), rt.Mesh(10), solver=ALONE, progress=False)
    x = solution.phases[1].at(solution.phases[1].knots).x
    np.testing.assert_allclose(x["vx"], x["vy"], atol=1e-8)


def test_a_planned_phase_can_be_pickled() -> None:
    phase = moved(diagonal())
    solution = rt.plan(phase, rt.Mesh(10), solver=ALONE, progress=False)
    copy = cloudpickle.loads(cloudpickle.dumps(phase))
    again = rt.plan(copy, rt.Mesh(10), solver=ALONE, progress=False)
    assert again.objective == solution.objective
    assert cloudpickle.loads(cloudpickle.dumps(solution)).objective == solution.objective


def test_costates_are_refused() -> None:
    solution = rt.plan(moved(diagonal()), rt.Mesh(10), solver=ALONE, progress=False)
    with pytest.raises(rt.InputError, match="diagonal.*costates are not unique"):
        rt.indirect.costates(solution)
