"""The algorithms that points of a robot evaluate."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

import robotraj as rt
from robotraj.dynamics.point import symbolic_model


def test_the_symbolic_model_is_that_of_the_planning_model_and_kept() -> None:
    robot = rt.load("kinova")
    assert symbolic_model(robot) is symbolic_model(robot)
    q, v, tau = np.random.default_rng(8).normal(size=(3, robot.nv))
    a = np.array(symbolic_model(robot).forward_dynamics(q, v, tau, np.zeros((6, robot.model.njoints)))).ravel()
    np.testing.assert_allclose(a, pin.aba(robot.model, robot.model.createData(), q, v, tau), rtol=1e-9)
