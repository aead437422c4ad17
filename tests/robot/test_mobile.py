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


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_a_carriage_slides_the_whole_arm_and_feels_its_weight(axis):
    arm = rt.load("ur5")
    cell = rt.robot.on_rail(arm, 20.0, (-1.0, 1.5), velocity=1.5, effort=900.0, axis=axis)
    assert cell.limits.joints[0] == "rail" and cell.nu == 7
    assert cell.mass == pytest.approx(arm.mass + arm.model.inertias[0].mass + 20.0)  # the root link moves now
    assert [side[0] for side in cell.limits.sides("position")] == [-1.0, 1.5]
    assert len(cell.visual_model.geometryObjects) == len(arm.visual_model.geometryObjects)
    q = np.random.default_rng(3).normal(size=6)
    places = []
    for robot, there in ((arm, q), (cell, np.append(0.7, q))):
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, there)
        places.append(data.oMf[robot.frame("tool0")].copy())
    along = {"x": 0, "y": 1, "z": 2}[axis]
    np.testing.assert_allclose(places[1].translation - places[0].translation, 0.7 * np.eye(3)[along], atol=1e-12)
    np.testing.assert_allclose(places[1].rotation, places[0].rotation, atol=1e-12)
    still = pin.computeGeneralizedGravity(cell.model, cell.model.createData(), np.append(0.7, q))
    assert still[0] == pytest.approx(9.81 * cell.mass if axis == "z" else 0.0, abs=1e-9)


def test_a_carriage_takes_its_least_time():
    """Bang-bang: 2 sqrt(d (m + M) / F) for an arm whose joints stay."""
    arm = rt.load("two_link_arm")
    cell = rt.robot.on_rail(arm, 10.0, (0.0, 2.0), velocity=50.0, effort=25.0)
    cell = rt.load(cell.model, locked={"shoulder": 0.0, "elbow": 0.0}, limits={"effort": 25.0, "velocity": 50.0})
    move = rt.Phase(cell, (0.1, 9.0), rt.State(q=0, v=0), rt.State(q=1.0, v=0), rt.Duration())
    assert rt.plan(move).duration == pytest.approx(2.0 * np.sqrt(cell.mass / 25.0), rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"axis": "w"}, "'x', 'y', 'z'"),
        ({"mass": 0.0}, "mass of the rail"),
        ({"travel": (1.0, -1.0)}, "least, greatest"),
        ({"name": "tool0"}, "'tool0' already"),
    ],
)
def test_a_rail_that_cannot_be_is_refused(changes, message):
    given = {"mass": 5.0, "travel": (-1.0, 1.0), "velocity": 1.0, "effort": 100.0} | changes
    with pytest.raises(rt.InputError, match=message):
        rt.robot.on_rail(rt.load("ur5"), **given)


def test_rails_and_loads_in_other_units_are_doubted():
    ur5 = rt.load("ur5")
    with pytest.warns(UserWarning, match="goes to 2000 m.* 2000 mm are 2 m"):
        rt.robot.on_rail(ur5, mass=20.0, travel=(0, 2000), velocity=1.5, effort=500)
    with pytest.warns(UserWarning, match="is 100 m from this frame.* 100 mm are 0.1 m"):
        rt.robot.carrying(ur5, rt.robot.CarriedBody("tool0", mass=2, center_of_mass=(0, 0, 100)))
    with pytest.warns(UserWarning, match="weighs 500 kg, and 'ur5' .* 500 g are 0.5 kg"):
        rt.robot.carrying(ur5, rt.robot.CarriedBody("tool0", mass=500))


def test_a_carriage_and_a_base_in_grams_are_doubted() -> None:
    ur5 = rt.load("ur5")
    with pytest.warns(UserWarning, match=r"carriage of 'ur5.*' weighs 20000 kg.* 20000 g are 20 kg"):
        rt.robot.on_rail(ur5, mass=20_000, travel=(0, 2), velocity=1.5, effort=500)
    with pytest.warns(UserWarning, match=r"base of 'ur5.*' weighs 60000 kg.* 60000 g are 60 kg"):
        rt.robot.on_wheels(ur5, mass=60_000, inertia=5.0)


@pytest.mark.parametrize("goal", [(1.9, 0.7, 0.5), (1.5, -0.6, 0.4)])
def test_least_times_of_an_arm_on_wheels_need_no_other_solver(goal):
    home = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])
    wheels = rt.constraints.DifferentialDrive(radius=0.1, track=0.4, speed=15.0, torque=20.0)
    fetch = rt.Phase(
        rt.robot.on_wheels(rt.load("ur3"), mass=40.0, inertia=2.0),
        duration=(0.1, 20.0),
        start=rt.State(q=[0, 0, 0, *home], v=0),
        end=rt.State(v=0),
        objective=rt.Duration() + 1e-3 * rt.objectives.SpeedVariation(),
        constraints=[wheels, rt.AtEnd(rt.FramePosition("tool0", goal))],
    )
    solution = rt.plan(fetch, solver=rt.InteriorPoint(fallback=None))
    assert solution.proved
    last = solution.at(solution.duration)
    data = (model := fetch.robot.model).createData()
    pin.framesForwardKinematics(model, data, last.q)
    np.testing.assert_allclose(data.oMf[fetch.robot.frame("tool0")].translation, goal, atol=1e-4)
