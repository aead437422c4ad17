"""Tasks packed for workers: robots that several tasks share are sent once, and are one robot there.

What is derived from a robot, such as its functions, is then built once in a worker, not once a task.
"""

from __future__ import annotations

import io
import pickle
from collections.abc import Sequence

import cloudpickle

from robotraj.robot.robot import Robot


class TaskPacker:
    """Packs tasks of one call.

    Attributes
    ----------
    robots : list of Robot
        Robots of the tasks so far, to be sent with the shared data.
    """

    def __init__(self) -> None:
        self.robots: list[Robot] = []
        self._numbers: dict[int, int] = {}

    def pack(self, task: object) -> bytes:
        """Return a task as bytes, with numbers in place of its robots."""
        stream = io.BytesIO()
        _TaskPickler(stream, self).dump(task)
        return stream.getvalue()

    def number(self, robot: Robot) -> int:
        """Return the number of a robot, the same for the same object."""
        if id(robot) not in self._numbers:
            self._numbers[id(robot)] = len(self.robots)
            self.robots.append(robot)
        return self._numbers[id(robot)]


class _TaskPickler(cloudpickle.Pickler):
    def __init__(self, stream: io.BytesIO, packer: TaskPacker) -> None:
        super().__init__(stream)
        self._packer = packer

    def persistent_id(self, value: object) -> int | None:
        return self._packer.number(value) if isinstance(value, Robot) else None


class _TaskUnpickler(pickle.Unpickler):
    def __init__(self, data: bytes, robots: Sequence[Robot]) -> None:
        super().__init__(io.BytesIO(data))
        self._robots = robots

    def persistent_load(self, number: int) -> Robot:
        return self._robots[number]


def unpack(data: bytes, robots: Sequence[Robot]) -> object:
    """Return a task that ``TaskPacker.pack`` packed."""
    return _TaskUnpickler(data, robots).load()
