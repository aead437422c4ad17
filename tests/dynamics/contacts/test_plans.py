"""Contacts in plans: linkages, feet and edges hold between the knots, to the order of the scheme."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.witness.point import NumericPoint


def numbers(robot: rt.Robot, q: Any, v: Any) -> NumericPoint:
    return NumericPoint(robot, 0.0, q, v, np.zeros(robot.nv), np.zeros(robot.nu))


def held(robot: rt.Robot, contacts: Any, q: Any) -> Any:
    """The configuration nearest q in which contacts hold where they are in q, by Newton's method."""
    bound, still = [contact.bind(robot) for contact in contacts], np.zeros(robot.nv)
    anchors = [contact.locate(robot, q) for contact in bound]
    for _ in range(20):
        point = numbers(robot, q, still)
        rows = np.concatenate([contact.position(point, at) for contact, at in zip(bound, anchors, strict=True)])
        columns = [
            np.concatenate([contact.velocity(numbers(robot, q, e)) for contact in bound]) for e in np.eye(robot.nv)
        ]
        q = pin.integrate(robot.model, q, -np.linalg.pinv(np.array(columns).T) @ rows)
    return q


def gap(solution: rt.Solution, robot: rt.Robot, contact: Any) -> float:
    """Largest held row of position over the whole plan, between the knots too."""
    bound, still = contact.bind(robot), np.zeros(robot.nv)
    configurations = solution.at(np.linspace(0.0, 1.0, 201)).q
    places = [bound.position(numbers(robot, q, still), {}) for q in configurations]
    return float(np.abs(places).max())


def test_a_linkage_stays_closed_between_the_knots_and_its_simulation_agrees() -> None:
    robot = rt.load("five_link", root="fixed")
    loop = rt.contacts.LoopClosure("left_foot", "right_foot", offset_b=(0.1, 0.0, 0.15))
    start, end = (held(robot, [loop], np.array(q)) for q in ([0.5, -0.9, -0.4, 0.8], [0.7, -1.0, -0.1, 0.8]))
    swing = rt.Phase(
        robot, 1.0, rt.State(q=start, v=0), rt.State(q=end, v=0), rt.Effort(), contacts=[loop], limits=None
    )
    plans = [rt.plan(swing, rt.Mesh(n)) for n in (5, 10, 20)]
    gaps = [gap(plan, robot, loop) for plan in plans]
    assert np.all(np.log2(np.divide(gaps[:-1], gaps[1:])) > 3.0), gaps
    assert rt.validate(plans[-1]).passed


def test_two_arms_that_face_each_other_carry_one_thing() -> None:
    ur5 = rt.load("ur5")
    turned = {"right": ((1.1, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0))}
    pair = rt.robot.join({"left": ur5, "right": ur5}, at=turned)
    start = np.tile([0.0, -1.3, 1.9, -0.6, 1.57, 0.0], 2)
    hands = rt.contacts.LoopClosure.closed_at(pair, start, "left_tool0", "right_tool0")
    assert np.abs(hands.rotation_b) == pytest.approx([0.0, 1.0, 0.0, 0.0], abs=1e-2)

    def between(q: np.ndarray) -> pin.SE3:
        data = pair.model.createData()
        pin.framesForwardKinematics(pair.model, data, q)
        left, right = (data.oMf[pair.frame(f"{side}_tool0")] for side in ("left", "right"))
        return right.inverse() * left

    goal = rt.AtEnd(rt.FramePosition("left_tool0", (0.55, 0.15, 0.3)))
    lift = rt.Phase(
        pair,
        (0.1, 5),
        rt.State(q=start, v=0),
        rt.State(v=0),
        rt.Duration() + 1e-3 * rt.Effort(),
        [goal],
        contacts=[hands],
    )
    plan = rt.plan(lift)
    assert plan.proof is not None and plan.proof.holds and rt.validate(plan).passed
    held = between(start)
    for q in plan.at(np.linspace(0.0, plan.duration, 31)).q:
        assert np.abs(pin.log6(held.inverse() * between(q)).vector).max() < 1e-4


def test_a_rigid_loop_of_frames_half_a_turn_apart_is_refused() -> None:
    robot = rt.load("talos_legs", root="fixed")
    turned = (1.0, 0.0, 0.0, 0.0)
    soles = rt.contacts.LoopClosure.closed_at(robot, robot.neutral, "left_sole_link", "right_sole_link")
    assert np.abs(soles.rotation_b) == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-6)
    start = rt.State(q=robot.neutral, v=0)
    rt.Phase(robot, 1.0, start, None, rt.Effort(), contacts=[soles], limits=None)
    over = replace(soles, rotation_b=turned)
    with pytest.raises(rt.InputError, match="'left_sole_link' and 'right_sole_link' are turned over.*closed_at"):
        rt.Phase(robot, 1.0, start, None, rt.Effort(), contacts=[over], limits=None)
    aside = replace(soles, offset_b=(0.0, 0.3, 0.0))
    with pytest.raises(rt.InputError, match="is .* m instead of 0.*LoopClosure.closed_at closes a loop as it is"):
        rt.Phase(robot, 1.0, start, None, rt.Effort(), contacts=[aside], limits=None)


