"""A phase refuses design parameters that cannot be optimised, and names them."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt


def phase(robot, design, parameters) -> rt.Phase:
    return rt.Phase(robot, duration=1.0, design=design, parameters=parameters)


@pytest.mark.parametrize(
    ("design", "parameters", "message"),
    [
        ({"m": rt.design.BodyMass("forarm")}, {"m": 1}, r"(?s)'forarm'.*forearm"),
        ({"m": rt.design.BodyMass("base")}, {"m": 1}, r"rt.design.BodyMass: 'base' does not move.*shoulder, elbow"),
        ({"w": rt.design.Payload("tp")}, {"w": 1}, r"(?s)'tp'.*tip"),
        ({"w": rt.design.Payload("base")}, {"w": 1}, r"rt.design.Payload: 'base' does not move"),
        ({"L": rt.design.LinkLength("forearm")}, {"L": 1}, r"(?s)'forearm'.*elbow"),
        ({"L": rt.design.LinkLength("elbow", tip="base")}, {"L": 1}, r"(?s)'base'.*tip"),
        ({"L": rt.design.LinkLength("elbow", tip="forearm")}, {"L": 1}, r"no length to its tip 'forearm'"),
        ({"L": rt.design.LinkLength("elbow", along=(0, 0, 1))}, {"L": 1}, r"'elbow' has no length"),
        ({"L": rt.design.LinkLength("elbow", along=(0, 0, 0))}, {"L": 1}, r"along=\(0, 0, 0\) is no direction"),
        ({"L": rt.design.LinkLength("elbow", along=(0, 1))}, {"L": 1}, r"along=\(0, 1\) is no direction"),
        ({"d": rt.design.JointDamping("wrist")}, {"d": 1}, r"(?s)'wrist'.*elbow"),
        ({"m": rt.design.BodyMass("forearm")}, {"n": 1}, r"(?s)'m'.*mass of body 'forearm'; add it to parameters="),
        ({"m": "forearm"}, {"m": 1}, r"'forearm' for parameter 'm'; give a quantity"),
        (
            {"m": rt.design.BodyMass("forearm")},
            {"m": -1},
            r"'m' is the mass of body 'forearm' and may be as low as -1;",
        ),
        ({"m": rt.design.BodyMass("forearm")}, {"m": rt.between(None, 2)}, r"as low as -inf"),
        ({"w": rt.design.Payload("tip")}, {"w": rt.between(-1, 2)}, r"payload at 'tip' and may be as low as -1"),
        ({"L": rt.design.LinkLength("elbow")}, {"L": rt.between(0, 2)}, r"more than 0"),
        ({"d": rt.design.JointDamping("elbow")}, {"d": -0.1}, r"damping of joint 'elbow' and may be as low as -0.1"),
        (
            {"m": rt.design.BodyMass("forearm"), "n": rt.design.BodyMass("elbow")},
            {"m": 1, "n": 1},
            r"'m' and 'n' both set the mass of body 'elbow'",
        ),
        (
            {"m": [rt.design.LinkLength("elbow"), rt.design.LinkLength("elbow")]},
            {"m": 1},
            r"'m' and 'm' both set the length",
        ),
    ],
)
def test_a_design_that_does_not_fit(arm, design, parameters, message: str) -> None:
    with pytest.raises(rt.InputError, match=message):
        phase(arm, design, parameters)


def test_systems_have_no_design() -> None:
    block = rt.System(["x", "v"], ["u"], lambda p: ca.vertcat(p.x["v"], p.u["u"] / p.p["m"]))
    with pytest.raises(rt.InputError, match=r"design, which is for robots.*point.p\[name\]"):
        phase(block, {"m": rt.design.BodyMass("block")}, {"m": 1})


def test_a_body_without_mass_has_no_shape() -> None:
    model = pin.Model()
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "hinge")
    model.appendBodyToJoint(
        model.addJoint(1, pin.JointModelRX(), pin.SE3.Identity(), "last"),
        pin.Inertia(1.0, np.ones(3), np.eye(3)),
        pin.SE3.Identity(),
    )
    model.upperVelocityLimit[:] = model.upperEffortLimit[:] = model.upperPositionLimit[:] = 1.0
    with pytest.raises(rt.InputError, match=r"'hinge' has no mass in the URDF.*rt.design.Payload"):
        phase(rt.load(model), {"m": rt.design.BodyMass("hinge")}, {"m": 1})


def test_several_children_leave_the_tip_open() -> None:
    model = pin.Model()
    place = pin.SE3(np.eye(3), np.array([1.0, 0, 0]))
    body = pin.Inertia(1.0, np.zeros(3), np.eye(3))
    trunk = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "trunk")
    for joint in [trunk, *(model.addJoint(trunk, pin.JointModelRX(), place, n) for n in ("left", "right"))]:
        model.appendBodyToJoint(joint, body, pin.SE3.Identity())
    model.upperVelocityLimit[:] = model.upperEffortLimit[:] = model.upperPositionLimit[:] = 1.0
    robot = rt.load(model)
    with pytest.raises(rt.InputError, match=r"several joints \(left, right\).*tip='left'"):
        phase(robot, {"L": rt.design.LinkLength("trunk")}, {"L": 2.0})
    longer = phase(robot, {"L": rt.design.LinkLength("trunk", tip="left")}, {"L": 2.0}).bound_design
    places = longer.realise({"L": 2.0}).model.jointPlacements
    assert [p.translation[0] for p in places][2:] == [2.0, 2.0]


def test_the_phase_prints_what_its_parameters_are(arm) -> None:
    printed = str(phase(arm, {"m": rt.design.BodyMass("forearm")}, {"m": rt.between(0.5, 2), "other": 1.0}))
    row = next(line for line in printed.splitlines() if "forearm" in line)
    assert row.split() == ["parameter", "m", "(mass", "of", "body", "'forearm')", "0.5", "..", "2", "kg"]
