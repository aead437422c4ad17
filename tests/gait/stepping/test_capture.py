"""The capture point of the linear inverted pendulum, and footholds beyond it."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.gait.stepping.capture import capture_point, caught
from robotraj.guess.legs.stance import BalancedStance


def test_a_pendulum_pushed_from_its_capture_point_comes_to_rest_there(biped: rt.Robot) -> None:
    contacts = tuple(rt.PointContact(foot).bound_to(biped) for foot in ("left_foot", "right_foot"))
    stance = BalancedStance(biped, contacts)
    q, v = rt.gait.stand(biped), np.zeros(biped.nv)
    v[0] = 0.5
    point = capture_point(stance, q, v, backwards=False)[0]
    data = biped.model.createData()
    pin.centerOfMass(biped.model, data, q, v)
    x, speed, rate = data.com[0][0], data.vcom[0][0], np.sqrt(9.81 / data.com[0][2])
    assert speed == pytest.approx(0.5)
    # x'' = rate^2 (x - point) has the solution point + (x - point) exp(-rate t) if the speed is rate (point - x).
    assert speed == pytest.approx(rate * (point - x))
    assert capture_point(stance, q, v, backwards=True)[0] == pytest.approx(2.0 * x - point)


def test_the_other_foot_is_beyond_the_capture_point_on_the_line_from_the_standing_foot() -> None:
    standing, point = {"x": 0.1, "y": -0.2}, {"x": 0.5, "y": 0.2}
    foot = caught(standing, point)
    assert foot == pytest.approx({"x": 0.6, "y": 0.3})
