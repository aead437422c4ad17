"""Robots that tasks share are sent once, and tasks are one robot's again where they arrive."""

from __future__ import annotations

import cloudpickle

import robotraj as rt
from robotraj.applications.many.task_messages import TaskPacker, unpack


def test_tasks_share_their_robot_on_both_sides_and_are_small() -> None:
    arm, other = rt.load("two_link_arm"), rt.load("pendulum")
    moves = [rt.Phase(arm, 1.0, rt.State(q=0, v=0), rt.State(q=a, v=0), rt.Effort()) for a in (0.1, 0.2)]
    moves.append(rt.Phase(other, 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort()))
    packer = TaskPacker()
    packed = [packer.pack(rt.Problem([move])) for move in moves]
    assert packer.robots == [arm, other]
    assert max(map(len, packed)) < 0.5 * len(cloudpickle.dumps(rt.Problem([moves[0]])))
    robots = cloudpickle.loads(cloudpickle.dumps(packer.robots))
    found = [unpack(data, robots) for data in packed]
    assert found[0].phases[0].robot is found[1].phases[0].robot is robots[0]  # type: ignore[attr-defined]
    assert [str(problem) for problem in found] == [str(rt.Problem([move])) for move in moves]
