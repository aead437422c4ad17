"""Robots with a moving root in all of the package: plan, validate, sample, save, plot, export, replay, warm start."""

from __future__ import annotations

import csv
import json
import pickle
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.replay_page.charts.curves import robot_panels

GRAVITY = np.array([0.0, 0.0, -9.81])
DURATION = 0.3
ENERGETIC = {"effort": 50.0}


def thrown(root):
    """A hopper that is released in the air, rotates, and swings its leg."""
    robot = rt.load("hopper", root=root, limits=ENERGETIC)
    speed = {"planar": {"root_x": 1.0, "root_z": 2.0, "root_pitch": 1.5}}.get(
        root, {"root_vx": 1.0, "root_vy": -0.4, "root_vz": 2.0, "root_wx": 0.7, "root_wy": 1.5, "root_wz": -0.6}
    )
    start = rt.State(q=robot.configuration({"root_z": 1.0}), v=robot.velocity(speed))
    return rt.Phase(robot, DURATION, start=start, end=rt.State(q={"hip": 0.4}), objective=rt.Effort())


@pytest.fixture(scope="module", params=["planar", "floating"])
def plan(request):
    return rt.plan(thrown(request.param), rt.Mesh(8))


def center(plan, t):
    robot, sample = plan.phases[0].robot, plan.at(t)
    data = robot.model.createData()
    position = np.array(pin.centerOfMass(robot.model, data, sample.q, sample.v))
    momentum = pin.computeCentroidalMomentum(robot.model, data, sample.q, sample.v).angular
    return position, np.array(data.vcom[0]), np.array(momentum)


def test_the_centre_of_mass_falls_on_a_parabola_and_angular_momentum_stays(plan):
    position, velocity, momentum = center(plan, 0.0)
    for t in np.linspace(0, DURATION, 5)[1:]:
        here, speed, turning = center(plan, t)
        np.testing.assert_allclose(here, position + velocity * t + 0.5 * GRAVITY * t**2, atol=1e-6)
        np.testing.assert_allclose(speed, velocity + GRAVITY * t, atol=2e-6)
        np.testing.assert_allclose(turning, momentum, atol=2e-6)


def test_samples_have_the_sizes_of_the_robot_and_unit_quaternions(plan):
    robot, times = plan.phases[0].robot, np.linspace(0, DURATION, 41)
    sample = plan.at(times)
    assert sample.q.shape == (41, robot.nq)
    assert sample.v.shape == sample.a.shape == (41, robot.nv)
    assert sample.tau.shape == (41, 2)
    if robot.root == "floating":
        np.testing.assert_allclose(np.linalg.norm(sample.q[:, 3:7], axis=1), 1.0, atol=1e-15)
        at_knots = plan.phases[0].trajectory.x(plan.knots)[:, 3:7]
        np.testing.assert_allclose(np.linalg.norm(at_knots, axis=1), 1.0, atol=1e-9)
    assert plan.at(0.1).x["q.root_z"] == pytest.approx(plan.at(0.1).q[robot.position_names.index("root_z")])


def test_the_witness_agrees(plan):
    report = rt.validate(plan)
    assert report.passed
    assert report.drift.worst.largest < 1e-6
    names = {"planar": "q.root_pitch", "floating": "q.root_ry"}
    assert names[plan.phases[0].robot.root] in report.drift
    assert all(peak.value < 1e-3 for peak in report.residual.rate.values())


def test_feedback_brings_the_joints_back(plan):
    robot = plan.phases[0].robot
    away = np.zeros(2 * robot.nv)
    away[robot.joint("hip")] = 0.02
    tracking = rt.witness.track(plan, kp=80.0, kd=8.0, offset=away)
    assert tracking.failure is None
    assert tracking.error["q.hip"].final < 0.2 * tracking.error["q.hip"].largest
    with pytest.raises(rt.InputError, match="offset has 3 values"):
        rt.witness.track(plan, kp=1.0, kd=1.0, offset=np.zeros(3))


def test_files_keep_the_plan(plan, tmp_path):
    again = rt.load_solution(plan.save(tmp_path / "thrown"))
    robot, known = again.phases[0].robot, plan.phases[0].robot
    assert (robot.root, robot.position_names, robot.limits.free) == (
        known.root,
        known.position_names,
        known.limits.free,
    )
    np.testing.assert_array_equal(again.at(0.2).q, plan.at(0.2).q)
    np.testing.assert_array_equal(robot.neutral, known.neutral)
    copied = pickle.loads(pickle.dumps(plan.problem.phases[0]))
    assert copied.robot.velocity_names == known.velocity_names


