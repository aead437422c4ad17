"""Hands on a vertical wall and on a rail, of a quadruped and a humanoid: planned, proved, and balanced by Pinocchio."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

WALL = rt.terrain.Plane((0.55, 0, 0), outward=(-1, 0, 0))
RAIL = (0.35, 0.4, 1.0)
HAND = "wrist_left_ft_tool_link"
SOLE = partial(rt.FlatFoot, length=0.2, width=0.12, friction=0.7)


def place(robot: rt.Robot, frame: str, q: np.ndarray) -> np.ndarray:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return np.array(data.oMf[robot.frame(frame)].translation)


def check_momentum(solution: rt.Solution, phase: int, contacts: Sequence[str]) -> None:
    """The contact forces and the weight are the rate of the linear momentum, at every collocation point."""
    part = solution.phases[phase]
    robot = part.phase.robot
    assert robot is not None
    data = robot.model.createData()
    for t in part.points[1:-1:3]:
        at = part.at(float(t))
        rate = pin.computeCentroidalMomentumTimeVariation(robot.model, data, at.q, at.v, at.a).linear
        force = sum(np.asarray(at.forces[name])[:3] for name in contacts) + robot.mass * np.array([0.0, 0.0, -9.81])
        np.testing.assert_allclose(force, rate, atol=1e-3 * robot.mass * 9.81)


@pytest.mark.slow
def test_a_quadruped_leans_with_a_front_foot_on_a_wall() -> None:
    robot = rt.load("go2", root="floating")
    first, *rest = (rt.PointContact(foot) for foot in rt.gait.feet_of(robot, None))
    hand = rt.PointContact(first.frame, ground=WALL, friction=0.5, normal_force=(30.0, np.inf), name="hand")
    q = np.array(rt.gait.stand(robot))
    cost = rt.gait.posture_objective(robot, q)
    phases = [
        rt.Phase(robot, 0.4, rt.State(q=q, v=0), contacts=[first, *rest], objective=cost, name="shift"),
        rt.Phase(robot, 0.5, contacts=rest, objective=cost, name="reach"),
        rt.Phase(robot, 0.5, end=rt.State(v=0), contacts=[*rest, hand], objective=cost, name="lean"),
    ]
    solution = rt.plan(rt.Problem(phases, [rt.links.Liftoff(0, 1), rt.Continuity(1, 2)]), progress=False)
    assert solution.proof is not None and solution.proof.holds
    lean = solution.phases[2]
    for t in np.linspace(lean.t0, lean.t0 + lean.duration, 9):
        at = lean.at(float(t))
        assert place(robot, first.frame, at.q)[0] == pytest.approx(0.55, abs=1e-4)
        x, y, z = at.forces["hand"]
        assert x < -29.9 and np.hypot(y, z) < 0.5 * -x * 1.002
    check_momentum(solution, 2, [*(contact.label for contact in rest), "hand"])


@pytest.mark.slow
def test_a_humanoid_leans_back_on_a_rail_with_its_mass_behind_its_heels() -> None:
    """No force of the soles holds a mass there at rest; the hand pulls, since it grips."""
    robot = rt.load("talos", root="floating")
    feet = [SOLE(foot) for foot in rt.gait.feet_of(robot, None)]
    q = np.array(rt.gait.stand(robot, contact=SOLE))
    heel = place(robot, feet[0].frame, q)[0] - 0.1
    cost = rt.gait.posture_objective(robot, q)
    at_rail = rt.AtEnd(rt.constraints.FramePosition(HAND, RAIL))
    back = rt.AtEnd(rt.PathConstraint(lambda point: point.com[0], upper=heel - 0.02, name="mass", unit="m"))
    grip = rt.contacts.LoopClosure(HAND, "universe", name="grip", offset_b=RAIL)
    ends = rt.State(q=q, v=0), rt.State(v=0)
    phases = [
        rt.Phase(robot, 0.8, *ends, contacts=feet, objective=cost, constraints=[at_rail], name="reach"),
        rt.Phase(robot, 0.8, end=ends[1], contacts=[*feet, grip], objective=cost, constraints=[back], name="lean"),
    ]
    solution = rt.plan(rt.Problem(phases, [rt.Continuity(0, 1)]), progress=False)
    assert solution.proof is not None and solution.proof.holds
    lean = solution.phases[1]
    for t in np.linspace(lean.t0, lean.t0 + lean.duration, 9):
        np.testing.assert_allclose(place(robot, HAND, lean.at(float(t)).q), RAIL, atol=1e-4)
    end = solution.at(solution.duration)
    assert pin.centerOfMass(robot.model, robot.model.createData(), end.q)[0] < heel - 0.019
    assert end.forces["grip"][0] > 0.1 * robot.mass * 9.81
    check_momentum(solution, 1, [*(foot.label for foot in feet), "grip"])
