import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

START = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
GOAL = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])


@pytest.fixture(scope="module")
def ur5():
    return rt.load("ur5")


@pytest.fixture(scope="module")
def reach(ur5):
    return rt.Phase(
        ur5, duration=1.0, start=rt.State(q=START, v=0), end=rt.State(q=GOAL, v=0), objective=rt.Effort(), name="reach"
    )


def test_a_step_finds_the_optimum_of_a_plan_from_there(reach):
    replanner = rt.Replanner(reach, mesh=rt.Mesh(20), solver=rt.InteriorPoint(tolerance=1e-9))
    q, v, goal = START + 0.05, np.full(6, 0.1), GOAL - 0.1
    replan = replanner.step(0.0, rt.State(q=q, v=v), rt.State(q=goal, v=0))
    cold = rt.plan(reach.with_(start=rt.State(q=q, v=v), end=rt.State(q=goal, v=0)), mesh=rt.Mesh(20))
    times = np.linspace(0.0, 1.0, 31)
    assert replan.fresh and replan.status is rt.solvers.Status.SOLVED
    np.testing.assert_allclose(replan.at(times).q, cold.at(times).q, atol=1e-6)
    np.testing.assert_allclose(replan.at(times).tau, cold.at(times).tau, atol=1e-3)
    np.testing.assert_allclose(replan.at(0.0).q, q, atol=1e-12)
    np.testing.assert_allclose(replan.at(1.0).q, goal, atol=1e-9)


def test_steps_use_the_clock_of_the_caller(reach):
    replanner = rt.Replanner(reach, mesh=rt.Mesh(10))
    replan = replanner.step(7.5, rt.State(q=START, v=0))
    assert (replan.start, replan.end) == (7.5, 8.5)
    np.testing.assert_allclose(replan.at(7.0).q, START, atol=1e-9)
    np.testing.assert_allclose(replan.at(9.0).q, GOAL, atol=1e-9)


def test_an_end_stays_until_it_is_moved(reach):
    replanner = rt.Replanner(reach, mesh=rt.Mesh(10))
    moved = GOAL + 0.2
    replanner.step(0.0, rt.State(q=START, v=0), rt.State(q=moved, v=0))
    replan = replanner.step(0.1, rt.State(q=START + 0.01, v=0))
    np.testing.assert_allclose(replan.at(1.1).q, moved, atol=1e-9)


def test_a_plan_is_kept_where_the_goal_is_out_of_reach(reach):
    replanner = rt.Replanner(reach, mesh=rt.Mesh(10), solver=rt.InteriorPoint(max_iterations=40))
    kept = replanner.step(0.0, rt.State(q=START, v=0))
    # 5 rad in 1 s exceed the speed limit of 3.15 rad/s.
    replan = replanner.step(0.02, rt.State(q=START, v=0), rt.State(q=START + 5.0, v=0))
    assert not replan.fresh and replan.violation > 1e-4
    assert replan.start == 0.0 and replan.motion is kept.motion
    again = replanner.step(0.04, rt.State(q=START, v=0), rt.State(q=GOAL, v=0))
    assert again.fresh and again.start == 0.04


def test_a_deadline_ends_a_step(reach):
    replanner = rt.Replanner(reach, mesh=rt.Mesh(40), deadline=1e-5)
    replan = replanner.step(0.0, rt.State(q=START + 0.3, v=0), rt.State(q=GOAL - 0.3, v=0))
    assert replan.status is rt.solvers.Status.TIME_LIMIT
    assert replan.iterations <= 1
    assert "time limit" in str(replan)


def test_a_measured_start_may_lie_outside_its_limits(ur5):
    upper = ur5.limits.position_upper.copy()
    q = START.copy()
    q[2] = upper[2] - 0.1
    reach = rt.Phase(ur5, 1.0, rt.State(q=q, v=0), rt.State(q=GOAL, v=0), rt.Effort())
    replanner = rt.Replanner(reach, mesh=rt.Mesh(10))
    q[2] = upper[2] + 3e-7
    replan = replanner.step(0.0, rt.State(q=q, v=0))
    assert replan.fresh
    assert replan.at(np.linspace(0.1, 1.0, 50)).q[:, 2].max() < upper[2] + 1e-6


