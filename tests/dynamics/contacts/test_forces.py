"""Limits of contact forces: cones, centre of pressure and torsion, against forces and soles computed by hand."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import linprog

import robotraj as rt
from robotraj.dynamics.contacts.cones import Linearised, SecondOrder
from robotraj.dynamics.contacts.edges.line_contact import LineContact
from robotraj.dynamics.contacts.flat_foot import FlatFoot
from robotraj.dynamics.contacts.loop_closure import LoopClosure
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.contacts.soles import FourCorners, PressureAndTorsion, Rectangle
from robotraj.witness.point import NumericPoint

Load = Callable[[str, str], rt.Robot]
SOLE = "left_sole_link"
YAW = 0.6


def standing(robot: rt.Robot, contact: Any) -> tuple[Any, NumericPoint, dict[str, float]]:
    """A bound contact of a robot in its neutral configuration, turned by YAW where its root is floating."""
    q = np.array(robot.neutral)
    if robot.root == "floating":
        q[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(0.0, 0.0, YAW)).coeffs()
    bound = contact.bind(robot)
    still = np.zeros(robot.nv)
    return bound, NumericPoint(robot, 0.0, q, still, still, np.zeros(robot.nu)), bound.locate(robot, q)


def holds(robot: rt.Robot, contact: Any, forces: Any) -> bool:
    """Whether all rows on the forces are inside their bounds."""
    bound, point, anchors = standing(robot, contact)
    values = bound.limits(point, [float(force) for force in forces], anchors)
    return all(
        row.lower - 1e-9 <= value <= row.upper + 1e-9 for row, value in zip(bound.limit_rows, values, strict=True)
    )


@pytest.mark.parametrize(
    ("force", "inside"),
    [((0.5, 0.4, 1.0), True), ((0.6, 0.4, 1.0), False), ((0.0, 0.0, -1.0), False), ((0, 0, 0), True)],
)
def test_the_round_cone_holds_the_whole_tangential_force(robot_of: Load, force: Any, inside: bool) -> None:
    assert holds(robot_of("solo12", "floating"), PointContact("FL_FOOT", friction=0.7), force) is inside


def test_the_cone_leans_with_the_ground(robot_of: Load) -> None:
    robot = robot_of("solo12", "floating")
    for slope, inside in ((0.69, True), (0.71, False)):
        for ground in (
            rt.terrain.Slope(slope, 0.0),
            rt.terrain.Slope(0.0, -slope),
            rt.terrain.Slope(0.6 * slope, 0.8 * slope),
        ):
            contact = PointContact("FL_FOOT", friction=0.7, ground=ground)
            assert holds(robot, contact, (0.0, 0.0, 10.0)) is inside, (slope, ground)


@pytest.mark.parametrize("faces", [3, 4, 5, 8])
def test_a_pyramid_lies_inside_the_cone_and_touches_it(faces: int) -> None:
    angles = np.linspace(0.0, 2 * np.pi, 40 * faces, endpoint=False)
    directions = np.array([np.cos(angles), np.sin(angles)])
    rows = np.array(Linearised(faces).rows(0.5, 1.0, *directions * 0.5))
    assert rows.shape[0] == len(Linearised(faces).units)
    assert rows.min(axis=0).max() == pytest.approx(0.0, abs=1e-12)  # the edges are on the cone, the rest is inside
    within = np.array(Linearised(faces).rows(0.5, 1.0, *directions * 0.5 * np.cos(np.pi / faces)))
    assert within.min() == pytest.approx(0.0, abs=1e-12)
    assert np.all(np.array(SecondOrder().rows(0.5, 1.0, *directions * 0.499999)) > 0.0)


@pytest.mark.parametrize(("slope", "inside"), [(0.49, True), (0.51, False), (-0.49, True), (-0.51, False)])
def test_in_a_plane_the_cone_is_two_lines(robot_of: Load, slope: float, inside: bool) -> None:
    robot = robot_of("five_link", "planar")
    contact = PointContact("left_foot", friction=0.5, ground=rt.terrain.Slope(slope, 0.3))
    assert [row.unit for row in contact.bind(robot).limit_rows] == ["N", "N", "N"]
    assert holds(robot, contact, (0.0, 30.0)) is inside
    assert holds(robot, PointContact("left_foot", friction=0.5), (slope, 1.0)) is inside


def test_the_normal_force_has_bounds_and_is_a_variable_where_the_ground_is_level(robot_of: Load) -> None:
    for root, robot, frame in (("floating", "solo12", "FL_FOOT"), ("planar", "five_link", "left_foot")):
        contact = PointContact(frame, name="foot", normal_force=(5.0, 80.0))
        row = contact.bind(robot_of(robot, root)).limit_rows[0]
        assert (row.variable, row.lower, row.upper) == ("force.foot.z", 5.0, 80.0)
        sloped = PointContact(frame, name="foot", ground=rt.terrain.Slope(0.1, 0.2)).bind(robot_of(robot, root))
        assert sloped.limit_rows[0].variable is None
    robot = robot_of("solo12", "floating")
    assert [holds(robot, PointContact("FL_FOOT", normal_force=(5, 80)), (0, 0, f)) for f in (4.9, 50, 81)] == [
        False,
        True,
        False,
    ]


def pressed(x: float, y: float, force: Any = (0.0, 0.0, 100.0)) -> list[float]:
    """Wrench in world axes of a force in the foot's axes, at (x, y) of a level foot turned by YAW."""
    turn = pin.rpy.rpyToMatrix(0.0, 0.0, YAW)
    force = np.asarray(force, dtype=float)
    return [*(turn @ force), *(turn @ np.cross([x, y, 0.0], force))]


