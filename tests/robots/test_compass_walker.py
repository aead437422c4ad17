"""The compass walker is the textbook's, and walks down a slope by itself.

Goswami, Thuilot and Espiau, Compass-like biped robot, INRIA report 2996, 1996: hip 10 kg, legs of 5 kg in the middle of
1 m. s and w are the angles of the stance and the swing leg about +y, 0 where they hang.
"""

from __future__ import annotations

import numpy as np
import pytest
from pinned import OTHER, Planar
from scipy.integrate import solve_ivp
from scipy.optimize import root

G = 9.81
SAMPLES = 30


def compass(s, w, ds, dw, u):
    """Accelerations of the legs; u turns the swing leg and, equal and opposite, the stance leg."""
    hip, leg, a, b = 10.0, 5.0, 0.5, 0.5
    length = a + b
    own = leg * a**2 + (hip + leg) * length**2
    coupling = -leg * length * b * np.cos(s - w)
    swing = -leg * length * b * np.sin(s - w)
    weight = G * (leg * a + (hip + leg) * length)
    right = [-swing * dw**2 + weight * np.sin(s) - u, swing * ds**2 - G * leg * b * np.sin(w) + u]
    return np.linalg.solve([[own, coupling], [coupling, leg * b**2]], right)


@pytest.mark.parametrize("stance", ["left", "right"])
def test_the_compass_walker_moves_as_the_textbooks_and_its_hip_keeps_turning(stance):
    robot, rng = Planar("compass_walker"), np.random.default_rng(8)
    for _ in range(SAMPLES):
        pitch, s, w = rng.uniform(-1, 1, 3)
        turn, ds, dw, u = rng.uniform(-3, 3, 4)
        joints = (f"{stance}_hip", f"{OTHER[stance]}_hip")
        q = robot.vector({"root_pitch": pitch, joints[0]: s - pitch, joints[1]: w - pitch})
        v = robot.vector({"root_pitch": turn, joints[0]: ds - turn, joints[1]: dw - turn})
        v = robot.standing(f"{stance}_foot", v, q)
        a = robot.pinned(f"{stance}_foot", q, v, robot.vector({joints[0]: -u, joints[1]: u}))
        a = dict(zip(robot.names, a, strict=True))
        assert abs(a["root_pitch"]) < 1e-10
        expected = compass(s, w, ds, dw, u)
        np.testing.assert_allclose([a[j] + a["root_pitch"] for j in joints], expected, rtol=1e-10, atol=1e-10)


def passive_step(y, slope):
    """Take one step, from after a strike to after the next: its time and the legs' (s, w, ds, dw), stance leg first."""

    def rates(_, y):
        return [*y[2:], *compass(*y, 0.0)]

    def strike(_, y):
        return y[0] + y[1] - 2 * slope

    strike.terminal, strike.direction = True, 1  # type: ignore[attr-defined]
    exact = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-12}
    away = solve_ivp(rates, (0, 0.4), y, **exact)  # the swing foot passes the ground at mid-stance, as usual
    down = solve_ivp(rates, (0.4, 2), away.y[:, -1], events=strike, **exact)
    s, w, ds, dw = down.y[:, -1]
    robot = Planar("compass_walker")
    q = robot.vector({"left_hip": s, "right_hip": w})
    v = robot.standing("left_foot", robot.vector({"left_hip": ds, "right_hip": dw}), q)
    after = dict(zip(robot.names, robot.impact("right_foot", q, v), strict=True))
    assert abs(after["root_pitch"]) < 1e-12
    return down.t[-1], np.array([w, s, after["right_hip"], after["left_hip"]])


@pytest.mark.parametrize(
    ("slope", "half_angle", "ds", "dw", "period"),
    [
        (np.deg2rad(3), 0.27102868, 1.09238359, 0.37737395, 0.73434639),
        (0.0525, 0.27127462, 1.09286681, 0.37613459, 0.73446062),
    ],
)
def test_the_compass_walker_walks_down_three_degrees_by_itself(slope, half_angle, ds, dw, period):
    """The report has 0.735 s a step and 0.271 rad between leg and normal on 3 degrees, as others quote it."""

    def start(z):
        return np.array([slope - z[0], slope + z[0], z[1], z[2]])

    def returned(z):
        _, (s, w, *rates) = passive_step(start(z), slope)
        assert s + w == pytest.approx(2 * slope, abs=1e-12)
        return np.array([slope - s, *rates])

    cycle = root(lambda z: returned(z) - z, [0.27, 1.1, 0.4], tol=1e-11).x
    np.testing.assert_allclose(returned(cycle), cycle, atol=1e-9)
    np.testing.assert_allclose(cycle, [half_angle, ds, dw], atol=1e-6)
    assert passive_step(start(cycle), slope)[0] == pytest.approx(period, abs=1e-6)
    assert (half_angle, period) == pytest.approx((0.271, 0.735), abs=1e-3)
    change = [(returned(cycle + d) - returned(cycle - d)) / 2e-5 for d in 1e-5 * np.eye(3)]
    assert np.abs(np.linalg.eigvals(change)).max() == pytest.approx(0.580, abs=1e-3)  # stable
