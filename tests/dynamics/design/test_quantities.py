"""The effect of each design quantity, against the same robot built in another way."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.dynamics.design.binding import Design


def parameters_of(robot: rt.Robot) -> np.ndarray:
    return np.array([inertia.toDynamicParameters() for inertia in robot.model.inertias])


def test_values_of_the_urdf_leave_the_robot_as_it_is(ur5) -> None:
    values = {"m": ur5.model.inertias[3].mass, "L": 0.425, "w": 0.0, "d": float(ur5.damping[2])}
    quantities = {
        "m": rt.design.BodyMass("forearm_link"),
        "L": rt.design.LinkLength("shoulder_lift_joint", tip="elbow_joint", along=(0, 0, 1)),
        "w": rt.design.Payload("tool0"),
        "d": rt.design.JointDamping("elbow_joint"),
    }
    same = Design(ur5, quantities).realise(values)
    np.testing.assert_allclose(parameters_of(same), parameters_of(ur5), rtol=0, atol=1e-14)
    for mine, own in zip(same.model.jointPlacements, ur5.model.jointPlacements, strict=True):
        np.testing.assert_allclose(mine.homogeneous, own.homogeneous, rtol=0, atol=1e-15)
    for mine, own in zip(same.model.frames, ur5.model.frames, strict=True):
        np.testing.assert_allclose(mine.placement.homogeneous, own.placement.homogeneous, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(same.damping, ur5.damping)


def test_mass_keeps_the_centre_and_scales_the_inertia(ur5) -> None:
    own = ur5.model.inertias[2]
    heavy = Design(ur5, {"m": rt.design.BodyMass("upper_arm_link")}).realise({"m": 1.7 * own.mass}).model.inertias[2]
    expected = pin.Inertia(1.7 * own.mass, own.lever, 1.7 * own.inertia)
    assert heavy.isApprox(expected, 1e-13)


def test_a_payload_is_a_body_welded_on(ur5) -> None:
    frame = ur5.model.frames[ur5.frame("tool0")]
    joint = frame.parentJoint
    loaded = Design(ur5, {"w": rt.design.Payload("tool0")}).realise({"w": 2.5}).model.inertias[joint]
    weight = frame.placement.act(pin.Inertia(2.5, np.zeros(3), np.zeros((3, 3))))
    assert loaded.isApprox(ur5.model.inertias[joint] + weight, 1e-13)


def test_a_payload_is_the_urdf_with_that_mass(arm, tmp_path) -> None:
    text = arm.geometry.urdf.read_text()
    light = '<link name="tip">\n    <inertial>\n      <mass value="1"/>'
    assert text.count(light) == 1
    heavy = tmp_path / "heavy.urdf"
    heavy.write_text(text.replace(light, light.replace('"1"', '"1.7"')))
    mine = Design(arm, {"w": rt.design.Payload("tip")}).realise({"w": 0.7})
    np.testing.assert_allclose(parameters_of(mine), parameters_of(rt.load(heavy)), rtol=0, atol=1e-14)


def test_length_moves_every_point_of_the_body(beam) -> None:
    """Point masses at S r weigh and turn as the stretched body does."""
    rng = np.random.default_rng(3)
    masses, points = rng.uniform(0.1, 1.0, 6), rng.normal(size=(6, 3))
    along = np.array([0.6, 0.0, 0.8])
    robot = beam(masses, points, 0.5)
    longer = Design(robot, {"L": rt.design.LinkLength("hinge", along=along)}).realise({"L": 0.5 * 0.6 * 1.8})
    stretch = np.eye(3) + 0.8 * np.outer(along, along)
    expected = beam(masses, points @ stretch, 0.5)
    np.testing.assert_allclose(parameters_of(longer), parameters_of(expected), rtol=1e-13, atol=1e-13)
    moved = longer.model.frames[longer.frame("tip")].placement.translation
    np.testing.assert_allclose(moved, stretch @ [0.5, 0, 0], rtol=0, atol=1e-15)


def test_a_slender_rod_turns_as_m_l_squared_by_three(beam) -> None:
    nodes, weights = np.polynomial.legendre.leggauss(2)
    rod = beam(weights / 2 * 1.2, np.column_stack([(nodes + 1) / 2 * 0.8, np.zeros(2), np.zeros(2)]), 0.8)
    longer = Design(rod, {"L": rt.design.LinkLength("hinge")}).realise({"L": 1.4})
    turning = longer.model.inertias[1].toDynamicParameters()[[6, 9]]
    np.testing.assert_allclose(turning, 1.2 * 1.4**2 / 3, rtol=1e-14)
    assert longer.model.inertias[1].mass == pytest.approx(1.2, rel=1e-15)


def test_a_payload_rides_on_the_stretched_link(arm) -> None:
    both = {"w": rt.design.Payload("tip"), "L": rt.design.LinkLength("elbow")}
    longer = Design(arm, both).realise({"w": 0.4, "L": 1.5}).model.inertias[2]
    body = Design(arm, {"L": rt.design.LinkLength("elbow")}).realise({"L": 1.5}).model.inertias[2]
    weight = pin.Inertia(0.4, np.array([1.5, 0, 0]), np.zeros((3, 3)))
    assert longer.isApprox(body + weight, 1e-13)


def test_one_parameter_may_be_two_masses(arm) -> None:
    robot = Design(arm, {"m": [rt.design.BodyMass("upper_arm"), rt.design.BodyMass("forearm")]}).realise({"m": 3.0})
    assert [inertia.mass for inertia in robot.model.inertias][1:] == pytest.approx([3.0, 3.0])


def test_the_robot_itself_is_not_written_to(arm) -> None:
    before = arm.model.copy()
    Design(arm, {"L": rt.design.LinkLength("shoulder"), "d": rt.design.JointDamping("elbow")}).realise(
        {"L": 2.0, "d": 1.0}
    )
    assert arm.model == before
    assert not arm.damping.any()