@pytest.mark.parametrize("sole", [PressureAndTorsion(), PressureAndTorsion(Linearised(6)), FourCorners()])
def test_the_centre_of_pressure_stays_on_the_sole(robot_of: Load, sole: Any) -> None:
    robot, foot = robot_of("talos_legs", "floating"), FlatFoot(SOLE, (0.08, 0.12), 0.1, sole=sole)
    assert standing(robot, foot)[2][f"{SOLE}.yaw"] == pytest.approx(YAW)
    for x, y, inside in (
        (0.119, 0.049, True),
        (-0.079, -0.049, True),
        (0.121, 0.0, False),
        (-0.081, 0.0, False),
        (0.0, 0.051, False),
        (0.0, -0.051, False),
    ):
        assert holds(robot, foot, pressed(x, y)) is inside, (x, y)


def test_pressure_is_measured_from_the_sole_not_from_the_frame(robot_of: Load) -> None:
    robot = robot_of("talos_legs", "floating")
    foot, point, _ = standing(robot, FlatFoot("leg_left_6_joint", 0.2, 0.1, offset=(0.0, 0.0, -0.107)))
    ((frame, wrench),) = foot.wrench(point, [10.0, 0.0, 100.0, 0.0, 0.0, 0.0])
    arm = point.frame(frame).rotation @ np.array([0.0, 0.0, -0.107])
    np.testing.assert_allclose(wrench[3:], np.cross(arm, [10.0, 0.0, 100.0]), atol=1e-12)


@pytest.mark.parametrize(("x", "inside"), [(0.099, True), (0.101, False), (-0.049, True), (-0.051, False)])
@pytest.mark.parametrize("forward", [1.0, -1.0])
def test_in_a_plane_the_sole_is_a_line(robot_of: Load, x: float, inside: bool, forward: float) -> None:
    length = (0.05, 0.1) if forward > 0.0 else (0.1, 0.05)
    foot = FlatFoot("left_foot", length, forward=(forward, 0.0, 0.0))
    assert holds(robot_of("five_link", "planar"), foot, (0.0, 100.0, -100.0 * x)) is inside  # a moment about +y


def test_torsion_grows_with_the_normal_force(robot_of: Load) -> None:
    robot = robot_of("talos_legs", "floating")
    for radius, reach in ((None, 2.0 / 3.0 * 0.05), (0.02, 0.02)):
        foot = FlatFoot(SOLE, 0.2, 0.1, friction=0.5, sole=PressureAndTorsion(radius=radius))
        for part, inside in ((0.99, True), (1.01, False), (-0.99, True), (-1.01, False)):
            moment = part * 0.5 * reach * 200.0
            assert holds(robot, foot, (0, 0, 200.0, 0, 0, moment)) is inside


SHAPE, FRICTION = Rectangle(back=0.08, front=0.14, half=0.05), 0.6
CORNERS = [(x, y, 0.0) for x in (-SHAPE.back, SHAPE.front) for y in (-SHAPE.half, SHAPE.half)]
EDGES = [FRICTION / np.sqrt(2.0) * np.array(edge) for edge in ((1, 1, 0), (1, -1, 0), (-1, 1, 0), (-1, -1, 0))]
SPAN = np.array([[*ray, *np.cross(corner, ray)] for corner in CORNERS for ray in [e + [0, 0, 1.0] for e in EDGES]]).T


