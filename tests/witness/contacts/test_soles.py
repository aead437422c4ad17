"""Clearance between the corners of a sole: the edge of a stair cuts into it though every corner is clear."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

LENGTH = 0.2


def slider():
    """A foot that moves along x and z."""
    model = pin.Model()
    along = model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), "along")
    up = model.addJoint(along, pin.JointModelPZ(), pin.SE3.Identity(), "up")
    model.appendBodyToJoint(up, pin.Inertia(1.0, np.zeros(3), 0.01 * np.eye(3)), pin.SE3.Identity())
    model.addFrame(pin.Frame("foot", up, 0, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
    return rt.load(model)


def swing(ground, height, ends=((-0.5 * LENGTH, 0, 0), (0.5 * LENGTH, 0, 0))):
    """Slide over the foot of a ramp at a height."""
    clear = rt.GroundClearance([("foot", offset) for offset in ends], 0.0, ground)
    phase = rt.Phase(
        slider(), 1.0, rt.State(q=[-0.3, height], v=0), rt.State(q=[0.3, height], v=0), rt.Effort(), constraints=[clear]
    )
    return rt.validate(rt.plan(phase, mesh=rt.Mesh(10), check=False))


def hill(x, y):
    """A hill of 5 cm, so narrow that it fits between the places at which a plan keeps its soles clear."""
    return 0.05 / (1.0 + (x**2 + y**2) / 0.004**2) ** 2


def ridge(x, y):
    """A ridge of 5 cm, narrower than the sole is long."""
    return 0.05 / (1.0 + (x / 0.02) ** 4)


def test_a_hill_between_the_corners_is_found():
    # The corners pass beside a hill in the middle of the way; the sole does not.
    report = swing(hill, 0.03, ((0.0, 0.1, 0.0), (0.0, -0.1, 0.0)))
    (found,) = (v for v in report.violations if v.name == "ground clearance")
    assert " to " in found.joint and found.amount == pytest.approx(0.02, abs=2e-3)
    assert found.time == pytest.approx(0.5, abs=0.03)


def test_a_sole_that_stays_above_is_clear():
    report = swing(ridge, 0.06)
    assert not report.violations


def test_points_of_different_frames_are_no_sole():
    report = swing(hill, 0.03, ((0.0, 0.1, 0.0),))
    assert not report.violations
