"""A free body that tumbles about its intermediate axis: the quaternion keeps its length and the scheme its order."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt

DURATION = 2.0
Q0 = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
V0 = np.array([0.5, 0.2, 3.0, 0.8, 6.0, 0.5])


def block() -> pin.Model:
    model = pin.Model()
    model.name = "block"
    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(joint, pin.Inertia(2.0, np.zeros(3), np.diag([0.1, 0.2, 0.3])), pin.SE3.Identity())
    model.addFrame(pin.Frame("body", joint, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    return model


@pytest.fixture(scope="module")
def robot() -> rt.Robot:
    return rt.load(block(), root="floating")


@pytest.fixture(scope="module")
def reference() -> np.ndarray:
    """q and v at the end by SciPy, on plain Pinocchio."""
    model = block()
    data = model.createData()

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        q, v = y[:7], y[7:]
        x, y_, z, s = q[3:]
        w = v[3:]
        turning = 0.5 * np.array(
            [
                s * w[0] + y_ * w[2] - z * w[1],
                s * w[1] + z * w[0] - x * w[2],
                s * w[2] + x * w[1] - y_ * w[0],
                -x * w[0] - y_ * w[1] - z * w[2],
            ]
        )
        moving = pin.Quaternion(q[3:] / np.linalg.norm(q[3:])).matrix() @ v[:3]
        return np.concatenate([moving, turning, pin.aba(model, data, q, v, np.zeros(6))])

    end = solve_ivp(rate, (0, DURATION), np.concatenate([Q0, V0]), rtol=1e-12, atol=1e-13, method="DOP853").y[:, -1]
    return np.asarray(end)


def tumble(robot: rt.Robot, mesh: rt.Mesh, tolerance: float = 1e-8) -> rt.Solution:
    phase = rt.Phase(robot, duration=DURATION, start=rt.State(q=Q0, v=V0))
    return rt.plan(phase, mesh=mesh, solver=rt.Ipopt(tolerance=tolerance))


@pytest.mark.parametrize(
    ("scheme", "order"),
    [
        (rt.HermiteSimpson(), 4),
        (rt.schemes.LobattoIIIA(4), 6),
        (rt.schemes.RadauIIA(2), 3),
        (rt.schemes.RadauIIA(3), 5),
    ],
    ids=lambda value: str(value),
)
def test_a_tumbling_body_agrees_with_scipy_to_the_order_of_the_scheme(
    robot: rt.Robot, reference: np.ndarray, scheme: rt.HermiteSimpson, order: int
) -> None:
    errors = []
    for intervals in (40, 80):
        end = tumble(robot, rt.Mesh(intervals, scheme)).at(DURATION)
        errors.append(np.abs(np.concatenate([end.q, end.v]) - reference).max())
    assert errors[1] < 2e-2
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.15)


def test_quaternions_have_length_one_at_every_collocation_point(robot: rt.Robot) -> None:
    part = tumble(robot, rt.Mesh(16, rt.HermiteSimpson()), 1e-10).phases[0]
    raw = part.trajectory.x(part.points)[:, 3:7]
    assert np.abs(np.linalg.norm(raw, axis=1) - 1.0).max() < 1e-9


def test_angular_momentum_in_the_world_is_kept(robot: rt.Robot) -> None:
    solution = tumble(robot, rt.Mesh(60, rt.schemes.LobattoIIIA(5)))
    data = robot.model.createData()
    momenta = []
    for t in solution.knots:
        sample = solution.at(t)
        momenta.append(pin.computeCentroidalMomentum(robot.model, data, sample.q, sample.v).angular.copy())
    assert np.abs(np.array(momenta) - momenta[0]).max() < 1e-8
    # The intermediate axis is unstable: the body turns over, its spin about y changes sign.
    assert min(solution.at(t).v[4] for t in solution.knots) < -3.0


def test_schemes_without_a_point_at_the_knots_are_refused(robot: rt.Robot) -> None:
    with pytest.raises(rt.InputError, match=r"holds root at its knots, but GaussLegendre .* rt.HermiteSimpson"):
        tumble(robot, rt.Mesh(4, rt.schemes.GaussLegendre(2)))
