"""Goals among obstacles: branches that are clear are preferred, and goals without one are named."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.fixed_mesh.diagnosis.explain import blocked_ends
from robotraj.guess.reaching.branches import nodes_of
from robotraj.solvers.status import Status

HOME = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])


@pytest.fixture(scope="module")
def arm():
    return rt.load("ur5")


def place(arm, q, frame="tool0"):
    data = arm.model.createData()
    pin.framesForwardKinematics(arm.model, data, q)
    return pin.SE3(data.oMf[arm.frame(frame)])


def reach(arm, goal, *obstacles):
    ends = rt.State(q=HOME, v=0), rt.State(v=0)
    free = [rt.CollisionFree(list(obstacles))] if obstacles else []
    return rt.Phase(arm, (0.1, 10.0), *ends, rt.Duration(), [rt.AtEnd(rt.FramePose("tool0", goal)), *free])


def test_a_goal_goes_to_a_branch_that_is_clear_of_obstacles(arm):
    goal = place(arm, HOME + [0.9, 0.2, -0.3, 0.3, 0.4, 1.0])
    reached = nodes_of(rt.Problem([reach(arm, goal)]))[0][1].reached(HOME)
    wrist = place(arm, reached[0], "wrist_1_link").translation
    phase = reach(arm, goal, rt.obstacles.Sphere(0.05, wrist))
    node = nodes_of(rt.Problem([phase]))[0][1]
    assert node.clearance(reached).min() < 0.0 < node.clearance(reached).max()
    assert node.clearance(node.reached(HOME)).min() >= 0.0
    assert blocked_ends(rt.Problem([phase])) == ()
    assert rt.plan(phase).proof.holds


def test_a_goal_inside_an_obstacle_is_named(arm):
    goal = place(arm, HOME + [0.9, 0.2, -0.3, 0.3, 0.4, 1.0])
    problem = rt.Problem([reach(arm, goal, rt.obstacles.Sphere(0.15, goal.translation))])
    (conflict,) = blocked_ends(problem)
    assert "and sphere" in conflict.name and conflict.needed < -0.1 and "at the end" in conflict.reason
    failed = rt.plan(problem, rt.Mesh(4), solver=rt.InteriorPoint(max_iterations=20), check=False)
    assert failed.status is not Status.NOT_ON_THIS_MESH and "clearance" in str(failed)


def test_without_obstacles_nothing_is_searched(arm):
    problem = rt.Problem([reach(arm, place(arm, HOME))])
    assert blocked_ends(problem) == ()
