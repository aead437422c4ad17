"""The first motion of a robot starts at its home posture, and its links stay above the base."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.applications.problem_files.starter import starter
from tests.robots.many_legs import FOUR, SIX, legged


def heights(robot: rt.robot.Robot, q: np.ndarray) -> list[float]:
    """Heights of the frames that joints move [m]."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return [data.oMf[i].translation[2] for i, frame in enumerate(robot.model.frames) if frame.parentJoint > 0]


@pytest.mark.parametrize("name", ["ur5", "ur10", "panda", "kinova", "xarm7"])
def test_the_first_motion_of_an_arm_begins_and_ends_above_its_base(name: str, tmp_path: Path) -> None:
    robot = rt.load(name)
    file = tmp_path / "problem.toml"
    file.write_text(starter(robot, name))
    (phase,) = rt.load_problem(file).problem.phases
    (low, _), (last, _) = phase.start_bounds, phase.end_bounds
    for q in (low[: robot.nq], last[: robot.nq]):
        assert min(heights(robot, q)) >= 0.0
    if min(heights(robot, robot.neutral)) >= 0.0:
        np.testing.assert_allclose(low[: robot.nq], robot.neutral, atol=1e-9)


def test_the_stretched_ur5_of_the_urdf_is_lifted() -> None:
    robot = rt.load("ur5")
    assert min(heights(robot, robot.neutral)) < 0.0
    assert "shoulder_lift_joint = -0.6" in starter(robot, "ur5")


@pytest.mark.filterwarnings("ignore:.*Implausible effort limit")
@pytest.mark.parametrize(("legs", "gait"), [(FOUR, "trot"), (SIX, "walk")])
def test_four_legs_trot_and_six_walk(legs: dict[str, tuple[float, float]], gait: str, tmp_path: Path) -> None:
    robot = legged(tmp_path, legs)
    (tmp_path / "problem.toml").write_text(starter(robot, str(tmp_path / "legged.urdf")))
    assert f'type = "{gait}"' in (tmp_path / "problem.toml").read_text()
    problem = rt.load_problem(tmp_path / "problem.toml").problem
    assert len(problem.phases[0].contacts) == len(legs) // 2