def test_tables_name_positions_and_velocities(plan, tmp_path):
    robot = plan.phases[0].robot
    with plan.to_csv(tmp_path / "thrown.csv", 11).open(encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    names = [entry.split(" ")[0] for entry in head]
    expected = [f"q.{n}" for n in robot.position_names] + [f"{k}.{n}" for k in "va" for n in robot.velocity_names]
    assert names == ["t", *expected, "tau.hip", "tau.leg"]
    assert len(rows) == 11
    assert json.loads(plan.to_json(tmp_path / "thrown.json", 5).read_text(encoding="utf-8"))


def test_plots_and_replays_show_the_root(plan, tmp_path):
    robot = plan.phases[0].robot
    figure = plan.plot()
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert ("quaternion" in titles) == (robot.root == "floating")
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert set(robot.position_names) | set(robot.velocity_names) <= set(legend)
    rt.replay(plan, tmp_path / "thrown.html")
    panels = {panel.title: panel for panel in robot_panels(robot)}
    sample = plan.at(np.array([0.0, 0.1]))
    for title, names, values in (
        ("Joint position", robot.position_names, sample.q),
        ("Joint velocity", robot.velocity_names, sample.v),
    ):
        assert [series.label for series in panels[title].series] == list(names)
        np.testing.assert_array_equal(panels[title].read(sample), values)


@pytest.mark.parametrize(
    "guess",
    [rt.guess.StraightLine(), rt.guess.MinimumJerk(), rt.planning.Kinematic(rt.Mesh(5))],
    ids=lambda g: type(g).__name__,
)
def test_the_plan_is_found_from_every_guess(plan, guess):
    phase = plan.problem.phases[0]
    assert rt.plan(phase, rt.Mesh(8), guess).objective == pytest.approx(plan.objective, rel=1e-4)


def test_a_plan_is_a_guess_for_the_next(plan):
    phase = plan.problem.phases[0]
    again = rt.plan(phase, rt.Mesh(8, rt.schemes.RadauIIA(3)), guess=plan)
    assert again.objective == pytest.approx(plan.objective, rel=1e-4)


@pytest.mark.parametrize(
    "objective",
    [rt.objectives.TorqueRate(), rt.objectives.Jerk(), rt.objectives.MechanicalWork() + rt.Effort()],
    ids=str,
)
def test_objectives_that_bring_variables(plan, objective):
    phase = replace(plan.problem.phases[0], objective=objective)
    assert rt.plan(phase, rt.Mesh(8), guess=plan).success


def test_forward_dynamics_finds_the_same(plan):
    phase = replace(plan.problem.phases[0], dynamics=rt.dynamics.ForwardDynamics())
    assert rt.plan(phase, rt.Mesh(8)).objective == pytest.approx(plan.objective, rel=1e-6)


def test_following_a_plan_gives_it_back(plan):
    phase = replace(plan.problem.phases[0], objective=rt.objectives.Tracking(plan, q=1.0, v=0.1))
    followed = rt.plan(phase, rt.Mesh(8), guess=plan)
    assert followed.objective < 1e-7
    np.testing.assert_allclose(followed.at(0.2).q, plan.at(0.2).q, atol=1e-3)


def test_limits_of_the_root_by_name_hold(plan):
    phase = plan.problem.phases[0]
    turn = {"planar": "root_pitch", "floating": "root_wy"}[phase.robot.root]
    with pytest.raises(rt.InputError, match=f"start velocity of '{turn}' is 1.5 rad/s"):
        rt.plan(replace(phase, limits=phase.limits.with_(velocity={turn: 1.4})), rt.Mesh(8))
    bound = rt.constraints.JointPosition({"root_z": rt.between(1.0, 1.02)})
    with pytest.raises(rt.NoSolutionFound):
        rt.plan(replace(phase, constraints=[bound]), rt.Mesh(8))


def test_a_somersault_is_planned_by_the_negative_quaternion():
    robot = rt.load("hopper", root="floating", limits=ENERGETIC)
    start = robot.configuration({"root_z": 1.0})
    end = {"root_qx": 0, "root_qy": 0, "root_qz": 0, "root_qw": -1}
    phase = rt.Phase(robot, (0.3, 2.0), start=rt.State(q=start), end=rt.State(q=end), objective=rt.Effort())
    plan = rt.plan(phase, rt.Mesh(40))
    assert rt.validate(plan).passed
    turned = np.trapezoid(plan.at(np.linspace(0, plan.duration, 2001)).v[:, 3:6], dx=plan.duration / 2000, axis=0)
    assert np.linalg.norm(turned) == pytest.approx(2 * np.pi, rel=1e-2)


def test_a_quadruped_turns_once_in_the_air_by_the_default_call():
    robot = rt.load("solo12", root="floating")
    pose = np.array(rt.gait.stand(robot, ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")))
    turned = pose.copy()
    turned[3:7] *= -1
    # The legs fold through each other by least effort, which is not what is tested here.
    ends = rt.State(q=pose), rt.State(q=turned)
    plan = rt.plan(rt.Phase(robot, (0.3, 1.0), *ends, rt.Effort(), self_collision=False))
    assert plan.proof.holds and rt.validate(plan).passed
    rates = plan.at(np.linspace(0, plan.duration, 2001)).v[:, 3:6]
    angle = np.linalg.norm(np.trapezoid(rates, dx=plan.duration / 2000, axis=0))
    assert angle == pytest.approx(2 * np.pi, rel=1e-2)


@pytest.mark.parametrize("scheme", [rt.HermiteSimpson(), rt.schemes.LobattoIIIA(4), rt.schemes.RadauIIA(2)])
def test_a_quaternion_does_not_cross_zero_to_its_negative(scheme):
    # At 1 rad/s no full turn fits into half a second; a quaternion that shrank between two points would count as one.
    robot = rt.load("hopper", root="floating", limits=ENERGETIC)
    end = {"root_qx": 0, "root_qy": 0, "root_qz": 0, "root_qw": -1}
    slow = {f"v.root_w{axis}": rt.between(-1.0, 1.0) for axis in "xyz"}
    start = rt.State(q=robot.configuration({"root_z": 1.0}))
    phase = rt.Phase(robot, 0.5, start=start, end=rt.State(q=end), objective=rt.Effort(), states=slow)
    plan = rt.plan(phase, rt.Mesh(6, scheme), check=False)
    assert plan.status is rt.solvers.Status.NOT_FOUND
    assert plan.conflicts[0].name.startswith("state bound, root_w")


def test_costates_of_a_quaternion_are_refused_by_name(plan):
    if plan.phases[0].robot.root == "planar":
        assert rt.indirect.costates(plan).at(0.1).x["v.root_x"] == pytest.approx(0.0, abs=1.0)
        return
    with pytest.raises(rt.InputError, match="quaternion of a floating root"):
        rt.indirect.costates(plan)
