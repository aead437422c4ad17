"""Several phases: divided motions have the same optimum; phases of different dynamics; jumps in simulation."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt

MASS = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]], units={"x": "m", "v": "m/s", "u": "N"})
EXACT = rt.Ipopt(tolerance=1e-11)


def part(k: int, count: int) -> rt.Phase:
    return rt.Phase(
        MASS,
        (0.001, 1.0),
        rt.State([0, 0]) if k == 0 else None,
        rt.State([1, 0]) if k == count - 1 else rt.State({"x": (k + 1) / count}),
        rt.Duration(),
        states={"x": rt.between(0, 1), "v": rt.between(0, 10)},
        controls={"u": rt.between(-20, 20)},
        name=f"part {k + 1}",
    )


def slide(count: int) -> rt.Problem:
    return rt.Problem([part(k, count) for k in range(count)], [rt.Continuity(k, k + 1) for k in range(count - 1)])


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_the_sliding_mass_takes_one_time_however_many_phases_it_slides_through(count: int) -> None:
    mesh = rt.schemes.MovingMesh(4, rt.schemes.RadauIIA(3, control=rt.schemes.ConstantControl()))
    solution = rt.plan(slide(count), mesh, solver=EXACT)
    assert solution.objective == pytest.approx(2 / np.sqrt(20), abs=1e-8)
    assert solution.duration == pytest.approx(2 / np.sqrt(20), abs=1e-8)
    exact = np.sqrt([2 * k / count / 20 for k in range(count // 2 + 1)])
    assert [solution.phases[k].t0 for k in range(count // 2 + 1)] == pytest.approx(list(exact), abs=1e-6)


def test_each_phase_has_its_own_scheme_and_mesh() -> None:
    """From rest to rest over 1 m in 1 s: a cubic, exact in schemes of third degree and more."""
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    phases = [
        rt.Phase(MASS, 0.2, rt.State([0, 0]), objective=effort),
        rt.Phase(MASS, 0.5, objective=effort),
        rt.Phase(MASS, 0.3, end=rt.State([1, 0]), objective=effort),
    ]
    meshes = [rt.Mesh(1), rt.Mesh([0, 0.7, 1], rt.schemes.GaussLegendre(3)), rt.Mesh(4, rt.schemes.RadauIIA(3))]
    problem = rt.Problem(phases, [rt.Continuity(0, 1), rt.Continuity(1, 2)])
    solution = rt.plan(problem, meshes, solver=EXACT)
    assert solution.objective == pytest.approx(12, rel=1e-10)
    assert [p.mesh.count for p in solution.phases] == [1, 2, 4]
    times = np.linspace(0, 1, 30)
    np.testing.assert_allclose(solution.at(times).x["x"], 3 * times**2 - 2 * times**3, atol=1e-9)


def test_phases_of_other_dynamics_and_other_states() -> None:
    """One second pushed, then one second driven at a speed that is chosen: v2 from x(1) costs (1 - x)^2 on top."""
    drive = rt.System(["y"], ["w"], lambda point: [point.u["w"]])
    push = rt.Phase(MASS, 1.0, rt.State([0, 0]), objective=rt.Lagrange(lambda point: point.u["u"] ** 2))
    ride = rt.Phase(drive, 1.0, end=rt.State([1]), objective=rt.Lagrange(lambda point: point.u["w"] ** 2))
    links = [
        rt.links.Linkage((0, 1), lambda a, b: b.start.x["y"] - a.end.x["x"], name="place"),
        rt.links.Linkage((0, 1), lambda a, b: b.start.t - a.end.t, name="time"),
    ]
    solution = rt.plan(rt.Problem([push, ride], links), rt.Mesh(4), solver=EXACT)
    # A push of d in 1 s with the last speed free costs 3 d^2: d = 1/4, 3/16 + 9/16.
    assert solution.objective == pytest.approx(0.75, rel=1e-9)
    assert solution.at(1.5).x["y"] == pytest.approx(0.625, abs=1e-9)


def test_every_phase_is_refined_where_it_needs_it() -> None:
    """A swing-up, then a cubic that any mesh meets."""
    pendulum = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"] - 9.81 * ca.sin(point.x["x"])])
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    up = rt.Phase(pendulum, 1.0, rt.State([0, 0]), rt.State([np.pi, 0]), effort, name="up")
    on = rt.Phase(MASS, 1.0, None, rt.State([4, 0]), effort, name="on")
    solution = rt.plan(rt.Problem([up, on], [rt.Continuity(0, 1)]), rt.Mesh(8, rt.schemes.RadauIIA(3)), tolerance=1e-6)
    assert solution.success and solution.refinement[-1].error <= 1e-6
    assert len(solution.phases[0].points) > 2 * len(solution.phases[1].points)
    assert solution.phases[1].mesh.count == 8


def bounce() -> rt.Solution:
    """To a wall with at least 1 m/s and back with 80 % of the speed."""
    effort = rt.Lagrange(lambda point: point.u["u"] ** 2)
    limits = {"controls": {"u": rt.between(-20, 20)}, "objective": effort}
    phases = [
        rt.Phase(MASS, 1.0, rt.State([0, 0]), rt.State({"x": 0.5, "v": rt.between(1, None)}), name="out", **limits),
        rt.Phase(MASS, 1.0, rt.State({"x": 0.5}), rt.State([0, 0]), name="home", **limits),
    ]
    links = [
        rt.links.Jump(0, 1, {"v": None}),
        rt.links.Linkage((0, 1), lambda a, b: b.start.x["v"] + 0.8 * a.end.x["v"], name="restitution", unit="m/s"),
    ]
    return rt.plan(rt.Problem(phases, links), rt.Mesh(6))


def test_the_witness_follows_a_plan_over_its_jump() -> None:
    solution = bounce()
    report = rt.validate(solution)
    report.check(drift=1e-7, limits=1e-7)
    assert report.phases == ("out", "home")


def test_the_witness_sees_a_phase_that_is_not_where_the_last_one_ended() -> None:
    """The same plan under links that let nothing jump."""
    solution = bounce()
    problem = rt.Problem(solution.problem.phases, [rt.Continuity(0, 1)])
    without = rt.Solution(**{**vars(solution), "problem": problem})
    report = rt.validate(without)
    assert not report.passed
    with pytest.raises(rt.ValidationFailed, match="phase 'home'"):
        report.check()


def swing(**more: Any) -> rt.Phase:
    robot = rt.load("pendulum")
    return rt.Phase(robot, 2.0, objective=rt.Effort(), limits=robot.limits.with_(position=(-10, 10)), **more)


def test_a_robot_that_turns_once_in_a_period() -> None:
    """A pendulum that goes over the top every 2 s, each time as the time before."""
    phase = swing(start=rt.State(q=0))
    solution = rt.plan(rt.Problem([phase], [rt.Periodic({"q.pivot": 2 * np.pi})]), rt.Mesh(20))
    first, last = solution.at(0.0), solution.at(2.0)
    assert last.q - first.q == pytest.approx([2 * np.pi], abs=1e-9)
    assert last.v == pytest.approx(first.v, abs=1e-9)
    assert first.v[0] > 1
    # By symmetry it is upright at half of the duration.
    assert solution.at(1.0).q == pytest.approx([np.pi], abs=0.2)
    rt.validate(solution).check(drift=1e-3)


def test_a_robot_whose_joints_change_places() -> None:
    robot = rt.load("two_link_arm")
    phase = rt.Phase(robot, 1.5, rt.State(q=[0.1, 0.4]), objective=rt.Effort())
    solution = rt.plan(rt.Problem([phase], [rt.Mirror({"shoulder": "elbow"}, negated=["elbow"])]), rt.Mesh(10))
    first, last = solution.at(0.0), solution.at(1.5)
    assert last.q == pytest.approx([0.4, -0.1], abs=1e-9)
    assert last.v == pytest.approx([first.v[1], -first.v[0]], abs=1e-9)
    assert np.linalg.norm(first.v) > 0.01


def test_robots_in_phases_with_a_kick_at_a_joint() -> None:
    """A block on its slider: a kick of 1 m/s towards the goal at half time."""
    robot = rt.load("block")
    phases = [
        rt.Phase(robot, 1.0, rt.State(q=[0], v=0), objective=rt.Effort(), limits=None),
        rt.Phase(robot, 1.0, None, rt.State(q=[1], v=0), objective=rt.Effort(), limits=None),
    ]
    solution = rt.plan(rt.Problem(phases, [rt.links.Jump(0, 1, {"v.slider": 1.0})]), rt.Mesh(4), solver=EXACT)
    # The remaining motion is 0 m and -1 m/s in 2 s, which costs 4 w^2 / T with a unit mass.
    assert solution.objective == pytest.approx(2.0, rel=1e-8)
    assert solution.phases[1].at(1.0).v[0] - solution.phases[0].at(1.0).v[0] == pytest.approx(1, abs=1e-9)
    rt.validate(solution).check(drift=1e-7)


def test_an_error_names_the_phase() -> None:
    with pytest.raises(rt.InputError, match="'part 2'"):
        rt.Phase(MASS, 1.0, rt.State([0, 5]), states={"v": rt.between(-1, 1)}, name="part 2")
    solution = rt.plan(slide(2), rt.Mesh(4))
    with pytest.raises(rt.InputError, match="'part 2'"):
        solution.phases[1].at(0.0)
    with pytest.raises(rt.InputError, match="mesh"):
        rt.plan(slide(2), [rt.Mesh(4)])
    impossible = rt.Problem(
        [part(0, 2), part(1, 2)], [rt.Continuity(0, 1), rt.links.Linkage((1,), lambda b: b.end.t - 0.1)]
    )
    with pytest.raises(rt.NoSolutionFound, match=r"'part 1' and 'part 2' were not solved") as caught:
        rt.plan(impossible, rt.Mesh(4))
    worst = caught.value.solution.violations(1)[0]
    assert worst.phase in ("part 1", "part 2")
    assert f"{worst} (phase {worst.phase!r})" in str(caught.value)
