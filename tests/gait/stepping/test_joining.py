"""From rest into a walk and back: the ends are states of the walk, so that the motions join."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

FOOT = partial(rt.PointContact, friction=0.8)
MESH = rt.Mesh(6, rt.schemes.LobattoIIIA(4))


@pytest.fixture(scope="module")
def walk(biped: rt.Robot) -> rt.Solution:
    return rt.plan(rt.gait.walk(biped, step_length=0.4, duration=0.6, contact=FOOT, clearance=0.02), MESH)


def feet_at(solution: rt.Solution, t: float) -> dict[str, float]:
    """World x of both feet [m]."""
    robot = solution.phases[0].phase.robot
    assert robot is not None
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, solution.at(t).q)
    return {name: float(data.oMf[robot.frame(name)].translation[0]) for name in ("left_foot", "right_foot")}


def test_a_biped_starts_from_rest_into_its_walk(walk: rt.Solution) -> None:
    start = rt.plan(rt.gait.start(walk, count=2), MESH)
    np.testing.assert_allclose(start.at(0.0).v, 0.0, atol=1e-8)
    np.testing.assert_allclose(start.at(start.duration).q, walk.at(0.0).q, atol=1e-6)
    # The impact of the walk's own link leads from the last state to the walk's first one.
    before, mirrored = start.at(start.duration).v, walk.at(walk.duration).v
    np.testing.assert_allclose(np.sort(np.abs(before)), np.sort(np.abs(mirrored)), atol=1e-6)
    feet = [{contact.frame for contact in phase.bound_contacts} for phase in start.problem.phases]
    assert feet[0] == {"left_foot", "right_foot"} and feet[1] == {"left_foot"} and feet[2] == {"right_foot"}


def test_a_biped_stops_from_its_walk(walk: rt.Solution) -> None:
    stop = rt.plan(rt.gait.stop(walk, count=2), MESH)
    np.testing.assert_allclose(stop.at(0.0).q, walk.at(0.0).q, atol=1e-6)
    np.testing.assert_allclose(stop.at(0.0).v, walk.at(0.0).v, atol=1e-6)
    np.testing.assert_allclose(stop.at(stop.duration).v, 0.0, atol=1e-8)
    # The last step places the swing foot beside the other one, half a step ahead.
    bearing, swinging = (feet_at(walk, 0.0)[name] for name in ("left_foot", "right_foot"))
    assert bearing - swinging == pytest.approx(0.4, abs=1e-6)
    assert list(feet_at(stop, stop.duration).values()) == pytest.approx([bearing + 0.4] * 2, abs=1e-6)


def test_a_single_period_leaves_its_standing_foot_where_the_walk_has_it(walk: rt.Solution) -> None:
    start = rt.plan(rt.gait.start(walk, count=1), MESH)
    np.testing.assert_allclose(start.at(0.0).v, 0.0, atol=1e-8)
    np.testing.assert_allclose(start.at(start.duration).q, walk.at(0.0).q, atol=1e-6)
    standing = feet_at(walk, 0.0)["right_foot"]
    for t in (0.0, start.phases[0].duration, start.duration):
        assert feet_at(start, t)["right_foot"] == pytest.approx(standing, abs=1e-6)


def test_a_single_period_ends_with_point_feet_on_both_sides_of_the_capture_point(walk: rt.Solution) -> None:
    robot = walk.phases[0].phase.robot
    assert robot is not None
    landing = walk.at(walk.duration)
    data = robot.model.createData()
    pin.centerOfMass(robot.model, data, landing.q, landing.v)
    standing = feet_at(walk, 0.0)["left_foot"]
    ahead = data.com[0][0] + data.vcom[0][0] * np.sqrt(data.com[0][2] / 9.81) - standing
    stop = rt.plan(rt.gait.stop(walk, count=1), MESH)
    feet = feet_at(stop, stop.duration)
    assert feet["left_foot"] == pytest.approx(standing, abs=1e-6)
    assert feet["right_foot"] - standing == pytest.approx(1.25 * ahead, rel=1e-5)


def test_durations_at_rest_grow_with_the_root_of_the_height(walk: rt.Solution, solo: rt.Robot) -> None:
    biped = walk.phases[0].phase.robot
    assert biped is not None
    for robot, problem in (
        (biped, rt.gait.start(walk)),
        (solo, rt.gait.start_stop(solo, step_length=0.05)),
    ):
        height = pin.centerOfMass(robot.model, robot.model.createData(), rt.gait.stand(robot))[2]
        assert problem.phases[0].duration == pytest.approx(1.4 * np.sqrt(height / 9.81), rel=0.05)


def test_what_does_not_repeat_is_refused(walk: rt.Solution, biped: rt.Robot) -> None:
    with pytest.raises(rt.InputError, match="needs the solution of a gait"):
        rt.gait.start(rt.gait.walk(biped, step_length=0.4, duration=0.6))  # type: ignore[arg-type]
    once = SimpleNamespace(problem=rt.Problem(walk.problem.phases, []), phases=walk.phases, duration=1.0, at=walk.at)
    with pytest.raises(rt.InputError, match="does not repeat"):
        rt.gait.start(once)
    with pytest.raises(rt.InputError, match="at least 1 period"):
        rt.gait.stop(walk, count=0)
    with pytest.raises(rt.InputError, match="positive duration"):
        rt.gait.stop(walk, shift=0.0)


def test_feet_of_a_walker_without_knees_pass_through_the_ground_as_in_its_gait(walk: rt.Solution) -> None:
    walker = rt.load("compass_walker", root="planar")
    passing = rt.plan(rt.gait.walk(walker, step_length=0.15, duration=0.5, clearance=None), rt.Mesh(4), progress=False)

    def clears(problem: rt.Problem) -> bool:
        rows = [row for phase in problem.phases for row in phase.constraints if isinstance(row, rt.GroundClearance)]
        return any(row.height is not None for row in rows)

    for join in (rt.gait.start, rt.gait.stop):
        assert not clears(join(passing)) and clears(join(walk))
