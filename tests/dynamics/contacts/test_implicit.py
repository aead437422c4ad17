"""Implicit contacts against closed forms of a sliding and a falling point, and on the hopper."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

G = 9.81
INTERVALS = 50


def point_mass() -> rt.Robot:
    """A 2 kg body that does not turn, above the ground."""
    model = pin.Model()
    model.name = "mass"
    x = model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), "x")
    z = model.addJoint(x, pin.JointModelPZ(), pin.SE3.Identity(), "z")
    model.appendBodyToJoint(z, pin.Inertia(2.0, np.zeros(3), 1e-2 * np.eye(3)), pin.SE3.Identity())
    model.addFrame(pin.Frame("body", z, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    return rt.load(model, actuated=[])


def let_go(height: float, speed: float, friction: float, duration: float) -> rt.Solution:
    phase = rt.Phase(
        point_mass(),
        duration=duration,
        contacts=[rt.contacts.ImplicitContact("body", friction=friction, relaxation=1e-5)],
        start=rt.State(q=[0.0, height], v=[speed, 0.0]),
        limits=None,
    )
    return rt.plan(
        phase,
        mesh=rt.Mesh(INTERVALS, rt.schemes.RadauIIA(1)),
        continuation=rt.planning.tightening(phase, [1.0, 0.1, 1e-2, 1e-3]),
    )


def test_friction_stops_a_sliding_mass() -> None:
    friction, speed = 0.4, 2.0
    stop = speed / (friction * G)
    solution = let_go(0.0, speed, friction, 1.5 * stop)
    end = solution.at(solution.duration)
    assert end.v == pytest.approx(0.0, abs=2e-3)
    # Implicit Euler is off by half a step at this speed.
    step = solution.duration / INTERVALS
    assert end.q[0] == pytest.approx(speed * stop / 2, abs=speed * step)
    force = solution.at(0.4 * stop).forces["body"]
    assert force == pytest.approx([-friction * 2.0 * G, 0.0, 2.0 * G], rel=1e-3, abs=1e-3)
    resting = solution.at(1.45 * stop).forces["body"]
    assert abs(resting[0]) < 0.05 and resting[2] == pytest.approx(2.0 * G, rel=1e-3)


def test_a_falling_mass_is_caught_and_stays() -> None:
    height = 0.2
    fall = np.sqrt(2 * height / G)
    solution = let_go(height, 0.0, 0.5, 2 * fall)
    times = solution.knots[1:]
    sample = solution.at(times)
    landed = times > fall + 2 * solution.duration / INTERVALS
    assert sample.q[:, 1].min() > -1e-8
    assert np.abs(sample.q[landed, 1]).max() < 1e-4
    assert sample.forces["body"][times < fall - 2 * solution.duration / INTERVALS, 2].max() < 1e-3
    # The impact cancels the momentum of the fall: the impulse of all forces is weight times time.
    steps = np.diff(solution.knots)
    middle = solution.at(solution.knots[:-1] + 0.5 * steps).forces["body"][:, 2]
    assert steps @ middle == pytest.approx(2.0 * G * solution.duration, rel=1e-3)


@pytest.mark.slow
def test_a_hopper_finds_its_own_steps() -> None:
    robot = rt.load("hopper", root="planar")
    stand = {"root_z": 0.5, "root_pitch": 0.0, "hip": 0.0, "leg": 0.5}
    phase = rt.Phase(
        robot,
        duration=1.0,
        contacts=[rt.contacts.ImplicitContact("foot", friction=0.8, relaxation=1e-4)],
        start=rt.State(q=stand | {"root_x": 0.0}, v=0),
        end=rt.State(q=stand | {"root_x": 0.5}, v=0),
        objective=rt.Effort({"hip": 1.0, "leg": 0.01}),
    )
    solution = rt.plan(
        phase,
        mesh=rt.Mesh(30, rt.schemes.RadauIIA(1)),
        continuation=rt.planning.tightening(phase, [1.0, 0.1, 1e-2, 1e-3]),
    )
    data = robot.model.createData()
    gaps, forces = [], []
    for t in solution.knots[1:]:
        sample = solution.phases[0].at(t, min(int(np.searchsorted(solution.knots, t)) - 1, 29))
        pin.framesForwardKinematics(robot.model, data, sample.q)
        gaps.append(data.oMf[robot.frame("foot")].translation[2])
        forces.append(sample.forces["foot"])
    gap, force = np.array(gaps), np.array(forces)
    assert gap.min() > -1e-7
    assert (gap * force[:, 2]).max() < 1.1e-4
    assert (np.abs(force[:, 0]) <= 0.8 * force[:, 2] + 1e-6).all()
    # The foot left the ground and came down again, more than once forward in all.
    up = gap > 5e-3
    assert up.any() and not up[-1] and force[:, 2].max() > 30.0


@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (lambda: rt.contacts.ImplicitContact("foot", relaxation=0.0), "relaxation"),
        (lambda: rt.contacts.ImplicitContact("foot", ground=rt.terrain.Steps([0.5], [0.0, 0.1])), "plane"),
        (lambda: rt.contacts.ImplicitContact("foot", friction=-1.0), "friction"),
    ],
)
def test_bad_input_is_refused(make: object, expected: str) -> None:
    with pytest.raises(rt.InputError, match=expected):
        make()


def test_tightening_needs_an_implicit_contact_and_a_descent() -> None:
    robot = rt.load("hopper", root="planar")
    held = rt.Phase(robot, duration=1.0, contacts=[rt.PointContact("foot")])
    with pytest.raises(rt.InputError, match="ImplicitContact"):
        rt.planning.tightening(held, [1.0])
    loose = rt.Phase(robot, duration=1.0, contacts=[rt.contacts.ImplicitContact("foot")])
    with pytest.raises(rt.InputError, match="descend"):
        rt.planning.tightening(loose, [0.1, 1.0])
