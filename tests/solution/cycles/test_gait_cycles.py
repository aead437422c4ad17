"""A plan repeated several times: periods join, and mirrored feet stay at their footholds."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.gait.mirroring.mirror import mirror
from robotraj.problem.links.touchdown import Touchdown
from robotraj.solution.cycles.cycle_map import CycleMap, cycle_map_of
from robotraj.solution.cycles.gait_cycles import gait_cycles


@pytest.fixture(scope="module")
def step():
    """Half a gait of the five-link biped on a coarse mesh; left and right are exchanged at its heel strike."""
    robot = rt.load("five_link", root="planar")
    swing = rt.PathConstraint(lambda p: p.frame("right_foot").velocity[2], lower=0, name="swing foot up")
    landing = rt.PathConstraint(lambda p: p.frame("right_foot").velocity[2], upper=0, name="swing foot down")
    phase = rt.Phase(
        robot,
        duration=0.7,
        contacts=[rt.PointContact("left_foot", friction=5.0)],
        objective=rt.Effort(),
        constraints=[rt.GroundClearance("right_foot"), rt.AtStart(swing), rt.AtEnd(landing)],
        parameters={"left_foot.x": 0.0},
        name="step",
    )
    pairs = {"left_hip": "right_hip", "left_knee": "right_knee", "left_foot": "right_foot"}
    mirror = rt.Mirror(partners=pairs, displacement={"q.root_x": 0.5})
    q = {"root_z": 0.8, "root_pitch": 0.1, "left_hip": -0.4, "left_knee": 0.3, "right_hip": 0.2, "right_knee": 0.3}
    known = {name: q[name] for name in robot.position_names if name in q}
    start = rt.State(q=robot.configuration({"root_x": -0.25, **known}))
    end = rt.State(q=robot.configuration({"root_x": 0.25, **known, "left_hip": 0.2, "right_hip": -0.4}))
    problem = rt.Problem([phase], links=[Touchdown(0, 0, repeat=mirror)])
    mesh = rt.Mesh(6, rt.HermiteSimpson())
    solution = rt.plan(problem, mesh=mesh, guess=rt.guess.Keyframes([0, 1], [start, end]), check=False)
    assert solution.success
    return solution


def place(robot, frame, q):
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return np.array(data.oMf[robot.frame(frame)].translation)


def test_periods_join_displaced_and_mirrored(step):
    course = gait_cycles(step, 4)
    assert [cycle_phase.name for cycle_phase in course.phases] == ["step", "step (mirrored)"] * 2
    assert course.duration == pytest.approx(2.8)
    for before, after in zip(course.phases[:-1], course.phases[1:], strict=True):
        assert after.t0 == pytest.approx(before.t0 + before.duration, abs=1e-12)
        np.testing.assert_allclose(after.at(after.t0).q, before.at(after.t0).q, atol=1e-8)
        np.testing.assert_allclose(after.knots[0], before.knots[-1], atol=1e-12)
    first, third = course.phases[0].at(0.3), course.phases[2].at(1.7)
    gain = np.zeros(7)
    gain[0] = 1.0
    np.testing.assert_allclose(third.q - first.q, gain, atol=1e-12)
    np.testing.assert_allclose(third.v, first.v, atol=1e-12)
    np.testing.assert_allclose(third.forces["left_foot"], first.forces["left_foot"], atol=1e-9)


def test_in_mirrored_periods_the_other_foot_stands_and_carries(step):
    robot, (first, second) = step.phases[0].phase.robot, gait_cycles(step, 2).phases
    (contact,) = first.phase.bound_contacts
    assert (first.contact(contact), second.contact(contact)) == ("left_foot", "right_foot")
    here, later = first.at(0.2), second.at(0.9)
    np.testing.assert_allclose(later.forces["right_foot"], here.forces["left_foot"], atol=1e-9)
    for t in (0.75, 1.1, 1.4):
        standing = place(robot, "right_foot", second.at(t).q)
        np.testing.assert_allclose(standing[[0, 2]], [0.5, 0.0], atol=2e-4)
    np.testing.assert_allclose(second.points(place(robot, "left_foot", here.q)), place(robot, "right_foot", later.q))
    knees = [robot.position_names.index(name) for name in ("left_knee", "right_knee")]
    np.testing.assert_allclose(later.q[knees], here.q[knees[::-1]], atol=1e-12)
    motors = [robot.actuated.index(name) for name in ("left_knee", "right_knee")]
    np.testing.assert_allclose(later.tau[motors], here.tau[motors[::-1]], atol=1e-9)


def test_a_mirrored_period_is_a_motion_of_the_same_robot(step):
    """The residual of the equations of motion between nodes is the same for a plan and its mirror image."""
    robot = step.phases[0].phase.robot
    data = robot.model.createData()

    def missed(cycle_phase, t, foot):
        now, axes = cycle_phase.at(t), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        rows = pin.computeFrameJacobian(robot.model, data, now.q, robot.frame(foot), axes)[:3]
        needed = pin.rnea(robot.model, data, now.q, now.v, now.a) + robot.dissipation(now.v)
        return needed - robot.actuation @ now.tau - rows.T @ now.forces[foot]

    first, second = gait_cycles(step, 2).phases
    swap = [robot.velocity_names.index(second.cycle_map.partner(name)) for name in robot.velocity_names]
    for t in (0.05, 0.33, 0.6):
        here = missed(first, t, "left_foot")
        assert 1e-6 < np.abs(here).max() < 5.0
        np.testing.assert_allclose(missed(second, t + 0.7, "right_foot"), here[swap], atol=1e-9)


def test_impacts_come_at_the_end_of_every_period(step):
    impacts = gait_cycles(step, 3).impacts
    assert [impact.t for impact in impacts] == pytest.approx([0.7, 1.4, 2.1])
    assert [impact.after.period for impact in impacts] == [1, 2, 3]
    (contact,) = impacts[0].after.phase.bound_contacts
    assert [impact.after.contact(contact) for impact in impacts] == ["right_foot", "left_foot", "right_foot"]
    assert impacts[0].impulses == step.impulses[0]
    assert len(gait_cycles(step).impacts) == 1


def test_bounds_of_the_plan_change_sides(step):
    robot, cycle_phase = step.phases[0].phase.robot, gait_cycles(step, 2).phases[1]
    lower, upper = np.arange(7.0), np.full(7, np.inf)
    low, high = cycle_phase.bounds("q", lower, upper)
    names = robot.position_names
    assert low[names.index("left_hip")] == lower[names.index("right_hip")]
    assert low[names.index("root_x")] == lower[names.index("root_x")] + 0.5
    assert np.all(high == np.inf)


def test_a_mirror_with_signs_turns_bounds_and_moments_round():
    closing = CycleMap(np.diag([-1.0, 1.0]), np.zeros(2), np.diag([-1.0, 1.0]), {}, np.diag([1.0, -1.0, 1.0]))
    wrench = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    np.testing.assert_array_equal(closing.forces_onwards(wrench), [1.0, -2.0, 3.0, -4.0, 5.0, -6.0])
    arm, force = np.array([0.3, -0.2, 0.5]), np.array([1.0, 2.0, 3.0])
    moment = closing.forces_onwards(np.concatenate([force, np.cross(arm, force)]))[3:]
    np.testing.assert_allclose(moment, np.cross(closing.points_onwards(arm), closing.forces_onwards(force)))
    robot = SimpleNamespace(actuation=np.eye(2))
    planned = SimpleNamespace(phase=SimpleNamespace(robot=robot, name="half"), t0=0.0, duration=1.0, knots=[0.0, 1.0])
    course = gait_cycles(SimpleNamespace(phases=(planned,), problem=SimpleNamespace(links=()), impulses=()))
    low, high = (
        type(course)(course.solution, 2, closing).phases[1].bounds("q", np.array([-1.0, 0.0]), np.array([np.inf, 2.0]))
    )
    np.testing.assert_array_equal(low, [-np.inf, 0.0])
    np.testing.assert_array_equal(high, [1.0, 2.0])


def test_a_plan_that_ends_elsewhere_is_followed_once(step):
    phase = rt.Phase(rt.load("double_pendulum"), duration=1.0, limits=None, name="reach")
    planned = SimpleNamespace(phase=phase, t0=0.0, duration=1.0)
    lone = SimpleNamespace(phases=(planned,), problem=SimpleNamespace(links=()), impulses=())
    assert cycle_map_of(lone) is None
    assert len(gait_cycles(lone).phases) == 1
    with pytest.raises(rt.InputError, match="ends elsewhere"):
        gait_cycles(lone, 2)
    for periods in (0, -1, 1.5, True, "2"):
        with pytest.raises(rt.InputError, match="periods"):
            gait_cycles(step, periods)


def test_a_mirrored_quadruped_stands_and_moves_as_its_mirror_image():
    """Frames of a floating robot a period later: places, linear and angular velocities of the partner's frame."""
    robot = rt.load("solo12", root="floating")
    rng = np.random.default_rng(3)
    pin.seed(3)
    root = np.concatenate([[0.1, 0.3, 0.25], pin.Quaternion.Identity().coeffs()])
    joints = np.array(robot.neutral)[7:] + 0.2 * rng.standard_normal(12)
    q = pin.integrate(robot.model, np.concatenate([root, joints]), np.r_[0.1 * rng.standard_normal(6), np.zeros(12)])
    v, tau = rng.standard_normal(18), rng.standard_normal(12)
    wrench = rng.standard_normal(6)
    phase = rt.Phase(robot, duration=0.2, contacts=[rt.PointContact("FL_FOOT")], name="half")
    sample = SimpleNamespace(q=q, v=v, a=v, tau=tau, forces={"FL_FOOT": wrench})
    planned = SimpleNamespace(phase=phase, t0=0.0, duration=0.2, knots=[0.0, 0.2], at=lambda t, interval=None: sample)
    closing = mirror(robot, displacement={"q.root_x": 0.4})
    course = gait_cycles(SimpleNamespace(phases=(planned,), problem=SimpleNamespace(links=[closing]), impulses=()), 2)
    second = course.phases[1]
    later = second.at(0.3)
    assert list(later.forces) == ["FR_FOOT"]
    np.testing.assert_allclose(later.forces["FR_FOOT"], wrench * [1, -1, 1, -1, 1, -1])
    assert np.linalg.norm(later.q[3:7]) == pytest.approx(1.0)

    def moving(frame, q, v):
        data, index = robot.model.createData(), robot.frame(frame)
        pin.forwardKinematics(robot.model, data, q, v)
        pin.updateFramePlacements(robot.model, data)
        motion = pin.getFrameVelocity(robot.model, data, index, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        return np.array(data.oMf[index].translation), np.array(motion.vector)

    for one, other in (("FL_FOOT", "FR_FOOT"), ("HR_FOOT", "HL_FOOT"), ("base_link", "base_link")):
        here, there = moving(one, q, v), moving(other, later.q, later.v)
        np.testing.assert_allclose(there[0], here[0] * [1, -1, 1] + [0.4, 0, 0], atol=1e-3)
        np.testing.assert_allclose(second.points(here[0]), here[0] * [1, -1, 1] + [0.4, 0, 0], atol=1e-12)
        np.testing.assert_allclose(there[1], second.forces(here[1]), atol=5e-3)
    power = [now.tau @ (robot.actuation.T @ now.v) for now in (sample, later)]
    assert power[0] == pytest.approx(power[1])
