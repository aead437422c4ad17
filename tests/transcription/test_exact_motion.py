"""Motions whose equations hold at all times."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj._util.curves.polynomials import lobatto_sites
from robotraj.transcription.exact_motion import is_exact, with_integrated_speeds
from robotraj.transcription.schemes.control import ConstantControl

SCHEMES = [
    rt.HermiteSimpson(),
    rt.schemes.RadauIIA(2),
    rt.schemes.RadauIIA(3),
    rt.schemes.GaussLegendre(1),
    rt.schemes.GaussLegendre(3),
    rt.schemes.LobattoIIIA(5),
]


def reach(name: str = "ur5", **changes: object) -> rt.Phase:
    robot = rt.load(name)
    start, end = np.full(robot.nq, 0.3), np.full(robot.nq, 0.9)
    return rt.Phase(robot, **dict(duration=1.5, start=rt.State(q=start, v=0), end=rt.State(q=end, v=0), **changes))


@pytest.mark.parametrize("scheme", SCHEMES, ids=repr)
def test_schemes_that_integrate_their_states_are_exact(scheme: rt.schemes.Scheme) -> None:
    assert is_exact(reach(), (scheme,))


@pytest.mark.parametrize(
    "scheme", [rt.schemes.Trapezoidal(), rt.schemes.RadauIIA(1), rt.HermiteSimpson(control=ConstantControl())], ids=repr
)
def test_other_schemes_are_not_exact(scheme: rt.schemes.Scheme) -> None:
    assert not is_exact(reach(), (scheme,))


def test_joints_without_motors_have_no_exact_motion() -> None:
    acrobot = rt.load("acrobot", actuated=["elbow"])
    phase = rt.Phase(acrobot, 1.0, rt.State(q=0, v=0), rt.State(), rt.Effort())
    assert not is_exact(phase, (rt.HermiteSimpson(),))


def test_positions_are_integrals_of_the_speeds() -> None:
    """v = 3 t^2 - 2 t from q = 1 on an interval of 2 s."""
    sites = lobatto_sites(4)
    t = 2.0 * sites
    values = np.stack([np.zeros(4), 3 * t**2 - 2 * t], axis=1)[None]
    values[0, 0, 0] = 1.0
    finer, raised = with_integrated_speeds(values, np.array([2.0]), 1)
    t = 2.0 * finer
    assert raised[0, :, 0] == pytest.approx(1 + t**3 - t**2, abs=1e-13)
    assert raised[0, :, 1] == pytest.approx(3 * t**2 - 2 * t, abs=1e-13)


@pytest.mark.parametrize("name", ["ur5", "z1"])
@pytest.mark.parametrize("scheme", [rt.HermiteSimpson(), rt.schemes.RadauIIA(3)], ids=repr)
def test_the_planned_torques_drive_the_planned_motion(name: str, scheme: rt.schemes.Scheme) -> None:
    """Eight intervals are coarse, and z1's joints have Coulomb friction; the motion is one to rounding."""
    moving = rt.load(name)
    low, high = np.maximum(moving.limits.position_lower, -2.0), np.minimum(moving.limits.position_upper, 2.0)
    start, end = (rt.State(q=low + share * (high - low), v=0) for share in (0.4, 0.6))
    phase = rt.Phase(moving, 1.5, start, end, rt.Effort())
    solution = rt.plan(phase, mesh=rt.Mesh(8, scheme))
    (part,) = solution.phases
    robot, n = part.robot, part.robot.nq
    data = robot.model.createData()

    def rate(t: float, x: np.ndarray, k: int) -> np.ndarray:
        drag = robot.damping * x[n:] + robot.friction * np.tanh(x[n:] / robot.friction_speed)
        tau = part.at(float(t), interval=k).tau
        return np.r_[x[n:], pin.aba(robot.model, data, x[:n], x[n:], tau - drag)]

    for k in (0, 3):
        first, last = part.knots[k : k + 2]
        begin, end = part.at(float(first), interval=k), part.at(float(last), interval=k)
        found = solve_ivp(rate, (first, last), np.r_[begin.q, begin.v], "LSODA", args=(k,), rtol=1e-9, atol=1e-10)
        assert found.y[:, -1] == pytest.approx(np.r_[end.q, end.v], abs=1e-6)
    assert solution.error == 0.0
    for k in range(7):
        left, right = part.at(float(part.knots[k + 1]), interval=k), part.at(float(part.knots[k + 1]), interval=k + 1)
        assert left.q == pytest.approx(right.q, abs=1e-12)
