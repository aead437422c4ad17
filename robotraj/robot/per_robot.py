"""A cache of values by robot."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar
from weakref import WeakKeyDictionary

from robotraj.robot.robot import Robot

Value = TypeVar("Value")


class PerRobot(Generic[Value]):
    """Caches values by robot and key for the lifetime of the robot; no value may refer to its robot."""

    def __init__(self) -> None:
        self._known: WeakKeyDictionary[Robot, dict[Hashable, Value]] = WeakKeyDictionary()

    def get(self, robot: Robot, key: Hashable, make: Callable[[], Value]) -> Value:
        """Return the cached value of the key, or build and cache it; keys without a hash are not cached."""
        try:
            hash(key)
        except TypeError:
            return make()
        known = self._known.setdefault(robot, {})
        if key not in known:
            known[key] = make()
        return known[key]