def test_free_durations_and_systems():
    block = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])
    move = rt.Phase(
        block,
        duration=(0.1, 20.0),
        start=rt.State({"x": 0.0, "v": 0.0}),
        end=rt.State({"x": 10.0, "v": 0.0}),
        controls={"u": rt.between(-1.0, 1.0)},
        objective=rt.Duration(),
    )
    replanner = rt.Replanner(move, mesh=rt.Mesh(20), solver=rt.InteriorPoint(tolerance=1e-8))
    for distance in (10.0, 6.0, 2.5):
        replan = replanner.step(0.0, rt.State({"x": 10.0 - distance, "v": 0.0}))
        assert replan.fresh
        assert replan.motion.duration == pytest.approx(2.0 * np.sqrt(distance), rel=1e-5)


@pytest.mark.parametrize("weight", [0.0, 1e-3])
def test_a_free_duration_of_a_robot_follows_the_speed_at_the_start(ur5, weight):
    """Speeds of the stretched motion would make the one at the start a coefficient of the duration."""
    cost = rt.Duration() + weight * rt.Effort() if weight else rt.Duration()
    reach = rt.Phase(ur5, (0.1, 5.0), rt.State(q=START, v=0), rt.State(q=GOAL, v=0), cost)
    replanner = rt.Replanner(reach, mesh=rt.Mesh(10))
    for speed in (0.0, 0.3, -0.2):
        start = rt.State(q=np.array(START) + 0.02, v=speed)
        replan = replanner.step(0.0, start)
        known = rt.plan(reach.with_(start=start), mesh=rt.Mesh(10))
        assert replan.fresh
        assert replan.motion.duration == pytest.approx(known.duration, rel=3e-3)
        assert np.allclose(replan.at(0.0).v, speed, atol=1e-6)


def test_bad_input(reach, ur5):
    with pytest.raises(rt.InputError, match="no rt.Periodic or rt.Mirror closes it"):
        rt.Replanner(rt.Problem([reach, reach.with_(start=None)], links=[rt.Continuity(0, 1)]))
    with pytest.raises(rt.InputError, match="fixed start"):
        rt.Replanner(reach.with_(start=rt.State(q=START)), mesh=rt.Mesh(10))
    with pytest.raises(rt.InputError, match="2 rt.CollisionFree; join them"):
        rt.Replanner(reach.with_(constraints=[rt.CollisionFree(), rt.CollisionFree()]), mesh=rt.Mesh(10))
    with pytest.raises(rt.InputError, match="but the problem has none"):
        rt.Replanner(reach, mesh=rt.Mesh(10)).step(0.0, rt.State(q=START, v=0), obstacles=[])
    with pytest.raises(rt.InputError, match="deadline"):
        rt.Replanner(reach, deadline=0.0)
    with pytest.raises(rt.InputError, match="rt.InteriorPoint"):
        rt.Replanner(reach, solver=rt.Ipopt())
    replanner = rt.Replanner(reach, mesh=rt.Mesh(10))
    with pytest.raises(rt.InputError, match="open"):
        replanner.step(0.0, rt.State(q=START))
    with pytest.raises(rt.InputError, match="rt.State"):
        replanner.step(0.0, START)
    with pytest.raises(rt.InputError):
        replanner.step(0.0, rt.State(q=np.full(6, np.nan), v=0))


