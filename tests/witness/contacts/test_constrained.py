"""Contacts, impacts and closed loops on plain models, against closed forms."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from robotraj.witness.contacts.constrained import Held, accelerate, impact, mass_and_bias, obey, project

WORLD = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


def frame_rows(model, *chosen):
    """Hold the origins of frames along world axes: triples (frame, axes, target)."""

    def rows(q, v):
        data = model.createData()
        pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        parts = []
        for name, axes, target in chosen:
            frame, axes = model.getFrameId(name), list(axes)
            parts.append(
                (
                    data.oMf[frame].translation[axes] - target,
                    pin.getFrameJacobian(model, data, frame, WORLD)[axes],
                    pin.getFrameClassicalAcceleration(model, data, frame, WORLD).vector[axes],
                )
            )
        return Held(*(np.concatenate(part) for part in zip(*parts, strict=True)))

    return rows


def planar_body(mass=1.3, inertia=0.06, com=(0.0, -0.5), **frames):
    """A body free in the vertical plane, frames given as (x, z)."""
    model, parent = pin.Model(), 0
    for name, joint in (("x", pin.JointModelPX()), ("z", pin.JointModelPZ()), ("pitch", pin.JointModelRY())):
        parent = model.addJoint(parent, joint, pin.SE3.Identity(), name)
    body = pin.Inertia(mass, np.array([com[0], 0, com[1]]), np.diag([0.05, inertia, 0.01]))
    model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    for name, (x, z) in frames.items():
        where = pin.SE3(np.eye(3), np.array([x, 0.0, z]))
        model.addFrame(pin.Frame(name, parent, 0, where, pin.FrameType.OP_FRAME))
    return model


def box_body(mass, sides):
    """A free-flying box with a frame at each lower corner."""
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(joint, pin.Inertia.FromBox(mass, *sides), pin.SE3.Identity())
    half = 0.5 * np.array(sides)
    for i, (sx, sy) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        where = pin.SE3(np.eye(3), half * [sx, sy, -1])
        model.addFrame(pin.Frame(f"corner{i}", joint, 0, where, pin.FrameType.OP_FRAME))
    return model


def test_a_pinned_body_accelerates_as_the_pendulum_that_it_is():
    mass, inertia, length = 1.3, 0.06, 0.5
    model = planar_body(mass, inertia, (0.0, -length), pin=(0.0, 0.0))
    rows = frame_rows(model, ("pin", (0, 2), np.zeros(2)))
    angle, speed, torque = 0.7, 2.0, 0.4
    q, v = np.array([0, 0, angle]), np.array([0, 0, speed])
    a, force = accelerate(model, model.createData(), q, v, np.array([0, 0, torque]), rows(q, v))
    expected = (torque - mass * 9.81 * length * np.sin(angle)) / (inertia + mass * length**2)
    np.testing.assert_allclose(a, [0, 0, expected], atol=1e-12)
    # About +y, a positive angle moves the centre of mass below the pin towards -x.
    towards, along = np.array([-np.cos(angle), np.sin(angle)]), np.array([np.sin(angle), np.cos(angle)])
    of_mass = length * (expected * towards + speed**2 * along)
    np.testing.assert_allclose(force, mass * (of_mass + [0, 9.81]), atol=1e-12)


def test_four_corners_carry_a_box_evenly_though_one_would_do_for_some():
    mass = 8.0
    model = box_body(mass, (0.4, 0.3, 0.2))
    q, v = pin.neutral(model), np.zeros(6)
    at = {f"corner{i}": np.array([0.2 * sx, 0.15 * sy, -0.1])
          for i, (sx, sy) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1)))}  # fmt: skip
    held = frame_rows(model, *((name, (0, 1, 2), where) for name, where in at.items()))(q, v)
    assert held.jacobian.shape == (12, 6) and np.linalg.matrix_rank(held.jacobian) == 6
    a, force = accelerate(model, model.createData(), q, v, np.zeros(6), held)
    np.testing.assert_allclose(a, 0, atol=1e-12)
    np.testing.assert_allclose(force.reshape(4, 3), [[0, 0, mass * 9.81 / 4]] * 4, atol=1e-12)


def test_held_rows_keep_an_acceleration_that_a_moving_arm_needs():
    # Rows of a foot that other joints move have a bias: the foot's acceleration is zero, not J a.
    model = box_body(2.0, (0.4, 0.3, 0.2))
    joint = model.addJoint(1, pin.JointModelRX(), pin.SE3(np.eye(3), np.array([0.2, 0.1, 0.0])), "knee")
    below = pin.SE3(np.eye(3), np.array([0.0, 0.0, -0.3]))
    model.appendBodyToJoint(joint, pin.Inertia.FromSphere(0.5, 0.1), below)
    frame = model.addFrame(pin.Frame("foot", joint, 0, below, pin.FrameType.OP_FRAME))
    rng = np.random.default_rng(1)
    q, v = pin.integrate(model, pin.neutral(model), rng.normal(size=7)), rng.normal(size=7)
    data = model.createData()
    rows = frame_rows(model, ("foot", (0, 1, 2), np.zeros(3)))
    v, _ = impact(model, data, q, v, rows(q, v))
    a, force = accelerate(model, data, q, v, np.zeros(7), rows(q, v))
    pin.forwardKinematics(model, data, q, v, a)
    assert np.linalg.norm(rows(q, v).bias) > 0.05
    np.testing.assert_allclose(pin.getFrameClassicalAcceleration(model, data, frame, WORLD).linear, 0, atol=1e-12)
    needed = pin.rnea(model, data, q, v, a) - rows(q, v).jacobian.T @ force
    np.testing.assert_allclose(needed, 0, atol=1e-12)


def test_a_rod_that_strikes_with_its_end_conserves_angular_momentum():
    # A falling uniform rod, horizontal, one end caught: about that end m V L/2 is kept, so w = 3 V / (2 L).
    mass, length, speed = 2.0, 0.8, 3.0
    model = planar_body(mass, mass * length**2 / 12, (0.0, 0.0), end=(-0.5 * length, 0.0))
    q, v = np.zeros(3), np.array([0.0, -speed, 0.0])
    rows = frame_rows(model, ("end", (0, 2), np.array([-0.5 * length, 0.0])))
    after, impulse = impact(model, model.createData(), q, v, rows(q, v))
    np.testing.assert_allclose(after, [0, -0.75 * speed, 1.5 * speed / length], atol=1e-12)
    np.testing.assert_allclose(impulse, [0, 0.25 * mass * speed], atol=1e-12)


def test_the_compass_walkers_heel_strike_is_the_closed_form():
    # Hip mass and a point mass b along each leg; angular momentum about the new foot, and of the old leg about the hip.
    hip, leg, a, b, half = 10.0, 5.0, 0.5, 0.5, 0.27
    length = a + b
    model, parent = pin.Model(), 0
    for name, joint in (("x", pin.JointModelPX()), ("z", pin.JointModelPZ())):
        parent = model.addJoint(parent, joint, pin.SE3.Identity(), name)
    model.appendBodyToJoint(parent, pin.Inertia(hip, np.zeros(3), np.zeros((3, 3))), pin.SE3.Identity())
    for side in ("old", "new"):
        joint = model.addJoint(parent, pin.JointModelRY(), pin.SE3.Identity(), side)
        model.appendBodyToJoint(joint, pin.Inertia(leg, np.array([0, 0, -b]), np.zeros((3, 3))), pin.SE3.Identity())
        below = pin.SE3(np.eye(3), np.array([0, 0, -length]))
        model.addFrame(pin.Frame(f"{side}_foot", joint, 0, below, pin.FrameType.OP_FRAME))
    # The old foot stays behind the hip: about +y its leg's angle is positive.
    q = np.array([0.0, length * np.cos(half), half, -half])
    speeds = np.array([1.1, 0.4])
    rows = frame_rows(model, ("old_foot", (0, 2), np.zeros(2)))
    jacobian = rows(q, np.zeros(4)).jacobian
    v = np.concatenate([-jacobian[:, 2:] @ speeds, speeds])
    struck = frame_rows(model, ("new_foot", (0, 2), np.zeros(2)))
    after, impulse = impact(model, model.createData(), q, v, struck(q, v))
    # Goswami, Thuilot and Espiau (1998), "A study of the passive gait of a compass-like biped robot", equation 4,
    # in absolute angles from the vertical: Q+ (new, old)+ = Q- (old, new)-.
    double = np.cos(2 * half)
    before_matrix = np.array(
        [[-leg * a * b, -leg * a * b + (hip * length**2 + 2 * leg * a * length) * double], [0.0, -leg * a * b]]
    )
    after_matrix = np.array(
        [
            [leg * b * (b - length * double), leg * length * (length - b * double) + leg * a**2 + hip * length**2],
            [leg * b**2, -leg * b * length * double],
        ]
    )
    new_leg_swings = np.array([speeds[1], speeds[0]])
    expected = np.linalg.solve(after_matrix, before_matrix @ new_leg_swings)
    np.testing.assert_allclose([after[2], after[3]], expected, atol=1e-12)
    assert impulse[1] > 0


def test_an_impact_loses_the_energy_of_the_velocity_that_it_takes():
    # Carnot: the loss is the kinetic energy of v- - v+.
    model = box_body(2.0, (0.4, 0.3, 0.2))
    q = pin.integrate(model, pin.neutral(model), np.array([0.1, 0.2, 0.3, 0.4, -0.5, 0.6]))
    v = np.array([0.3, -0.2, -1.0, 0.5, 1.0, -2.0])
    data = model.createData()
    held = frame_rows(model, ("corner0", (0, 1, 2), np.zeros(3)), ("corner1", (2,), np.zeros(1)))(q, v)
    after, impulse = impact(model, data, q, v, held)
    mass, _ = mass_and_bias(model, data, q, v)
    np.testing.assert_allclose(held.jacobian @ after, 0, atol=1e-12)
    np.testing.assert_allclose(mass @ (after - v), held.jacobian.T @ impulse, atol=1e-12)
    lost = pin.computeKineticEnergy(model, data, q, v) - pin.computeKineticEnergy(model, data, q, after)
    assert lost == pytest.approx(0.5 * (v - after) @ mass @ (v - after), abs=1e-12) and lost > 0.1


def test_a_state_off_its_rows_is_put_back_also_where_rows_repeat():
    model = box_body(2.0, (0.4, 0.3, 0.2))
    corners = np.array([[0.2, 0.15, 0.0], [0.2, -0.15, 0.0], [-0.2, 0.15, 0.0], [-0.2, -0.15, 0.0]])
    rows = frame_rows(model, *((f"corner{i}", (0, 1, 2), where) for i, where in enumerate(corners)))
    q = pin.integrate(model, pin.neutral(model), np.array([1e-3, -2e-3, 0.1 + 1e-3, 3e-3, -2e-3, 1e-3]))
    v = np.array([1e-3, 0, 2e-3, 0, -1e-3, 0])
    data = model.createData()
    back, slower = project(model, data, q, v, rows)
    assert np.abs(rows(back, slower).gap).max() < 1e-13
    np.testing.assert_allclose(back, [0, 0, 0.1, 0, 0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(slower, 0, atol=1e-15)


def test_no_rows_leave_the_motion_free_and_no_numbers_give_none():
    mass = np.diag([1.0, 2.0])
    x, multipliers = obey(mass, np.zeros((0, 2)), np.array([3.0, 4.0]), np.zeros(0))
    np.testing.assert_array_equal(x, [3, 4])
    assert multipliers.shape == (0,)
    x, multipliers = obey(mass, np.full((1, 2), np.nan), np.zeros(2), np.zeros(1))
    assert np.isnan(x).all() and np.isnan(multipliers).all()
    x, _ = obey(np.diag([1.0, 0.0]), np.ones((1, 2)), np.zeros(2), np.zeros(1))
    assert np.isnan(x).all()
