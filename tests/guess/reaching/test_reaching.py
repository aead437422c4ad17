"""Ends given as poses: every branch reaches the pose, the fastest is used, and successive poses need no guess."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.guess import StraightLine
from robotraj.guess.reaching.branches import reached_ends
from robotraj.robot.collision.own_body import own_body


@pytest.fixture(scope="module")
def arm():
    return rt.load("ur10")


def _pose(robot, q, frame="tool0"):
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, np.asarray(q))
    return pin.SE3(data.oMf[robot.frame(frame)])


def _reach(robot, seed):
    """Return a phase from a random configuration to the pose of the tool at another one, in least time."""
    q0, q1 = np.random.default_rng(seed).uniform(-np.pi, np.pi, (2, robot.nq))
    goal = rt.AtEnd(rt.FramePose("tool0", _pose(robot, q1)))
    ends = rt.State(q=q0, v=0), rt.State(v=0)
    # Drawn configurations may fold the arm through itself, which is not what is tested here.
    return rt.Phase(robot, (0.05, 20.0), *ends, rt.Duration(), [goal], self_collision=False), q0, q1


def test_branches_reach_the_pose_within_the_limits_and_differ(arm):
    phase, q0, q1 = _reach(arm, 2)
    wanted = _pose(arm, q1)
    found = []
    for branch in range(4):
        first, last = reached_ends(rt.Problem([phase]), branch)[0]
        assert np.array_equal(first, q0)
        assert np.linalg.norm(pin.log6(wanted.actInv(_pose(arm, last))).vector) < 1e-5
        assert np.all((last >= arm.limits.positions[0]) & (last <= arm.limits.positions[1]))
        found.append(last)
    slowest = [np.max(np.abs(last - q0) / arm.limits.velocity) for last in found]
    assert slowest == sorted(slowest)
    assert min(np.max(np.abs(a - b)) for i, a in enumerate(found) for b in found[:i]) > 0.3


@pytest.mark.parametrize("seed", [2, 3, 5, 7])
def test_a_reachable_pose_is_reached_in_less_time_than_by_the_configuration_that_defined_it(arm, seed):
    phase, _, q1 = _reach(arm, seed)
    found = rt.plan(phase)
    other = rt.plan(phase.with_(constraints=[], end=rt.State(q=q1, v=0)))
    assert found.duration < other.duration * (1 + 1e-3)


def test_free_joints_move_towards_the_start():
    """A panda has a joint to spare: the end of a line to its own pose is its own configuration."""
    robot = rt.load("panda", locked={"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.02})
    q = np.array([0.3, -0.6, 0.2, -2.2, 0.1, 1.7, 0.5])
    far = q + np.array([0.9, 0.3, -0.8, 0.4, 0.5, -0.3, 0.6])
    goal = rt.AtEnd(rt.FramePose("panda_hand_tcp", _pose(robot, far, "panda_hand_tcp")))
    phase = rt.Phase(robot, (0.05, 20.0), rt.State(q=q, v=0), rt.State(v=0), rt.Duration(), [goal])
    _, last = reached_ends(rt.Problem([phase]))[0]
    assert np.max(np.abs(last - q) / robot.limits.velocity) <= np.max(np.abs(far - q) / robot.limits.velocity) + 1e-9


def test_three_poses_without_a_stop_need_no_guess(arm):
    rng = np.random.default_rng(1)
    q = rng.uniform(-np.pi, np.pi, (4, arm.nq))
    phases = [
        rt.Phase(
            arm,
            (0.05, 10.0),
            start=rt.State(q=q[0], v=0) if k == 0 else None,
            end=rt.State(v=0) if k == 2 else None,
            objective=rt.Duration(),
            constraints=[rt.AtEnd(rt.FramePose("tool0", _pose(arm, q[k + 1])))],
            name=f"leg {k}",
        )
        for k in range(3)
    ]
    solution = rt.plan(rt.Problem(phases, [rt.Continuity(0, 1), rt.Continuity(1, 2)]))
    for k in range(3):
        error = _pose(arm, q[k + 1]).actInv(_pose(arm, solution.phases[k].at(solution.phases[k].knots[-1]).q))
        assert np.linalg.norm(pin.log6(error).vector) < 1e-5
    assert np.linalg.norm(solution.at(solution.phases[0].duration).v) > 0.1


def test_starts_of_a_multistart_end_at_different_branches(arm):
    phase, _, _ = _reach(arm, 2)
    ends = [StraightLine(branch=i).prepared(rt.Problem([phase])).of(phase, 0).states(np.ones(1))[0, :6] for i in (0, 1)]
    assert np.max(np.abs(ends[0] - ends[1])) > 0.3


def test_an_unreachable_pose_keeps_the_line_of_its_bounds(arm):
    goal = rt.AtEnd(rt.FramePosition("tool0", (5.0, 0.0, 0.0)))
    phase = rt.Phase(arm, (0.05, 20.0), rt.State(q=0.1, v=0), rt.State(v=0), rt.Duration(), [goal])
    first, last = reached_ends(rt.Problem([phase]))[0]
    assert np.isnan(last).all() and np.allclose(first, 0.1)


@pytest.mark.parametrize("seed", range(6))
def test_a_narrow_angle_about_the_pose_leaves_the_fastest_branch(arm, seed):
    """Its row is some hundred times as steep as those of the pose."""
    phase, _, q1 = _reach(arm, seed)
    along = _pose(arm, q1).rotation[:, 2]
    narrow = rt.AtEnd(rt.constraints.FrameAxis("tool0", axis=(0, 0, 1), direction=along, angle=np.deg2rad(0.1)))
    both = phase.with_(constraints=[*phase.constraints, narrow])
    (_, last), (_, same) = (reached_ends(rt.Problem([each]))[0] for each in (phase, both))
    np.testing.assert_allclose(same, last, atol=1e-4)


def test_a_branch_at_which_links_overlap_is_left_for_another_one():
    """The wrist reaches into the upper arm at the fastest branch; another branch has the same pose without that."""
    arm = rt.load("ur5")
    body, q1 = own_body(arm), np.array([0.02, -2.94, 2.59, 0.02, -1.07, 0.26])
    assert body.touching(arm, q1)
    goal = rt.AtEnd(rt.FramePose("tool0", _pose(arm, q1)))
    ends = rt.State(q=(0, -1.5, 1, -1, 0.5, 0), v=0), rt.State(v=0)
    phase = rt.Phase(arm, (0.1, 10.0), *ends, rt.Duration(), [goal])
    (_, anyway), (_, last) = (
        reached_ends(rt.Problem([each]))[0] for each in (phase.with_(self_collision=False), phase)
    )
    assert body.touching(arm, anyway) and not body.touching(arm, last)
    found = rt.plan(phase)
    assert found.proof.holds and not body.touching(arm, found.at(found.duration).q)
