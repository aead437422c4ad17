"""Inverse and forward dynamics of a robot are one set of equations: the same optimum, the same trajectory."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from tests.programs import nlp_of


def rest(*q: float) -> rt.State:
    return rt.State(q=list(q), v=0)


TASKS = {
    "pendulum": (rest(0), rest(np.pi), 2.5),
    "cartpole": (rest(0, 0), rest(1, np.pi), 2.0),
    "acrobot": (rest(0, 0), rest(np.pi, 0), 3.0),
    "two_link_arm": (rest(0, 0.5), rest(0.5, -0.5), 4.0),
}


@pytest.mark.parametrize(
    "scheme",
    [rt.schemes.Trapezoidal(), rt.HermiteSimpson(), rt.schemes.RadauIIA(points=3)],
    ids=["trapezoid", "Hermite-Simpson", "Radau"],
)
@pytest.mark.parametrize("name", TASKS)
def test_both_forms_have_the_same_optimum(name: str, scheme: rt.HermiteSimpson) -> None:
    start, end, duration = TASKS[name]
    robot = rt.load(name)
    limits = robot.limits.with_(effort=100.0)
    inverse, forward = (
        rt.Phase(robot, duration, start, end, rt.Effort(), limits=limits, dynamics=form)
        for form in (rt.dynamics.InverseDynamics(), rt.dynamics.ForwardDynamics())
    )
    mesh = rt.Mesh(30, scheme)
    first = rt.plan(inverse, mesh)
    # A small barrier stays with the optimum it starts from: the acrobot has many.
    second = rt.plan(forward, mesh, guess=first, solver=rt.Ipopt(initial_barrier=1e-7))
    assert first.objective == pytest.approx(second.objective, rel=1e-7)
    times = np.linspace(0, duration, 50)
    one, other = first.at(times), second.at(times)
    for key in ("q", "v", "a", "tau"):
        size = max(1.0, float(np.max(np.abs(getattr(one, key)))))
        np.testing.assert_allclose(getattr(one, key), getattr(other, key), atol=1e-4 * size)


def test_accelerations_of_the_inverse_form_are_the_rates_of_the_velocities() -> None:
    start, end, duration = TASKS["cartpole"]
    solution = rt.plan(rt.Phase(rt.load("cartpole"), duration, start, end, rt.Effort()), rt.Mesh(10))
    phase = solution.phases[0]
    times = np.linspace(0.01, duration - 0.01, 77)
    np.testing.assert_allclose(phase.trajectory.z(times), phase.at(times).a, atol=1e-8)


def test_rows_of_a_robot_name_joint_unit_and_time() -> None:
    start, end, duration = TASKS["cartpole"]
    tip = rt.GroundClearance("tip", -0.6)
    phase = rt.Phase(rt.load("cartpole"), duration, start, end, rt.Effort(), [tip], name="swing")
    nlp = nlp_of(rt.Problem([phase]), rt.Mesh(2, rt.schemes.Trapezoidal()))
    assert "swing: torque balance, pole, t = 1 s" in nlp.row_names
    assert "swing: defect, q.slider, t = 2 s" in nlp.row_names
    assert "swing: ground clearance, tip, t = 0 s" in nlp.row_names
    assert "swing: effort, slider, t = 1 s" in nlp.variable_names
    assert {entry.unit for entry in nlp.rows.entries if entry.name == "torque balance"} == {"N m", "N"}
