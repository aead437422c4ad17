"""Curves of the caller: expressions of a point and measured values, beside the planned ones."""

from pathlib import Path

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.replay_page.charts.curves import curves
from robotraj.replay_page.charts.own_curves import OwnCurves
from robotraj.solution.cycles.gait_cycles import GaitCycles, gait_cycles


@pytest.fixture(scope="module")
def reach() -> rt.Solution:
    ur5 = rt.load("ur5")
    start, end = rt.State(q=[0, -1.3, 1.6, -1.9, -1.57, 0], v=0), rt.State(q=[0.5, -1.3, 1.6, -1.9, -1.57, 0], v=0)
    return rt.plan(rt.Phase(ur5, 1.0, start, end, rt.Effort(), self_collision=False), mesh=rt.Mesh(6))


@pytest.fixture(scope="module")
def cycles(reach: rt.Solution) -> GaitCycles:
    return gait_cycles(reach, 1)


def test_an_expression_of_a_point_is_that_of_pinocchio(reach: rt.Solution) -> None:
    times = np.linspace(0, 1, 7)
    found = reach.phases[0].values(lambda point: point.frame("tool0").velocity[:3], times)
    robot = reach.phases[0].phase.robot
    assert robot is not None
    data, sample = robot.model.createData(), reach.at(times)
    for k in range(len(times)):
        pin.forwardKinematics(robot.model, data, sample.q[k], sample.v[k])
        frame = robot.frame("tool0")
        expected = pin.getFrameVelocity(robot.model, data, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED).linear
        assert found[k] == pytest.approx(expected, abs=1e-9)


def test_own_charts_come_last_with_unit_and_components(cycles: GaitCycles) -> None:
    own = {
        "tool speed [m/s]": lambda point: ca.norm_2(point.frame("tool0").velocity[:3]),
        "tool [m]": lambda point: point.frame("tool0").position,
    }
    *joints, speed, place = curves(cycles, OwnCurves.of(own, None))
    assert len(joints) == 3 and (speed["title"], place["title"]) == ("tool speed", "tool")
    assert [(s["label"], s["unit"]) for s in speed["series"]] == [("tool speed", "m/s")]
    assert [s["label"] for s in place["series"]] == ["tool x", "tool y", "tool z"]
    (piece,) = speed["pieces"]
    assert len(piece["y"][0]) == len(piece["t"]) and max(piece["y"][0]) > 0.3  # type: ignore[arg-type, index]


def test_measured_values_are_drawn_beside_their_variable(cycles: GaitCycles) -> None:
    own = OwnCurves.of(None, {"v.elbow_joint": ([0.25, 0.75], [1.0, 3.0])})
    positions, velocities, _ = curves(cycles, own)
    assert len(positions["series"]) == 6
    assert velocities["series"][-1]["label"] == "elbow_joint, measured"
    (piece,) = velocities["pieces"]
    known = {t: y for t, y in zip(piece["t"], piece["y"][-1], strict=True) if y is not None}  # type: ignore[arg-type, index, call-overload]
    assert min(known) >= 0.25 and max(known) <= 0.75
    assert all(y == pytest.approx(1.0 + 4.0 * (t - 0.25), abs=1e-5) for t, y in known.items())


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"curves": {"speed": 3.0}}, "takes a function of a point"),
        ({"curves": ["speed"]}, "curves= is a dict"),
        ({"curves": {"speed": lambda point: point.speed}}, "{'speed': ...}.*'RobotPoint' object has no attribute"),
        ({"measured": {"q.elbow": ([0, 1], [0, 1])}}, "no curve named 'q.elbow'. Did you mean 'q.elbow_joint'"),
        ({"measured": {"q.elbow_joint": ([0, 1], [0, 1, 2])}}, "as many values"),
        ({"measured": {"q.elbow_joint": 3}}, r"takes \(times, values\)"),
    ],
)
def test_what_is_no_curve_is_refused(reach: rt.Solution, tmp_path: Path, options: dict, text: str) -> None:
    with pytest.raises(rt.InputError, match=text):
        rt.replay(reach, tmp_path / "page.html", **options)
