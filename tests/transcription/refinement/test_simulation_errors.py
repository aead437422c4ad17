"""Errors over short windows, and of speeds inside intervals, bound those of the simulations in ``rt.validate``."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.curves.polynomials import gauss
from robotraj.transcription.refinement.assess import errors_of
from robotraj.transcription.refinement.error import Residuals, residuals_of, sizes_of
from robotraj.transcription.refinement.linear_controls import LINES
from robotraj.transcription.refinement.simulation_errors import SHARE, speed_deviations, window_errors


def light_link(width: float = 0.05) -> rt.Phase:
    """Return a turn of a light link, whose torque begins above the dry friction and changes as little as possible."""
    model, place = pin.Model(), pin.SE3.Identity()
    joint = model.addJoint(0, pin.JointModelRZ(), place, "joint")
    model.appendBodyToJoint(joint, pin.Inertia(0.1, np.zeros(3), 1e-4 * np.eye(3)), place)
    model.damping = np.array([0.1])
    robot = replace(rt.load(model), friction=np.array([0.2]), friction_speed=width)
    ends = rt.State(q=0.0, v=0.0), rt.State(q=0.5, v=0.0)
    return rt.Phase(robot, 0.5, *ends, rt.objectives.TorqueRate())


def test_errors_over_windows_bound_those_of_the_simulation_where_short_intervals_follow_each_other() -> None:
    # Torques that are lines are wrong to one side where the motion bends, and the errors of intervals add up.
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[2.0, 1.0], v=0)
    swing = rt.Phase(rt.load("two_link_arm"), 0.2, *ends, rt.Effort(), limits=None)
    solution = rt.plan(swing, mesh=rt.Mesh(60, LINES), check=False)
    part = solution.phases[0]
    alone = errors_of(part.phase, part.trajectory, part.mesh)
    windows = errors_of(part.phase, part.trajectory, part.mesh, whole=part.duration)
    local = rt.validate(solution).local.worst.relative
    assert np.all(windows >= alone)
    assert local < 2.0 * windows.max() / SHARE


def test_a_light_joint_deviates_inside_an_interval_as_a_simulation_that_follows_the_plan_shows() -> None:
    # The link reaches its speed within a fraction of the first interval.
    solution = rt.plan(light_link(), mesh=rt.Mesh(200), check=False)
    part = solution.phases[0]
    residuals = residuals_of(part.phase, part.trajectory)
    deviations = speed_deviations(residuals, sizes_of(part.phase, [part.trajectory]), slice(1, 2))
    loop = rt.validate(solution).closed_loop
    assert loop is not None and loop.error is not None
    followed = loop.error["v.joint"]
    assert followed.time < solution.phases[0].knots[1]
    # The scale of a speed that follows is 10 times its largest value.
    assert 0.5 < deviations[0] / (10.0 * followed.relative) < 2.0
    assert deviations[0] > 50.0 * deviations[1:].max()


@pytest.mark.parametrize("width", [0.05, 0.005])
def test_the_default_plan_resolves_the_speed_of_a_light_joint(width: float) -> None:
    """With the narrower friction, a step to less soft friction fails, and is taken in two."""
    solution = rt.plan(light_link(width))
    assert solution.success
    assert rt.validate(solution).passed


def test_errors_that_cancel_over_a_long_interval_count_inside_of_it() -> None:
    # e = sin(2 pi t / 0.2) over one interval: zero in all, 0.1 / pi over its first half.
    tau, weights = gauss(20)
    times, breaks = 0.1 * (tau + 1.0), np.array([0.0, 0.2])
    values = np.sin(2.0 * np.pi * times / 0.2)[:, None]
    residuals = Residuals(np.zeros(20, dtype=int), 0.1 * weights, values, None)

    def still(t: np.ndarray, interval: np.ndarray) -> np.ndarray:
        return np.zeros((len(t), 1))

    still.breaks = breaks  # type: ignore[attr-defined]
    trajectory = SimpleNamespace(x=still)
    assert window_errors(trajectory, residuals, 0.2, np.ones(1))[0] == pytest.approx(0.0, abs=1e-12)
    assert window_errors(trajectory, residuals, 0.1, np.ones(1))[0] == pytest.approx(0.2 / np.pi)


def test_errors_of_stances_count_over_windows_too() -> None:
    robot = rt.load("five_link", root="planar")
    contacts = [rt.PointContact(name) for name in rt.gait.feet_of(robot, None)]
    low, high = rt.gait.stand(robot, height=0.6), rt.gait.stand(robot)
    ends = rt.State(q=low, v=0), rt.State(q=high, v=0)
    rise = rt.Phase(robot, 0.5, *ends, rt.gait.posture_objective(robot, high), contacts=contacts)
    solution = rt.plan(rise, mesh=rt.Mesh(5), check=False)
    part = solution.phases[0]
    windows = errors_of(part.phase, part.trajectory, part.mesh, whole=part.duration)
    assert rt.validate(solution).local.worst.relative < 2.0 * windows.max() / SHARE


def test_a_boundary_layer_of_a_system_is_resolved_as_a_simulation_shows_it() -> None:
    """Troesch's problem y'' = 10 sinh(10 y), y(0) = 0, y(1) = 1: the last thousandth of the time has half the change.

    Its errors were small beside its rates of 1e5, and the proved plan failed its validation.
    Its first integral v^2 = v(0)^2 + 2 (cosh(10 y) - 1) and a quadrature of dy / v = dt give v(0).
    """
    system = rt.System(["y", "v"], [], lambda point: [point.x["v"], 10.0 * ca.sinh(10.0 * point.x["y"])])
    objective = rt.Mayer(lambda start, end: start.x["v"])
    solution = rt.plan(rt.Phase(system, 1.0, rt.State({"y": 0}), rt.State({"y": 1}), objective))
    assert rt.validate(solution).passed
    assert abs(solution.objective - 3.58337783e-4) < 1e-7
