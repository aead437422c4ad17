"""Planning together with design, against optima in closed form."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

FORMS = [rt.dynamics.InverseDynamics(), rt.dynamics.ForwardDynamics()]


def reach(robot: rt.Robot, **more) -> rt.Phase:
    """Rest to rest in 1.5 s, with the fewest torques."""
    start, end = rt.State(q=robot.neutral, v=0), rt.State(q=robot.neutral + 0.4, v=0)
    return rt.Phase(robot, duration=1.5, start=start, end=end, limits=None, **{"objective": rt.Effort()} | more)


@pytest.mark.parametrize("dynamics", FORMS)
def test_least_time_takes_the_lightest_block(dynamics) -> None:
    """|F| <= 1 N over 10 m: T = 2 sqrt(10 m), so m is its lower bound, 0.5 kg."""
    move = rt.Phase(
        rt.load("block"),
        duration=(1, 20),
        start=rt.State(q=0, v=0),
        end=rt.State(q=10, v=0),
        objective=rt.Duration(),
        parameters={"m": rt.between(0.5, 2)},
        design={"m": rt.design.BodyMass("block")},
        dynamics=dynamics,
    )
    solution = rt.plan(move, mesh=rt.Mesh(2, rt.HermiteSimpson()))
    assert solution.phases[0].parameters["m"] == pytest.approx(0.5, abs=1e-8)
    assert solution.duration == pytest.approx(2 * np.sqrt(10 * 0.5), abs=2e-8)


def test_phases_share_a_mass() -> None:
    """The same motion in two phases: one mass, one time."""
    halves = [
        rt.Phase(
            rt.load("block"),
            duration=(0.5, 20),
            start=rt.State(q=start, v=0 if start == 0 else None),
            end=rt.State(q=start + 5, v=None if start == 0 else 0),
            objective=rt.Duration(),
            parameters={"m": rt.between(0.5, 2)},
            design={"m": rt.design.BodyMass("block")},
        )
        for start in (0, 5)
    ]
    links = [rt.Continuity(0, 1), rt.links.SameParameter("m")]
    solution = rt.plan(rt.Problem(halves, links), mesh=rt.Mesh(2))
    masses = [part.parameters["m"] for part in solution.phases]
    assert masses == pytest.approx([0.5, 0.5], abs=1e-8)
    assert solution.duration == pytest.approx(2 * np.sqrt(10 * 0.5), abs=2e-8)


@pytest.mark.parametrize("dynamics", FORMS)
@pytest.mark.parametrize("name", ["two_link_arm", "ur5"])
def test_the_urdfs_own_values_give_the_plan_without_design(name: str, dynamics) -> None:
    robot = rt.load(name)
    joint, last = robot.joint_names[1], robot.model.frames[-1].name
    design = {"m": rt.design.BodyMass(joint), "L": rt.design.LinkLength(joint), "w": rt.design.Payload(last)}
    own = {"m": robot.model.inertias[2].mass, "L": design["L"].original(robot)[0], "w": 0.0}
    mesh = rt.Mesh(8)
    # The same solver and the same operations: without a design the default would be others.
    same = {"mesh": mesh, "solver": rt.Ipopt(), "engine": rt.engines.VirtualMachine()}
    plain = rt.plan(reach(robot, dynamics=dynamics), **same)
    designed = rt.plan(reach(robot, dynamics=dynamics, design=design, parameters=own), **same)
    assert designed.objective == pytest.approx(plain.objective, rel=1e-11)
    times = plain.phases[0].points
    np.testing.assert_allclose(designed.at(times).tau, plain.at(times).tau, rtol=0, atol=1e-7)


def test_a_payload_plans_as_the_urdf_with_that_mass(arm, tmp_path) -> None:
    heavy = tmp_path / "heavy.urdf"
    text = arm.geometry.urdf.read_text()
    heavy.write_text(
        text.replace('<mass value="1"/>\n      <inertia ixx="0" ', '<mass value="1.7"/>\n      <inertia ixx="0" ')
    )
    assert heavy.read_text() != text
    loaded = rt.plan(reach(arm, parameters={"w": 0.7}, design={"w": rt.design.Payload("tip")}), mesh=rt.Mesh(10))
    expected = rt.plan(reach(rt.load(heavy)), mesh=rt.Mesh(10))
    assert loaded.objective == pytest.approx(expected.objective, rel=1e-11)


ARC, TIME = 1.2, 0.8
MASSES = np.array([0.7, 0.5, 0.9, 0.9])
POINTS = np.array([[0.5, 0, 0], [1.0, 0, 0], [0, 0.3, 0], [0, -0.3, 0]])
ALONG, ACROSS = 0.7 * 0.25 + 0.5, 2 * 0.9 * 0.09
"""Moments int x^2 dm and int y^2 dm of the beam of 1 m [kg m^2]."""


def sweep(robot: rt.Robot, length: object) -> rt.Phase:
    """Sweep an arc of the tip, L q = ARC, from rest to rest in TIME."""
    return rt.Phase(
        robot,
        duration=TIME,
        start=rt.State(q=0, v=0),
        end=rt.State(v=0),
        objective=rt.Effort(),
        constraints=[
            rt.AtEnd(rt.PathConstraint(lambda p: p.p["L"] * p.q[0], lower=ARC, upper=ARC, name="arc", unit="m"))
        ],
        parameters={"L": length},
        design={"L": rt.design.LinkLength("hinge")},
    )


def effort(length: float) -> float:
    """Integral of tau^2 = 12 I^2 angle^2 / T^3 with I = ALONG L^2 + ACROSS, angle = ARC / L."""
    return 12 * (ALONG * length**2 + ACROSS) ** 2 * (ARC / length) ** 2 / TIME**3


def test_the_best_length_balances_inertia_and_angle(beam) -> None:
    """The least of (ALONG L + ACROSS / L)^2 is at L = sqrt(ACROSS / ALONG)."""
    solution = rt.plan(sweep(beam(MASSES, POINTS, 1.0), rt.between(0.1, 3)), mesh=rt.Mesh(4))
    assert solution.phases[0].parameters["L"] == pytest.approx(np.sqrt(ACROSS / ALONG), rel=1e-6)
    assert solution.objective == pytest.approx(effort(np.sqrt(ACROSS / ALONG)), rel=1e-9)


def test_cost_follows_the_length(beam) -> None:
    """Values and, by central differences of plans, derivatives of the cost by the length."""
    robot = beam(MASSES, POINTS, 1.0)
    step = 1e-4
    for length in (0.3, 0.8, 1.5):
        below, at, above = (
            rt.plan(sweep(robot, trial), mesh=rt.Mesh(4)).objective for trial in (length - step, length, length + step)
        )
        assert at == pytest.approx(effort(length), rel=1e-9)
        slope = 2 * at * (ALONG - ACROSS / length**2) / (ALONG * length + ACROSS / length)
        assert (above - below) / (2 * step) == pytest.approx(slope, rel=1e-5)


def test_a_counterweight_shares_the_holding_torque() -> None:
    """An arm held level for T: the least T g^2 (m l - w b)^2 + w^2 is at w = T g^2 b m l / (1 + T g^2 b^2)."""
    mass, lever, back, time, g = 1.3, 0.4, 0.15, 0.7, 9.81
    model = pin.Model()
    hinge = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "hinge")
    model.appendBodyToJoint(hinge, pin.Inertia(mass, np.array([lever, 0, 0]), 0.01 * np.eye(3)), pin.SE3.Identity())
    place = pin.SE3(np.eye(3), np.array([-back, 0, 0]))
    model.addFrame(pin.Frame("back", hinge, 0, place, pin.FrameType.OP_FRAME))
    model.upperEffortLimit[:] = model.upperVelocityLimit[:] = 1e30
    model.lowerPositionLimit[:], model.upperPositionLimit[:] = -3, 3
    hold = rt.Phase(
        rt.load(model),
        duration=time,
        start=rt.State(q=0, v=0),
        end=rt.State(q=0, v=0),
        states={"q.hinge": 0.0},
        objective=rt.Effort() + rt.Mayer(lambda start, end: (end.mass - mass) ** 2),
        parameters={"w": rt.between(0, 10)},
        design={"w": rt.design.Payload("back")},
    )
    solution = rt.plan(hold, mesh=rt.Mesh(3))
    stiffness = time * g**2
    expected = stiffness * back * mass * lever / (1 + stiffness * back**2)
    assert solution.phases[0].parameters["w"] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("given", [0.9, rt.between(0.9, 4)], ids=["fixed", "free"])
def test_damping_costs_what_it_takes(beam, given) -> None:
    """From rest to rest the effort is int I^2 a^2 + d^2 v^2, least at the least d.

    Its minimum over the motion is d^2 angle^2 / (T - 2 tanh(k T / 2) / k) with k = d / I.
    """
    turn = rt.Phase(
        beam(MASSES, POINTS, 1.0),
        duration=TIME,
        start=rt.State(q=0, v=0),
        end=rt.State(q=1.1, v=0),
        objective=rt.Effort(),
        parameters={"d": given},
        design={"d": rt.design.JointDamping("hinge")},
    )
    solution = rt.plan(turn, mesh=rt.Mesh(8, rt.schemes.FifthDegree()))
    rate = 0.9 / (ALONG + ACROSS)
    expected = 0.9**2 * 1.1**2 / (TIME - 2 * np.tanh(rate * TIME / 2) / rate)
    assert solution.phases[0].parameters["d"] == pytest.approx(0.9, abs=1e-7)
    assert solution.objective == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize(
    "objective",
    [rt.Effort(), rt.objectives.TorqueRate(), rt.objectives.Jerk(), rt.objectives.CostOfTransport("tip", (0, 1, 0))],
)
def test_objectives_of_every_kind_see_the_design(arm, objective) -> None:
    """A fixed payload gives the plan of the robot that weighs it."""
    design = {"w": rt.design.Payload("tip"), "L": rt.design.LinkLength("shoulder")}
    values = {"w": 0.7, "L": 1.2}
    # The arm's axes are vertical and its gravity along them; the cost of transport divides by the weight.
    heavy = rt.load(arm.model)
    total = objective + 1e-3 * rt.Effort()
    same = {"mesh": rt.Mesh(8), "solver": rt.Ipopt()}
    designed = rt.plan(reach(heavy, objective=total, parameters=values, design=design), **same)
    plain = rt.plan(reach(designed.phases[0].robot, objective=total), **same)
    assert designed.objective == pytest.approx(plain.objective, rel=1e-9)
