"""Values that are computed once for a robot are cached, and deleted with it."""

from __future__ import annotations

import gc
import weakref

import robotraj as rt
from robotraj.robot.per_robot import PerRobot


def test_a_value_is_made_once_for_a_robot_and_a_key() -> None:
    one, other = rt.load("cartpole"), rt.load("cartpole")
    memory: PerRobot[object] = PerRobot()
    first = memory.get(one, "a", object)
    assert memory.get(one, "a", object) is first
    assert memory.get(one, "b", object) is not first
    assert memory.get(other, "a", object) is not first


def test_keys_without_a_hash_are_not_remembered() -> None:
    robot = rt.load("cartpole")
    memory: PerRobot[object] = PerRobot()
    assert memory.get(robot, [1], object) is not memory.get(robot, [1], object)


def test_values_go_with_their_robot() -> None:
    robot = rt.load("solo12", root="floating")
    phases = [rt.Phase(robot, 1.0, contacts=[rt.PointContact("FL_FOOT")]) for _ in range(2)]
    assert phases[0].bound_contacts[0] is phases[1].bound_contacts[0]
    bound = weakref.ref(phases[0].bound_contacts[0])
    del robot, phases
    gc.collect()
    assert bound() is None
