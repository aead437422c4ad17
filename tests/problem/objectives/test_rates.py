"""Torque rate and jerk: closed forms, and jerks against Pinocchio's own accelerations."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.errors import InputError, UnknownName

MESH = rt.Mesh(40, rt.schemes.LobattoIIIA(4))


def rest_to_rest(
    robot: rt.Robot, q: list[float], duration: float, objective: rt.objectives.Objective, **more: object
) -> rt.Phase:
    return rt.Phase(
        robot,
        duration=duration,
        start=rt.State(q=0, v=0),
        end=rt.State(q=q, v=0),
        objective=objective,
        limits=None,
        **more,
    )


@pytest.mark.parametrize("duration", [1.0, 2.0])
def test_least_torque_rate_of_a_block_is_that_of_free_end_torques(duration: float) -> None:
    # x' = v, v' = u, min of the integral of u'^2: u = 5 d / T^2 (1 - 6 s^2 + 4 s^3), cost 120 d^2 / T^5.
    solution = rt.plan(rest_to_rest(rt.load("block"), [1.0], duration, rt.objectives.TorqueRate()), mesh=MESH)
    assert solution.objective == pytest.approx(120.0 / duration**5, rel=1e-8)
    s = np.linspace(0.0, 1.0, 50)
    expected = 5.0 / duration**2 * (1.0 - 6.0 * s**2 + 4.0 * s**3)
    np.testing.assert_allclose(solution.at(s * duration).tau[:, 0], expected, atol=1e-6)


@pytest.mark.parametrize(
    "form", [rt.dynamics.InverseDynamics(), rt.dynamics.ForwardDynamics()], ids=["inverse", "forward"]
)
def test_least_jerk_of_an_arm_is_kinematic(form: rt.dynamics.InverseDynamics) -> None:
    # Torques that are free make the jerk the joints' own: 120 |d|^2 / T^5, whatever the masses.
    phase = rest_to_rest(rt.load("two_link_arm"), [0.5, -0.7], 2.0, rt.objectives.Jerk(), dynamics=form)
    solution = rt.plan(phase, mesh=rt.Mesh(20, rt.schemes.LobattoIIIA(4)))
    assert solution.objective == pytest.approx(120.0 * (0.5**2 + 0.7**2) / 2.0**5, rel=1e-6)
    assert rt.validate(solution).passed


def test_jerks_of_an_underactuated_robot_are_the_rates_of_pinocchios_accelerations() -> None:
    robot = rt.load("cartpole")
    phase = rest_to_rest(robot, [0.3, 0.0], 2.0, rt.objectives.Jerk() + rt.objectives.TorqueRate())
    solution = rt.plan(phase, mesh=rt.Mesh(30, rt.schemes.LobattoIIIA(4)))
    part = solution.phases[0]
    data = robot.model.createData()

    def acceleration(t: float, k: int) -> np.ndarray:
        sample = part.at(t, interval=k)
        return pin.aba(robot.model, data, sample.q, sample.v, robot.actuation @ sample.tau)

    step = 1e-5
    for k in (3, 14, 27):
        middle = 0.5 * (part.knots[k] + part.knots[k + 1])
        nodes = part.knots[k] + (part.knots[k + 1] - part.knots[k]) * part.mesh.schemes[k].nodes
        node = nodes[np.argmin(np.abs(nodes - middle))]
        rate = (acceleration(node + step, k) - acceleration(node - step, k)) / (2 * step)
        sample = part.at(node, interval=k)
        planned = [sample.z[f"jerk.{joint}"] for joint in robot.joint_names]
        np.testing.assert_allclose(planned, rate, rtol=1e-4, atol=1e-4)


def test_torques_are_continuous_and_their_limits_hold_at_collocation_points() -> None:
    robot = rt.load("block", limits={"effort": 4.5})
    phase = rt.Phase(
        robot, duration=1.0, start=rt.State(q=0, v=0), end=rt.State(q=1, v=0), objective=rt.objectives.TorqueRate()
    )
    solution = rt.plan(phase, mesh=rt.Mesh(20, rt.schemes.RadauIIA(3)))
    part = solution.phases[0]
    before, after = (np.array([part.at(t, interval=k + i).tau for k, t in enumerate(part.knots[1:-1])]) for i in (0, 1))
    np.testing.assert_allclose(before, after, atol=1e-8)
    assert np.abs(solution.at(np.linspace(0, 1, 201)).tau).max() <= 4.5 + 1e-3
    report = rt.validate(solution)
    assert report.passed, str(report)


def test_terms_that_need_the_same_variables_share_them() -> None:
    arm = rt.load("two_link_arm")
    objective = (
        rt.objectives.TorqueRate()
        + rt.objectives.Jerk()
        + rt.objectives.TorqueRate()
        + rt.objectives.AbsolutePower()
        + rt.objectives.MechanicalWork()
    )
    phase = rest_to_rest(arm, [0.5, 0.5], 5.0, objective)
    names = [[v.name for v in group] for group in (phase.dae.states, phase.dae.algebraic, phase.dae.controls)]
    assert names[0][4:] == ["tau.shoulder", "tau.elbow", "acceleration.shoulder", "acceleration.elbow"]
    assert names[1] == ["a.shoulder", "a.elbow"]
    rates = ["rate.tau.shoulder", "rate.tau.elbow", "jerk.shoulder", "jerk.elbow"]
    assert names[2] == [*rates, "slack.tau.shoulder", "slack.tau.elbow"]
    assert rt.plan(phase, mesh=rt.Mesh(15)).success


def test_a_system_plans_with_control_rates() -> None:
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    phase = rt.Phase(
        system, duration=1.0, start=rt.State([0, 0]), end=rt.State([1, 0]), objective=rt.objectives.TorqueRate()
    )
    solution = rt.plan(phase, mesh=MESH)
    assert solution.objective == pytest.approx(120.0, rel=1e-8)
    assert rt.validate(solution).passed


def test_a_solution_without_rates_starts_one_with_rates() -> None:
    arm = rt.load("two_link_arm")
    first = rt.plan(rest_to_rest(arm, [0.5, 0.5], 2.0, rt.Effort()))
    second = rt.transcription.transcribe(
        rt.Problem([rest_to_rest(arm, [0.5, 0.5], 2.0, rt.objectives.TorqueRate())]),
        rt.Mesh(10),
        rt.guess.FromSolution(first),
    )
    entries = second.variables.entries
    torque = np.array([entries[m].name == "effort" and entries[m].label == "elbow" for m in second.variables.meaning])
    times = second.times(second.variables, second.guess)[torque]
    np.testing.assert_allclose(second.guess[torque], first.at(times).tau[:, 1], atol=1e-9)


def test_rates_refuse_what_has_none() -> None:
    still = rt.System(["x"], [], lambda point: [point.x["x"]])
    with pytest.raises(InputError, match="controls"):
        rt.Phase(still, duration=1.0, objective=rt.objectives.TorqueRate())
    with pytest.raises(InputError, match="Jerk needs a robot"):
        rt.Phase(still, duration=1.0, objective=rt.objectives.Jerk())
    with pytest.raises(UnknownName, match="elbo"):
        rt.Phase(rt.load("two_link_arm"), duration=1.0, objective=rt.objectives.Jerk({"elbo": 1.0}))