def test_time_and_parameters_are_numbers_of_a_step():
    block = rt.System(states=["x", "v"], controls=["u"], dynamics=lambda point: [point.x["v"], point.u["u"]])

    def tracking(t0, amplitude):
        def rate(point):
            reference = point.p["amplitude"] * ca.sin(point.t + t0)
            return (point.x["x"] - reference) ** 2 + 1e-3 * point.u["u"] ** 2

        return rt.Phase(
            block,
            duration=1.0,
            start=rt.State({"x": 0.3, "v": 0.0}),
            objective=rt.Lagrange(rate) + 0.1 * rt.Mayer(lambda start, end: (end.x["x"] - end.p["amplitude"]) ** 2),
            controls={"u": rt.between(-5.0, 5.0)},
            constraints=[rt.PathConstraint(lambda point: point.x["x"] - point.p["amplitude"], upper=0.0)],
            parameters={"amplitude": amplitude},
        )

    replanner = rt.Replanner(tracking(0.0, 1.0), mesh=rt.Mesh(15), solver=rt.InteriorPoint(tolerance=1e-9))
    replan = replanner.step(2.0, rt.State({"x": 0.3, "v": 0.0}), parameters={"amplitude": 0.7})
    cold = rt.plan(tracking(2.0, 0.7), mesh=rt.Mesh(15), solver=rt.InteriorPoint(tolerance=1e-9))
    times = np.linspace(0.0, 1.0, 21)
    np.testing.assert_allclose(replan.at(2.0 + times).x["x"], cold.at(times).x["x"], atol=1e-6)
    np.testing.assert_allclose(replan.at(2.0 + times).u["u"], cold.at(times).u["u"], atol=1e-4)
    with pytest.raises(rt.InputError, match="amplitude"):
        replanner.step(2.0, rt.State({"x": 0.3, "v": 0.0}), parameters={"amplitud": 0.7})


def test_driven_pieces_are_those_of_the_plans(reach, tmp_path):
    replanner = rt.Replanner(reach, mesh=rt.Mesh(10))
    q, v, replans = START, np.zeros(6), []
    for t in (0.0, 0.1, 0.2):
        replans.append(replanner.step(t, rt.State(q=q, v=v)))
        reached = replans[-1].at(t + 0.1)
        q, v = reached.q, reached.v
    motion = rt.applications.driven(replans, until=0.3)
    for t, replan in zip((0.03, 0.13, 0.27), replans, strict=True):
        np.testing.assert_allclose(motion.at(t).q, replan.at(t).q, atol=1e-9)
        np.testing.assert_allclose(motion.at(t).tau, replan.at(t).tau, atol=1e-6)
    assert not motion.success and motion.duration == pytest.approx(0.3)
    assert rt.replay(motion, tmp_path / "driven.html").is_file()
    with pytest.raises(rt.InputError, match="ascend"):
        rt.applications.driven(replans, until=0.2)


@pytest.mark.slow
def test_every_knot_of_a_step_keeps_its_distance_from_obstacles_that_were_seen_elsewhere(reach, ur5):
    avoided = rt.CollisionFree([rt.obstacles.Sphere(0.1, (0.6, 0.1, 2.0))], margin=0.01)
    slow = reach.with_(duration=1.5, constraints=[avoided])
    replanner = rt.Replanner(slow, mesh=rt.Mesh(20, rt.HermiteSimpson()))
    start, least = rt.State(q=START, v=0), []
    tool = _tool(ur5, replanner.step(0.0, start).at(0.75).q)
    outwards = np.array([tool[0], tool[1], 0.0]) / np.hypot(tool[0], tool[1])
    # Its measured position approaches from step to step, until the tool would touch it.
    for away in np.linspace(0.3, 0.14, 9):
        seen = rt.obstacles.Sphere(0.1, tuple(tool + away * outwards))
        replan = replanner.step(0.0, start, obstacles=[seen])
        assert replan.fresh
        q = replan.at(replanner.first.phases[0].knots).q
        found = avoided.pairs(ur5).with_obstacles([seen]).distances(q, np.zeros(len(q)))
        least.append((found.min(), found[:, : avoided.pairs(ur5).against].min()))
    assert np.min(least[1:]) > 0.01 - 1e-4  # the first step still finds which shapes are near
    assert least[-1][1] < 0.02 < 0.04 < least[0][1]  # the obstacle blocks the path
    with pytest.raises(rt.InputError, match="must be 1 obstacles in the world"):
        replanner.step(0.0, start, obstacles=[])


def test_an_unfinished_step_is_gone_on_with_by_the_next(reach):
    few = rt.InteriorPoint(tolerance=1e-4, initial_barrier=1e-3, max_iterations=2)
    replanner = rt.Replanner(reach, mesh=rt.Mesh(20), solver=few)
    start, end = rt.State(q=START + 0.3, v=0), rt.State(q=GOAL - 0.3, v=0)
    replans = [replanner.step(0.0, start, end) for _ in range(15)]
    assert not replans[0].fresh and replans[0].status is rt.solvers.Status.ITERATION_LIMIT
    assert replans[-1].fresh


def _tool(robot, q):
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.frame("tool0")].translation
