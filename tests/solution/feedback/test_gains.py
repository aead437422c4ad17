"""``solution.gains``: their values, where they are saved, and why some plans have none."""

import csv
import json

import numpy as np
import pinocchio as pin
import pytest
import scipy

import robotraj as rt


@pytest.fixture(scope="module")
def reach():
    robot = rt.load("ur5")
    start = rt.State(q=[0.0, -1.0, 1.0, 0.0, 0.5, 0.0], v=0)
    end = rt.State(q=[0.5, -1.5, 1.2, 0.3, 0.0, 0.5], v=0)
    return rt.plan(rt.Phase(robot, 1.0, start, end, rt.Effort()), rt.Mesh(20), check=False)


def test_a_fully_actuated_arm_gets_its_mass_matrix_times_one_bandwidth(reach):
    robot, gains = reach.phases[0].phase.robot, reach.gains
    assert gains.matrices.shape == (len(gains.times), 6, 12) and gains.joints == tuple(robot.actuated)
    for t in (0.3, 0.6, 1.0):
        mass = pin.crba(robot.model, robot.model.createData(), reach.at(t).q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        # Gains that are constant over 20 ms are a little lower than those of continuous time.
        for part, factor in ((slice(0, 6), 20.0**2), (slice(6, 12), 20.0 * np.sqrt(3.0))):
            off = np.linalg.norm(gains.at(t)[:, part] - factor * mass) / np.linalg.norm(factor * mass)
            assert off < 0.26


def test_growth_of_an_inverted_pendulum_is_that_of_its_exponential():
    model = pin.Model()
    hinge = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "hinge")
    model.appendBodyToJoint(hinge, pin.Inertia(1.0, np.array([0.0, 0.0, 1.0]), np.zeros((3, 3))), pin.SE3.Identity())
    upright = rt.State(q=[0.0], v=0)
    phase = rt.Phase(rt.load(model), 1.0, upright, upright, rt.Effort(), limits=None)
    solution = rt.plan(phase, rt.Mesh(20), check=False)
    rate = np.array([[0.0, 1.0], [9.81, 0.0]])
    scale = np.diag([1.0, 0.1])
    exact = np.linalg.norm(scale @ scipy.linalg.expm(rate) @ np.linalg.inv(scale), 2)
    assert solution.gains.growth == pytest.approx(exact, rel=1e-4)


def test_files_keep_the_gains(reach, tmp_path):
    again = rt.load_solution(reach.save(tmp_path / "reach"))
    assert "gains" in vars(again)
    np.testing.assert_array_equal(again.gains.matrices, reach.gains.matrices)
    assert again.gains.coordinates == reach.gains.coordinates and again.gains.growth == reach.gains.growth


def test_tables_hold_them_where_asked_for(reach, tmp_path):
    path = reach.to_csv(tmp_path / "reach.csv", samples=[0.1, 0.3], gains=True)
    with path.open() as file:
        first, _ = csv.DictReader(file)
    assert float(first["gain.elbow_joint.q.wrist_1_joint [N m/rad]"]) == reach.gains.at(0.1)[2, 3]
    assert float(first["gain.elbow_joint.v.elbow_joint [N m/(rad/s)]"]) == reach.gains.at(0.1)[2, 8]
    assert not any("gain" in name for name in json.loads(reach.to_json(tmp_path / "r.json").read_text())["units"])


def test_a_system_has_none_and_is_saved_without(tmp_path):
    block = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]], name="cart")
    phase = rt.Phase(block, 1.0, start=rt.State([0, 0]), end=rt.State([1, 0]), objective=rt.Effort(), name="push")
    solution = rt.plan(phase, rt.Mesh(4))
    with pytest.raises(rt.InputError, match="'push' moves an rt.System"):
        _ = solution.gains
    assert solution.save(tmp_path / "cart").is_file()
