"""Objectives and guesses of phases with a free design use the design."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt


def reach(robot: rt.Robot, objective: rt.objectives.Objective, **more: object) -> rt.Phase:
    ends = {"start": rt.State(q=0, v=0), "end": rt.State(q=[0.5, 0.5], v=0)}
    return rt.Phase(robot, duration=2.0, objective=objective, **ends, **more)


def designed(objective: rt.objectives.Objective, mass: object) -> rt.Phase:
    arm = rt.load("two_link_arm", limits={"effort": 100.0, "velocity": 100.0})
    return reach(arm, objective, parameters={"m": mass}, design={"m": rt.design.BodyMass("forearm")})


def test_torque_balances_and_their_rates_hold_for_the_designed_mass() -> None:
    objective, mesh = rt.objectives.Jerk() + 1e-3 * rt.objectives.TorqueRate(), rt.Mesh(10, rt.schemes.LobattoIIIA(4))
    solution = rt.plan(designed(objective, 2.5), mesh=mesh)
    assert rt.validate(solution).passed
    part = solution.phases[0]
    robot = part.phase.bound_design.realise(part.parameters)
    assert solution.objective == pytest.approx(rt.plan(reach(robot, objective), mesh=mesh).objective, rel=1e-7)


def test_cost_of_transport_weighs_the_designed_mass() -> None:
    # Effort is 12 m^2 d^2 / T^3, so the ratio is 12 m / g.
    phase = rt.Phase(
        rt.load("block", limits={"effort": 100.0}),
        duration=1.0,
        start=rt.State(q=0, v=0),
        end=rt.State(q=1, v=0),
        objective=rt.objectives.CostOfTransport(work=rt.Effort()),
        parameters={"m": 3.0},
        design={"m": rt.design.BodyMass("block")},
    )
    assert rt.plan(phase, mesh=rt.Mesh(10)).objective == pytest.approx(12.0 * 3.0 / 9.81, rel=1e-6)


@pytest.mark.parametrize(
    "guess", [rt.guess.MinimumJerk(), rt.planning.Kinematic(rt.Mesh(8))], ids=["minimum jerk", "kinematic"]
)
def test_guesses_satisfy_the_dynamics_of_the_guessed_design(guess: rt.guess.MinimumJerk) -> None:
    nlp = rt.transcription.transcribe(rt.Problem([designed(rt.Effort(), rt.between(2.0, 3.0))]), rt.Mesh(8), guess)
    names = np.array([entry.name for entry in nlp.rows.entries])[nlp.rows.meaning]
    assert np.abs(nlp.values(nlp.guess)[names == "torque balance"]).max() < 1e-9