def test_four_corners_allow_every_wrench_of_corner_forces() -> None:
    rng = np.random.default_rng(0)
    for _ in range(200):
        wrench = SPAN @ (rng.exponential(size=16) * (rng.uniform(size=16) < 0.3))
        rows = FourCorners().rows(FRICTION, SHAPE, wrench[:3], wrench[3:])
        assert len(rows) == len(FourCorners().labels())
        assert min(rows) > -1e-12


def test_four_corners_allow_nothing_else() -> None:
    rng = np.random.default_rng(1)
    found = {True: 0, False: 0}
    for _ in range(400):
        wrench = np.array([*rng.uniform(-0.5, 0.5, 2), 1.0, *rng.uniform(-0.05, 0.05, 3)])
        wrench[4] *= 2.0
        least = min(FourCorners().rows(FRICTION, SHAPE, wrench[:3], wrench[3:]))
        made = linprog(np.zeros(16), A_eq=SPAN, b_eq=wrench, bounds=(0, None)).status == 0
        assert (least >= 0.0) == made or abs(least) < 1e-7, (wrench, least)
        found[made] += 1
    assert min(found.values()) > 30


def test_an_edge_carries_pressure_between_its_ends_and_no_moment_about_itself(robot_of: Load) -> None:
    robot = robot_of("talos_legs", "floating")
    toe = LineContact(SOLE, 0.1, friction=0.5, offset=(0.1, 0.0, 0.0))
    bound, point, anchors = standing(robot, toe)
    assert anchors[f"{SOLE}.yaw"] == pytest.approx(YAW)
    left = point.frame(SOLE).rotation @ np.array([0.0, 1.0, 0.0])
    for y, inside in ((0.049, True), (0.051, False), (-0.049, True), (-0.051, False)):
        # f at y left of the middle: the moment y l x f n = y f u, since l x n is forward.
        forces = (0.0, 0.0, 100.0, 100.0 * y, 0.0)
        ((_, wrench),) = bound.wrench(point, forces)
        arm = point.frame(SOLE).rotation @ np.array([0.1, y, 0.0])
        np.testing.assert_allclose(wrench[3:], np.cross(arm, [0.0, 0.0, 100.0]), atol=1e-9)
        assert holds(robot, toe, forces) is inside
    ((_, wrench),) = bound.wrench(point, (3.0, 4.0, 100.0, 2.0, 0.7))
    at_middle = np.array(wrench[3:]) - np.cross(point.frame(SOLE).rotation @ [0.1, 0.0, 0.0], wrench[:3])
    assert at_middle @ left == pytest.approx(0.0, abs=1e-9)
    for part, inside in ((0.99, True), (1.01, False), (-1.01, False)):
        assert holds(robot, toe, (0.0, 0.0, 100.0, 0.0, part * 0.5 * 0.025 * 100.0)) is inside
    assert not holds(robot, toe, (0.0, 51.0, 100.0, 0.0, 0.0))


def test_a_loop_pulls_both_ends_together_with_opposite_wrenches(robot_of: Load) -> None:
    robot = robot_of("talos_legs", "floating")
    bound, point, _ = standing(robot, LoopClosure(SOLE, "right_sole_link", rigid=True))
    first, second = bound.wrench(point, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert (first[0], second[0]) == (SOLE, "right_sole_link")
    np.testing.assert_array_equal(np.array(first[1]), -np.array(second[1]))
    assert bound.limit_rows == () and bound.anchors == ()


def test_vectors_show_zeros_for_what_is_not_carried(robot_of: Load) -> None:
    planar, spatial = robot_of("five_link", "planar"), robot_of("talos_legs", "floating")
    assert PointContact("left_foot").bind(planar).vector([1.0, 2.0]) == [1.0, 0.0, 2.0]
    assert FlatFoot("left_foot", 0.1).bind(planar).vector([1.0, 2.0, 3.0]) == [1.0, 0.0, 2.0, 0.0, 3.0, 0.0]
    assert FlatFoot(SOLE, 0.2, 0.1).bind(spatial).vector([1, 2, 3, 4, 5, 6]) == [1, 2, 3, 4, 5, 6]
    assert LineContact(SOLE, 0.1).bind(spatial).vector([1, 2, 3, 4, 5]) == [1, 2, 3, 4, 0.0, 5]
    assert LoopClosure("left_foot", "right_foot").bind(planar).vector([1.0, 2.0]) == [1.0, 0.0, 2.0]
