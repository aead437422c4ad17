"""A robot on wheels: its base rolls along its heading, and the arm on it is the arm alone at rest."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt


@pytest.fixture(scope="module")
def base():
    return rt.robot.on_wheels(rt.load("two_link_arm"), mass=20.0, inertia=0.8)


def drive(base, end, **limits):
    return rt.Phase(
        base,
        duration=4.0,
        start=rt.State(q=0, v=0),
        end=rt.State(q=end, v=0),
        objective=rt.Effort(),
        constraints=[rt.constraints.DifferentialDrive(radius=0.1, track=0.4, **limits)],
        limits=None,
    )


def test_the_arm_is_as_on_a_fixed_root_while_the_base_rests(base):
    arm = rt.load("two_link_arm")
    rng = np.random.default_rng(2)
    q, v, a = rng.normal(size=(3, arm.nv))
    still = np.zeros(3)
    whole = pin.rnea(base.model, base.model.createData(), np.append(still, q), np.append(still, v), np.append(still, a))
    np.testing.assert_allclose(whole[3:], pin.rnea(arm.model, arm.model.createData(), q, v, a), atol=1e-12)
    assert base.mass == pytest.approx(arm.mass + 20.0)
    assert len(base.visual_model.geometryObjects) == len(arm.visual_model.geometryObjects)


def test_a_base_rolls_along_its_heading(base, tmp_path):
    solution = rt.plan(drive(base, [0.8, 0.6, 0.0, 0.0, 0.0], speed=12.0))
    assert solution.success and solution.proof.motion_holds
    assert rt.validate(solution).passed
    sample = solution.at(np.linspace(0.0, 4.0, 401))
    yaw, v = sample.q[:, 2], sample.v
    lateral = np.cos(yaw) * v[:, 1] - np.sin(yaw) * v[:, 0]
    forward = np.cos(yaw) * v[:, 0] + np.sin(yaw) * v[:, 1]
    assert np.abs(lateral).max() < 1e-3
    assert np.abs(forward).max() > 0.2 and np.abs(yaw).max() > 0.3
    for side in (-1.0, 1.0):
        assert np.abs((forward + side * 0.2 * v[:, 2]) / 0.1).max() < 12.0 + 1e-2
    again = rt.load_solution(solution.save(tmp_path / "base.npz"))
    assert again.phases[0].phase.constraints == solution.phases[0].phase.constraints


def test_torques_of_wheels_and_friction_are_bounded(base):
    ahead = drive(base, [1.5, 0.0, 0.0, 0.0, 0.0], torque=0.5, lateral_force=3.0)
    solution = rt.plan(ahead, mesh=rt.Mesh(12), check=False)
    assert solution.success
    sample = solution.at(solution.knots)
    yaw, tau = sample.q[:, 2], sample.tau
    half = 0.5 * (np.cos(yaw) * tau[:, 0] + np.sin(yaw) * tau[:, 1])
    for side in (-1.0, 1.0):
        assert np.abs((half + side * tau[:, 2] / 0.4) * 0.1).max() < 0.5 + 1e-6
    assert np.abs(np.cos(yaw) * tau[:, 1] - np.sin(yaw) * tau[:, 0]).max() < 3.0 + 1e-6
    free = rt.plan(drive(base, [1.5, 0.0, 0.0, 0.0, 0.0]), mesh=rt.Mesh(12))
    assert solution.objective > free.objective + 1e-3  # the limit of the wheels is active


def test_sideways_is_impossible_without_turning(base):
    straight = rt.Phase(
        base,
        duration=2.0,
        start=rt.State(q=0, v=0),
        end=rt.State(q=[0.0, 0.5, 0.0, 0.0, 0.0], v=0),
        objective=rt.Effort(),
        states={"q.base_yaw": 0.0},
        constraints=[rt.constraints.DifferentialDrive(radius=0.1, track=0.4)],
        limits=None,
    )
    assert not rt.plan(straight, mesh=rt.Mesh(8), check=False).success


def test_bad_input(base):
    with pytest.raises(rt.InputError, match="above 0"):
        rt.robot.on_wheels(rt.load("two_link_arm"), mass=0.0, inertia=1.0)
    with pytest.raises(rt.InputError, match="base_x"):
        rt.robot.on_wheels(base, mass=1.0, inertia=1.0)
    with pytest.raises(rt.InputError, match="planar root"):
        rt.robot.on_wheels(rt.load("two_link_arm", root="planar"), mass=1.0, inertia=1.0)
    with pytest.raises(rt.InputError, match="track"):
        rt.constraints.DifferentialDrive(radius=0.1, track=0.0)
    with pytest.raises(rt.InputError, match="on_wheels"):
        rt.Phase(rt.load("ur5"), 1.0, constraints=[rt.constraints.DifferentialDrive(radius=0.1, track=0.4)])
