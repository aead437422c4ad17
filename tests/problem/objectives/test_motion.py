"""Momentum and smoothness of frames as costs, against plain Pinocchio integrated over the plan."""

from __future__ import annotations

import pinocchio as pin
import pytest
from scipy.integrate import quad_vec

import robotraj as rt


@pytest.fixture(scope="module")
def robot() -> rt.Robot:
    return rt.load("two_link_arm")


def move(robot: rt.Robot, objective: object) -> rt.Solution:
    phase = rt.Phase(
        robot, duration=4.0, start=rt.State(q=0, v=0), end=rt.State(q=[0.6, -0.4], v=0), objective=objective
    )
    return rt.plan(phase, mesh=rt.Mesh(30, rt.schemes.LobattoIIIA(4)))


def test_centroidal_momentum_is_the_integral_of_pinocchios(robot: rt.Robot) -> None:
    # A little effort beside it makes the optimum smooth.
    solution = move(robot, rt.objectives.CentroidalMomentum(angular=[0, 0, 2.0], linear=0.5) + 1e-2 * rt.Effort())
    cost = quad_vec(lambda t: _momentum(robot, solution, t), 0, 4, epsabs=1e-10)[0]
    effort = quad_vec(lambda t: float((solution.at(t).tau ** 2).sum()), 0, 4, epsabs=1e-10)[0]
    assert solution.objective == pytest.approx(cost + 1e-2 * effort, rel=1e-5)
    least = move(robot, rt.Effort())
    assert cost < quad_vec(lambda t: _momentum(robot, least, t), 0, 4, epsabs=1e-10)[0]


def _momentum(robot: rt.Robot, solution: rt.Solution, t: float) -> float:
    sample = solution.at(t)
    h = pin.computeCentroidalMomentum(robot.model, robot.model.createData(), sample.q, sample.v).vector
    return float(2.0 * h[5] ** 2 + 0.5 * (h[:3] ** 2).sum())


def test_smoothness_of_a_frame_is_the_integral_of_its_squared_acceleration(robot: rt.Robot) -> None:
    frame = robot.end_effector
    assert frame is not None
    solution = move(robot, 3.0 * rt.objectives.FrameSmoothness(frame) + 1e-3 * rt.Effort())
    data = robot.model.createData()

    def rate(t: float) -> float:
        sample = solution.at(t)
        pin.forwardKinematics(robot.model, data, sample.q, sample.v, sample.a)
        a = pin.getFrameClassicalAcceleration(robot.model, data, robot.frame(frame), pin.LOCAL_WORLD_ALIGNED)
        return float(3.0 * (a.linear**2).sum() + 1e-3 * (sample.tau**2).sum())

    assert solution.objective == pytest.approx(quad_vec(rate, 0, 4, epsabs=1e-10)[0], rel=1e-4)


@pytest.mark.parametrize(
    ("objective", "expected"),
    [
        (rt.objectives.CentroidalMomentum(angular=0.0), "one of them positive"),
        (rt.objectives.CentroidalMomentum(angular=[1.0, 2.0]), "3 weights"),
        (rt.objectives.FrameSmoothness("tipp"), "tipp"),
        (rt.objectives.FrameSmoothness(()), "names no frame"),
    ],
)
def test_bad_input_is_refused(robot: rt.Robot, objective: object, expected: str) -> None:
    with pytest.raises(rt.InputError, match=expected):
        move(robot, objective)


def test_jerks_of_robots_in_contact_are_refused() -> None:
    hopper = rt.load("hopper", root="planar")
    with pytest.raises(rt.InputError, match="a phase with contact 'foot'"):
        rt.Phase(hopper, duration=1.0, contacts=[rt.PointContact("foot")], objective=rt.objectives.Jerk())
