"""A gear ratio is an armature: symbols agree with Pinocchio on the realised robot."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.dynamics.design.binding import Design

RATIO, ROTOR = 80.0, 3e-5


@pytest.fixture(scope="module")
def design(ur5: rt.Robot) -> Design:
    return Design(ur5, {"n": rt.design.GearRatio("elbow_joint", ROTOR), "m": rt.design.BodyMass("forearm_link")})


def test_the_dynamics_are_those_of_the_realised_robot(ur5: rt.Robot, design: Design) -> None:
    values = {"n": RATIO, "m": 3.0}
    robot = design.realise(values)
    assert robot.model.armature[2] == pytest.approx(ROTOR * RATIO**2)
    rng = np.random.default_rng(5)
    q, v, a, tau = rng.uniform(-1.5, 1.5, (4, ur5.nv))
    model, data = robot.model, robot.model.createData()
    symbolic, none = design.model(design.bodies(values)), ca.DM(6, ur5.model.njoints)
    mass = pin.crba(model, data, q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    expected = {
        "inverse_dynamics": ((q, v, a, none), pin.rnea(model, data, q, v, a)),
        "forward_dynamics": ((q, v, tau, none), pin.aba(model, data, q, v, tau)),
        "mass_matrix": ((q,), mass),
        "nonlinear_effects": ((q, v), pin.nle(model, data, q, v)),
        "kinetic_energy": ((q, v), 0.5 * v @ mass @ v),
    }
    for name, (arguments, value) in expected.items():
        found = np.array(ca.evalf(ca.SX(getattr(symbolic, name)(*map(ca.SX, arguments)))))
        np.testing.assert_allclose(found.squeeze(), value, rtol=1e-9, atol=1e-9, err_msg=name)


@pytest.mark.parametrize("dynamics", [rt.dynamics.InverseDynamics(), rt.dynamics.ForwardDynamics()])
def test_a_plan_with_its_gear_is_validated(arm: rt.Robot, dynamics: object) -> None:
    """The simulation by Pinocchio has the armature of the planned ratio."""
    swing = rt.Phase(
        arm,
        1.5,
        rt.State(q=[0, 0.3], v=0),
        rt.State(q=[0.5, -0.4], v=0),
        rt.Lagrange(lambda point: (point.tau[1] / point.p["n"]) ** 2 + point.tau[0] ** 2 / 1e4),
        parameters={"n": rt.between(10, 200)},
        design={"n": rt.design.GearRatio("elbow", 1e-3)},
        dynamics=dynamics,
        limits=None,
    )
    solution = rt.plan(swing, mesh=rt.Mesh(20))
    assert rt.validate(solution).passed
    assert 10.0 < solution.parameters["n"] < 200.0


@pytest.mark.parametrize("rotor", [0.0, -1e-5, np.inf, "1e-5"])
def test_the_inertia_of_a_rotor_is_a_number_above_zero(ur5: rt.Robot, rotor: object) -> None:
    with pytest.raises(rt.InputError, match="must be a number|number above 0"):
        Design(ur5, {"n": rt.design.GearRatio("elbow_joint", rotor)})  # type: ignore[arg-type]
