"""Poses at rest that a motor cannot hold."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.fixed_mesh.diagnosis.unheld_ends import unheld_ends

A = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
B = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])


@pytest.fixture(scope="module")
def ur5() -> rt.Robot:
    return rt.load("ur5")


def reach(ur5: rt.Robot, effort: float, **changes: object) -> rt.Problem:
    phase = rt.Phase(
        ur5,
        duration=2.0,
        start=rt.State(q=A, v=0),
        end=rt.State(q=B, v=0),
        limits=ur5.limits.with_(effort={"shoulder_lift_joint": effort}),
    )
    return rt.Problem([phase.with_(**changes)])


def test_the_torque_is_that_of_gravity(ur5: rt.Robot) -> None:
    (entry,) = [e for e in unheld_ends(reach(ur5, 20.0)) if e.time == 2.0]
    gravity = pin.computeGeneralizedGravity(ur5.model, ur5.model.createData(), B)
    assert entry.needed == pytest.approx(abs(gravity[1]))
    assert str(entry).startswith("effort limit, shoulder_lift_joint") and "holding the end needs it" in str(entry)
    assert entry.bound == 20.0


def test_strong_motors_hold_everything(ur5: rt.Robot) -> None:
    assert not unheld_ends(reach(ur5, 150.0))


def test_ends_that_move_or_are_open_are_not_judged(ur5: rt.Robot) -> None:
    problem = reach(ur5, 20.0, start=rt.State(q=A, v=0.1), end=rt.State(v=0))
    assert not unheld_ends(problem)


def test_a_failed_plan_names_the_motor_that_cannot_hold_its_end(ur5: rt.Robot) -> None:
    solver = rt.Ipopt(max_iterations=3)
    with pytest.raises(
        rt.NoSolutionFound, match="shoulder_lift_joint, .*: 20 N m may have to become 45.79 N m .holding the end"
    ):
        rt.plan(reach(ur5, 20.0), rt.Mesh(5), solver=solver)


def test_feet_carry_a_robot_within_their_friction() -> None:
    """Two legs of a table: with the weight on point feet, the torques of the linear program balance it."""
    robot = rt.load("solo12", root="floating")
    feet = tuple(name for name in rt.gait.limb_ends(robot) if name.endswith("FOOT"))
    rest = rt.State(q=rt.gait.stand(robot, feet), v=0)
    contacts = [rt.PointContact(foot, friction=0.7) for foot in feet]

    def stand(effort: float) -> rt.Problem:
        limits = robot.limits.with_(effort=effort)
        return rt.Problem([rt.Phase(robot, 0.5, rest, rest, rt.Effort(), contacts=contacts, limits=limits)])

    weak = unheld_ends(stand(0.1))
    assert weak and all(entry.name.startswith("effort limit") for entry in weak)
    assert not unheld_ends(stand(1.01 * max(entry.needed for entry in weak)))


def test_a_pose_beyond_the_motors_is_warned_of_before_the_solve() -> None:
    """A pendulum that rises reaches a pose at rest without the torque that holds it there."""
    robot = rt.load("pendulum")
    limits = robot.limits.with_(effort=0.8)
    ends = rt.State(q=0.0), rt.State(q=1.2, v=0)
    phase = rt.Phase(robot, (0.3, 2.0), *ends, rt.Effort(), limits=limits)
    said = "cannot hold an end of the motion at rest: effort limit, pivot"
    with pytest.warns(UserWarning, match=said):
        assert rt.plan(phase, rt.Mesh(20)).success
    with pytest.warns(UserWarning, match=said):
        assert not rt.plan(phase, check=False, time_limit=1e-6).success


def test_a_pose_that_one_vector_of_torques_balances_needs_no_linear_program(monkeypatch: pytest.MonkeyPatch) -> None:
    import scipy.optimize

    def refused(*_: object, **__: object) -> None:
        raise AssertionError("a linear program was solved")

    monkeypatch.setattr(scipy.optimize, "linprog", refused)
    robot = rt.load("acrobot")
    data = robot.model.createData()

    def gravity(shoulder: float) -> np.ndarray:
        return np.array(pin.computeGeneralizedGravity(robot.model, data, np.array([shoulder, 1.0])))

    # The shoulder has no motor: it is at rest where its own gravity is zero.
    low, high = -1.5, 1.5
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if gravity(low)[0] * gravity(middle)[0] > 0 else (low, middle)
    needed = abs(gravity(low)[1])

    def held(shoulder: float) -> tuple[object, ...]:
        end = rt.State(q=[shoulder, 1.0], v=0)
        limits = robot.limits.with_(effort={robot.actuated[0]: 0.5 * needed})
        return unheld_ends(rt.Problem([rt.Phase(robot, 1.0, rt.State(q=0, v=0), end, limits=limits)]))

    (entry,) = held(low)
    assert entry.needed == pytest.approx(needed, rel=1e-6)
    assert held(low + 0.5) == ()


def test_a_motor_too_weak_for_both_ends_is_named_once_with_the_greater_torque() -> None:
    """A pendulum of mass m and length l weighs m g l sin(q) at its joint."""
    robot = rt.load("pendulum")
    ends = [rt.State(q=[q], v=0) for q in (0.5, 1.2)]
    limits = robot.limits.with_(effort=0.01)
    (entry,) = unheld_ends(rt.Problem([rt.Phase(robot, 1.0, *ends, limits=limits)]))
    (alone,) = unheld_ends(rt.Problem([rt.Phase(robot, 1.0, None, ends[1], limits=limits)]))
    assert entry.needed == alone.needed and "end" in entry.reason
