"""What every gait in space must show: feet that hold, cones, momentum, simulation, and MuJoCo's feet upright."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

GRAVITY = 9.81


def objective(robot: rt.Robot, contact: object, calm: float = 1e-5) -> rt.objectives.Objective:
    """Return the default objective of a gait plus a small weight on the joints' accelerations."""
    posture = rt.gait.gait_objective(robot, rt.gait.stand(robot, contact=contact))  # type: ignore[arg-type]
    return posture + calm * rt.Lagrange(lambda point: ca.sumsqr(point.a[6:]))


def assert_it_is_proved(solution: rt.Solution) -> None:
    """Limits hard, slip and sink under 0.1 mm between the knots, cones held, drift under 1e-2 rad over a step."""
    report = rt.validate(solution)
    report.check(drift=1e-2, contact=1e-4, forces=1e-3, limits=1e-3)
    assert report.holdings
    assert max(max(h.slip.value, h.sink.value) for h in report.holdings) < 1e-5
    assert not any(v.name.endswith("limit") for v in report.violations)


def assert_cones_hold(solution: rt.Solution, friction: float, count: int = 400) -> None:
    """Check |f_t| <= mu f_n at all times, of forces and of impulses."""
    times = np.linspace(0.0, solution.duration, count)
    for force in solution.at(times).forces.values():
        held = force[:, 2] > 0.0
        slack = friction * force[:, 2] - np.linalg.norm(force[:, :2], axis=1)
        assert np.all(force[:, 2] >= -1e-6)
        assert np.min(slack[held], initial=0.0) > -1e-3 * GRAVITY
    for impulse in impulses(solution):
        assert impulse[2] >= -1e-9
        assert np.linalg.norm(impulse[:2]) <= friction * impulse[2] + 1e-6


def impulses(solution: rt.Solution) -> list[np.ndarray]:
    """Impulse (3,) of every contact of every impact."""
    found = []
    for link in solution.impulses:
        names = {name.rsplit(".", 1)[0] for name in link}
        found += [np.array([link[f"{name}.{axis}"] for axis in "xyz"]) for name in sorted(names)]
    return found


def assert_the_ground_carries_the_weight(solution: rt.Solution) -> None:
    """Over a period the vertical momentum returns: forces and impulses together are weight times time."""
    total = sum(impulse[2] for impulse in impulses(solution))
    for phase in solution.phases:
        times = np.linspace(phase.t0, phase.t0 + phase.duration, 2001)[1:-1]
        forces = solution.at(times).forces.values()
        push = sum((force[:, 2] for force in forces), np.zeros(len(times)))
        total += float(np.mean(push)) * phase.duration
    model = solution.phases[0].phase.robot.model  # type: ignore[union-attr]
    weight = pin.computeTotalMass(model) * GRAVITY
    assert total == pytest.approx(weight * solution.duration, rel=2e-3)


def assert_it_repeats_mirrored(solution: rt.Solution, sides: Mapping[str, str]) -> None:
    """Joints at the start are those of the other side at the end; hips about x have the other sign."""
    robot = solution.phases[0].phase.robot
    assert robot is not None
    start, end = solution.at(0.0).q, solution.at(solution.duration).q
    at = {name: i for i, name in enumerate(robot.position_names)}
    for left, right in sides.items():
        for joint, sign in (("HAA", -1.0), ("HFE", 1.0), ("KFE", 1.0)):
            a, b = at[f"{left}_{joint}"], at[f"{right}_{joint}"]
            assert start[a] == pytest.approx(sign * end[b], abs=1e-7)
            assert start[b] == pytest.approx(sign * end[a], abs=1e-7)


def apex(solution: rt.Solution, frame: str) -> float:
    """Greatest height of a frame over the motion [m]."""
    robot = solution.phases[0].phase.robot
    assert robot is not None
    data, index = robot.model.createData(), robot.frame(frame)
    heights = []
    for q in solution.at(np.linspace(0.0, solution.duration, 101)).q:
        pin.framesForwardKinematics(robot.model, data, q)
        heights.append(data.oMf[index].translation[2])
    return float(np.max(heights))
