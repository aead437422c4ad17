"""Motors and payloads on a ur5, planned by the default call and checked with plain Pinocchio."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

Q0 = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])
Q1 = np.array([1.1, -0.8, 0.6, -0.6, -0.6, 1.2])
BOX = rt.robot.CarriedBody("tool0", 4.0, (0.0, 0.0, 0.1), (0.02, 0.02, 0.01))


@pytest.fixture(scope="module")
def arm():
    return rt.load("ur5")


def _reach(robot, *constraints):
    return rt.Phase(
        robot, (0.1, 10.0), rt.State(q=Q0, v=0), rt.State(q=Q1, v=0), rt.Duration(), constraints=constraints
    )


def _sampled(solution):
    return solution.at(np.linspace(0.0, solution.duration, 2001))


def test_a_curve_of_torque_over_speed_holds_between_the_points(arm):
    curve = rt.constraints.SpeedTorqueCurve({"shoulder_pan_joint": 150.0}, 3.15)
    with pytest.raises(rt.InputError):
        rt.constraints.SpeedTorqueCurve(-1.0, 3.15).bind(_reach(arm).body)
    solution = rt.plan(_reach(arm, curve))
    sample = _sampled(solution)
    assert np.abs(sample.tau[:, 0] / 150.0 + sample.v[:, 0] / 3.15).max() < 1 + 2e-3
    assert rt.validate(solution).passed


def test_power_is_limited(arm):
    limit = rt.constraints.MotorPower({"shoulder_lift_joint": 120.0}, total=200.0)
    solution = rt.plan(_reach(arm, limit))
    sample = _sampled(solution)
    power = sample.tau * sample.v
    assert np.abs(power[:, 1]).max() < 120 * (1 + 2e-3) and power.sum(axis=1).max() < 200 * (1 + 2e-3)
    free = _sampled(rt.plan(_reach(arm)))
    assert (free.tau * free.v).sum(axis=1).max() > 220


def test_a_carried_body_adds_its_own_inverse_dynamics(arm):
    """The torques that the body adds are J' times the force and moment of a rigid body, and M grows by J' I J."""
    q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, 6))
    loaded = rt.robot.carrying(arm, BOX)
    torques = [pin.rnea(each.model, each.model.createData(), q, v, a).copy() for each in (loaded, arm)]
    data, frame = arm.model.createData(), arm.frame("tool0")
    pin.forwardKinematics(arm.model, data, q, v, a)
    pin.updateFramePlacements(arm.model, data)
    inertia, local = BOX.spatial_inertia, pin.ReferenceFrame.LOCAL
    moved, sped = (read(arm.model, data, frame, local) for read in (pin.getFrameVelocity, pin.getFrameAcceleration))
    down = pin.Motion(data.oMf[frame].rotation.T @ arm.model.gravity.linear, np.zeros(3))
    force = inertia * (sped - down) + moved.cross(inertia * moved)
    jacobian = pin.computeFrameJacobian(arm.model, data, q, frame, local)
    assert np.allclose(torques[0] - torques[1], jacobian.T @ force.vector, atol=1e-9)
    assert loaded.mass == pytest.approx(arm.mass + 4.0)


def test_a_body_is_grasped_and_released_between_phases(arm, tmp_path):
    loaded = rt.robot.carrying(arm, BOX)
    carry = rt.Phase(loaded, (0.1, 5.0), rt.State(q=Q0, v=0), rt.State(q=Q1, v=0), rt.Duration(), name="carry")
    back = rt.Phase(arm, (0.1, 5.0), rt.State(q=Q1, v=0), rt.State(q=Q0, v=0), rt.Duration(), name="back")
    solution = rt.plan(rt.Problem([carry, back], [rt.Continuity(0, 1)]))
    assert solution.phases[0].duration > solution.phases[1].duration
    assert rt.validate(solution).passed
    solution.save(tmp_path / "carry.npz")
    again = rt.load_solution(tmp_path / "carry.npz")
    assert again.phases[0].robot.mass == pytest.approx(again.phases[1].robot.mass + 4.0)


def test_one_motion_serves_every_payload(arm, tmp_path):
    bodies = [rt.robot.CarriedBody("tool0", mass, (0.0, 0.0, 0.1)) for mass in (2.0, 5.0)]
    solution = rt.plan(_reach(arm, rt.constraints.PayloadScenarios(bodies)))
    sample = _sampled(solution)
    for body in bodies:
        model = rt.robot.carrying(arm, body).model
        data = model.createData()
        needed = np.array([pin.rnea(model, data, *row) for row in zip(sample.q, sample.v, sample.a, strict=True)])
        assert (np.abs(needed) < arm.limits.effort * (1 + 2e-3)).all()
    assert solution.duration > rt.plan(_reach(arm)).duration * 1.01
    assert rt.validate(solution).passed
    solution.save(tmp_path / "payloads.npz")
    again = rt.load_solution(tmp_path / "payloads.npz").problem.phases[0].constraints[0]
    assert [body.mass for body in again.payloads] == [2.0, 5.0]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: rt.robot.CarriedBody("tool0", -1.0), "above 0"),
        (lambda: rt.robot.CarriedBody("tool0", "4 kg"), "mass '4 kg'"),
        (lambda: rt.robot.CarriedBody("tool0", 1.0, (0.0, 0.1)), "3 numbers; got"),
        (lambda: rt.robot.CarriedBody("tool0", 1.0, ("x", "y", "z")), "3 numbers; got"),
        (lambda: rt.robot.CarriedBody("tool0", 1.0, inertia=(0.1, 0.1)), "shape"),
        (lambda: rt.robot.CarriedBody("tool0", 1.0, inertia=(np.inf, 0.1, 0.1)), "finite"),
        (lambda: rt.robot.CarriedBody("tool0", 1.0, inertia=np.full((3, 3), np.inf)), "finite"),
        (lambda: rt.robot.CarriedBody("tool0", 1.0, inertia=("a", 0.1, 0.1)), "finite"),
        (lambda: rt.robot.CarriedBody("tool0", 1.0, inertia=(1.0, 0.1, 0.1)).spatial_inertia, "impossible inertia"),
        (lambda: rt.robot.carrying(rt.load("ur5"), rt.robot.CarriedBody("universe", 1.0)), "does not move"),
    ],
)
def test_bodies_that_are_none_are_refused(make, words):
    with pytest.raises(rt.InputError, match=words):
        make()


def test_a_robot_carries_bodies_alone() -> None:
    with pytest.raises(rt.InputError, match=r"'ur5' carries rt\.robot\.CarriedBody\(frame, mass\) values; got 3\.0"):
        rt.robot.carrying(rt.load("ur5"), 3.0)  # type: ignore[arg-type]
