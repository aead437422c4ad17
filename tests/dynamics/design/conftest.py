"""Robots whose numbers are known: a beam of point masses, and the arms of the catalogue."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

Array = np.ndarray


def inertia_of(masses: Array, points: Array) -> pin.Inertia:
    """Sum of point masses (n,) [kg] at points (n, 3) [m] in the joint's frame."""
    total = pin.Inertia.Zero()
    for mass, point in zip(masses, points, strict=True):
        total += pin.Inertia(float(mass), point, np.zeros((3, 3)))
    return total


def beam_model(masses: Array, points: Array, length: float) -> pin.Model:
    """A beam of point masses on a vertical axis, without gravity, and the frame ``tip`` at x = length."""
    model = pin.Model()
    model.name = "beam"
    model.gravity = pin.Motion.Zero()
    hinge = model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "hinge")
    model.appendBodyToJoint(hinge, inertia_of(masses, points), pin.SE3.Identity())
    model.addFrame(pin.Frame("tip", hinge, 0, pin.SE3(np.eye(3), np.array([length, 0, 0])), pin.FrameType.OP_FRAME))
    model.lowerPositionLimit[:], model.upperPositionLimit[:] = -10, 10
    model.upperEffortLimit[:] = model.upperVelocityLimit[:] = 1e30
    return model


@pytest.fixture(scope="session")
def beam() -> Callable[..., rt.Robot]:
    """``beam(masses, points, length) -> Robot``."""
    return lambda masses, points, length: rt.load(beam_model(masses, points, length))


@pytest.fixture(scope="session")
def arm() -> rt.Robot:
    return rt.load("two_link_arm")


@pytest.fixture(scope="session")
def ur5() -> rt.Robot:
    return rt.load("ur5")