@pytest.mark.parametrize(
    ("start", "end", "message"),
    [
        (
            {"q": [0.5, -0.9, -0.4, 0.8], "v": 0},
            None,
            "at the start, contact 'left_foot-right_foot' does not hold.* m ",
        ),
        (None, {"q": [0.5, -0.9, -0.4, 0.8]}, "at the end, contact 'left_foot-right_foot' does not hold"),
        ({"q": [0.5, -0.8, -0.3, 0.8], "v": [1, 0, 0, 0]}, None, "at the start, contact .* m/s instead of 0"),
    ],
)
def test_an_end_at_which_a_contact_does_not_hold_is_refused(start: Any, end: Any, message: str) -> None:
    robot = rt.load("five_link", root="fixed")
    ends = (None if values is None else rt.State(**values) for values in (start, end))
    with pytest.raises(rt.InputError, match=message):
        rt.Phase(
            robot, 1.0, *ends, rt.Effort(), contacts=[rt.contacts.LoopClosure("left_foot", "right_foot")], limits=None
        )


def test_a_foot_that_stands_elsewhere_at_the_end_is_refused() -> None:
    robot = rt.load("five_link", root="planar")
    ends = [rt.State(q=[x, 0.0, 0.0, 0.1, 0.2, 0.1, 0.2], v=0) for x in (0.0, 0.1)]
    place = numbers(robot, ends[0].q, np.zeros(7)).frame("left_foot").position
    foot = rt.PointContact("left_foot", ground=rt.terrain.Flat(place[2]))
    rt.Phase(robot, 1.0, ends[0], ends[0], rt.Effort(), contacts=[foot])
    with pytest.raises(rt.InputError, match="at the end, contact 'left_foot' does not hold: .* is 0.1 m"):
        rt.Phase(robot, 1.0, *ends, rt.Effort(), contacts=[foot])
    with pytest.raises(rt.InputError, match="at the start, contact 'left_foot' does not hold"):
        rt.Phase(robot, 1.0, ends[0], None, rt.Effort(), contacts=[foot], parameters={"left_foot.x": place[0] + 0.2})


def standing(robot: rt.Robot) -> Any:
    """Talos's legs on level ground, both soles flat."""
    q = np.array(robot.neutral)
    ankle = numbers(robot, q, np.zeros(robot.nv)).frame("left_sole_link").position
    q[2] -= ankle[2]
    return held(robot, [rt.FlatFoot(f"{side}_sole_link", 0.2, 0.12) for side in ("left", "right")], q)


@pytest.mark.slow
@pytest.mark.parametrize(
    "feet",
    [
        [
            rt.FlatFoot("left_sole_link", 0.2, 0.12),
            rt.FlatFoot("right_sole_link", 0.2, 0.12, sole=rt.contacts.FourCorners()),
        ],
        [rt.contacts.LineContact(f"{side}_sole_link", 0.12, offset=(0.1, 0.0, 0.0)) for side in ("left", "right")],
    ],
    ids=["flat", "toes"],
)
def test_feet_of_talos_neither_slide_nor_sink(feet: Any) -> None:
    robot = rt.load("talos_legs", root="floating")
    heels = [
        rt.PathConstraint(lambda point, name=foot.frame: point.frame(name).position[2], -1e-6, name="heel")
        for foot in feet
    ]
    push = rt.Phase(
        robot, 0.2, rt.State(q=standing(robot), v=0), objective=rt.Effort(), contacts=feet, constraints=heels
    )
    report = rt.validate(rt.plan(push, rt.Mesh(8)))
    assert len(report.holdings) == 2
    assert all(max(hold.slip.value, hold.sink.value, hold.turn.value) < 1e-4 for hold in report.holdings)
    assert report.passed


def test_a_robot_between_two_walls_is_held_by_friction() -> None:
    """Without ground, the impulses of friction carry the weight from rest to rest, and those of the walls are alike."""
    robot = rt.load("five_link", root="planar")
    q = {"root_x": 0.0, "root_z": 1.0, "root_pitch": 0.0}
    joints = (name for name in robot.position_names if not name.startswith("root"))
    q |= dict(zip(joints, (-1.1, 0.9, 0.5, 0.9), strict=True))
    pose = np.array([q[name] for name in robot.position_names])
    data, friction = robot.model.createData(), 1.2
    pin.framesForwardKinematics(robot.model, data, pose)
    feet = {name: data.oMf[robot.frame(name)].translation for name in ("left_foot", "right_foot")}
    middle = np.mean(list(feet.values()), axis=0)
    contacts = [
        rt.PointContact(name, friction, ground=rt.terrain.Plane(place, middle * (1, 0, 0) - place * (1, 0, 0)))
        for name, place in feet.items()
    ]
    rest = rt.State(q=pose, v=0)
    solution = rt.plan(rt.Phase(robot, 0.2, rest, rest, rt.Effort(), contacts=contacts, name="brace"))
    assert rt.validate(solution).passed
    times = np.linspace(0.0, 0.2, 401)
    force = solution.at(times).forces
    pushes = np.array([force[name][:, 0] * np.sign(middle[0] - feet[name][0]) for name in feet])
    lifts = np.array([force[name][:, 2] for name in feet])
    assert np.trapezoid(lifts.sum(axis=0), times) == pytest.approx(robot.mass * 9.81 * 0.2, rel=1e-3)
    assert np.trapezoid(pushes[0] - pushes[1], times) == pytest.approx(0.0, abs=1e-3 * pushes.mean())
    assert np.all(pushes > 0.0) and np.all(np.abs(lifts) <= friction * pushes * (1 + 1e-3))
