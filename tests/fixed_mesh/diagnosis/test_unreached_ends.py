"""Ends that no configuration satisfies are named, with the nearest value; ends that exist are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.fixed_mesh.diagnosis.unreached_ends import unreached_ends

HOME = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0])


@pytest.fixture(scope="module")
def ur5() -> rt.Robot:
    return rt.load("ur5")


def to_place(robot: rt.Robot, place: list[float], **more: object) -> rt.Problem:
    rows = [rt.AtEnd(rt.FramePosition("tool0", place)), *more.pop("constraints", [])]  # type: ignore[misc]
    return rt.Problem([rt.Phase(robot, 2.0, rt.State(q=HOME, v=0), rt.State(v=0), constraints=rows, **more)])


@pytest.mark.parametrize("seed", range(5))
def test_places_of_configurations_within_the_limits_are_reached(ur5: rt.Robot, seed: int) -> None:
    q = HOME + np.random.default_rng(seed).uniform(-1.5, 1.5, 6)
    data = ur5.model.createData()
    pin.framesForwardKinematics(ur5.model, data, np.clip(q, -3, 3))
    assert not unreached_ends(to_place(ur5, data.oMf[ur5.frame("tool0")].translation.tolist()))


def test_the_nearest_place_of_an_arm_lies_on_the_line_to_the_target() -> None:
    """Two links of lengths a and b reach a + b from the shoulder."""
    arm = rt.load("two_link_arm")
    data = arm.model.createData()
    pin.framesForwardKinematics(arm.model, data, np.zeros(2))
    length = float(np.linalg.norm(data.oMf[arm.frame("tip")].translation - data.oMi[1].translation))
    start = data.oMi[1].translation + 2.0 * (data.oMf[arm.frame("tip")].translation - data.oMi[1].translation)
    target = rt.AtEnd(rt.FramePosition("tip", start))
    phase = rt.Phase(arm, 2.0, rt.State(q=0, v=0), rt.State(v=0), constraints=[target])
    found = unreached_ends(rt.Problem([phase]))
    assert {conflict.name.split(",")[0] for conflict in found} <= {
        "frame position x",
        "frame position y",
        "frame position z",
    }
    assert found[0].certain and abs(found[0].bound - found[0].needed) == pytest.approx(length, rel=1e-2)


def test_a_clearance_conflicts_with_the_place_below_it(ur5: rt.Robot) -> None:
    above = rt.GroundClearance("tool0", 0.25)
    (found,) = unreached_ends(to_place(ur5, [0.5, 0.2, 0.1], constraints=[above]))
    assert found.name == "ground clearance, tool0" and "frame position z" in found.reason
    assert found.needed == pytest.approx(0.1, abs=1e-3)


def there_and_back(place: float) -> rt.Problem:
    """Return two steps of a foot, whose first foothold is moved to a place [m]."""
    robot = rt.load("five_link", root="planar")
    problem = rt.gait.steps(robot, [{"left_foot": (0.2,)}, {"left_foot": (0.0,)}], feet=("left_foot", "right_foot"))
    phases = [
        phase.with_(parameters={**phase.parameters, "left_foot.x": place}) if phase.name == "support 1" else phase
        for phase in problem.phases
    ]
    return replace(problem, phases=phases)


def test_a_foothold_out_of_reach_is_named_phases_before_the_end() -> None:
    found = unreached_ends(there_and_back(2.5))
    assert found and any("left_foot" in conflict.name for conflict in found)
    assert not unreached_ends(there_and_back(0.2))


def test_a_failed_plan_names_such_an_end() -> None:
    solution = rt.plan(there_and_back(2.5), check=False)
    assert not solution.success
    assert "left_foot" in solution.cause


def test_mirrored_knees_contradict_their_limits() -> None:
    robot = rt.load("five_link", root="planar")
    problem = rt.gait.walk(robot, step_length=0.5, duration=0.7)
    limits = robot.limits.with_(position={"left_knee": (0.6, 0.9), "right_knee": (0.1, 0.3)})
    found = unreached_ends(rt.Problem([phase.with_(limits=limits) for phase in problem.phases], problem.links))
    assert "knee" in found[0].name and "Touchdown" in found[0].reason
    assert not unreached_ends(problem)
