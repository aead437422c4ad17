"""The base class of obstacles: a solid shape with a pose, and the signed distance of points from it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import ClassVar, TypeAlias

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import own_fields
from robotraj.dynamics.expression_values import rows_of
from robotraj.dynamics.obstacles.speed_bounds import ranges_of
from robotraj.dynamics.variable import Column, Scalar

FixedOrMoving: TypeAlias = "Sequence[float] | Callable[[ca.SX], Column | Sequence[Scalar]]"
"""Three or four numbers, or a function of the time t [s] that returns them, written in CasADi's functions."""

ORIGIN = (0.0, 0.0, 0.0)
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
_ORDER = {4: ", (x, y, z, w)"}
"""What a message adds to the count of a quaternion's numbers."""
UNIT_LENGTH = 1e-3
"""Largest deviation of a quaternion's length from 1; within it the quaternion is normalised."""


class Obstacle(OneLine, ABC):
    """A solid shape. A new shape is one frozen dataclass with the fields below and the methods of this class.

    A point p of the world lies at R' (p - position) in the shape's axes, with R the rotation of the quaternion. The
    pose is that of the shape in the world, or in a frame of the robot.

    Attributes
    ----------
    position : (3,) or callable
        Position of the shape's centre [m], or a function of the time t [s].
    quaternion : (4,) or callable
        Rotation from the shape's axes, (x, y, z, w), or a function of the time t [s].
    frame : str or None
        Frame of the robot that carries the shape; None for the world.
    name : str
        Name for reports; by default the kind of the shape.
    """

    position: FixedOrMoving
    quaternion: FixedOrMoving
    frame: str | None
    name: str

    kind: ClassVar[str]
    """Kind of the shape, for reports and for the compiled module."""

    def __post_init__(self) -> None:
        own_fields(self)
        for what in (self.name, self.frame):
            if not (what is None or isinstance(what, str)):
                raise InputError(f"{type(self).__name__} has the name or frame {what!r}; give strings.")
        for name, size in (("position", 3), ("quaternion", 4)):
            value = getattr(self, name)
            if not callable(value):
                object.__setattr__(self, name, self._numbers(name, value, size))
        if not callable(self.quaternion):
            length = float(np.linalg.norm(self.quaternion))
            if abs(length - 1.0) > UNIT_LENGTH:
                raise InputError(
                    f"{self.label}: the quaternion has length {length:.4g}; give (x, y, z, w) of length 1."
                )
            object.__setattr__(self, "quaternion", tuple(value / length for value in self.quaternion))
        if self.moves:
            _ = self._motion  # raises an InputError if the user's function fails

    @property
    @abstractmethod
    def dimensions(self) -> tuple[float, ...]:
        """The numbers of the shape, at most four [m]."""

    @abstractmethod
    def distance(self, points: Array) -> Array:
        """Return the exact signed distance [m] of points (m, 3) in the shape's axes, negative inside, (m,)."""

    @property
    @abstractmethod
    def reach(self) -> float:
        """Largest distance of the shape's points from its origin [m]; infinite for a half space."""

    @property
    def label(self) -> str:
        """Name, or the kind where it has none."""
        return self.name or self.kind

    @property
    def moves(self) -> bool:
        """Whether the pose depends on time."""
        return callable(self.position) or callable(self.quaternion)

    def pose(self, t: Scalar = 0.0) -> tuple[Column, Column]:
        """Return position (3,) [m] and rotation matrix (3, 3) at a time [s], symbols where t is a symbol."""
        if not self.moves:
            return self._fixed
        position, rotation = self._motion(t)
        if isinstance(t, ca.SX):
            return position, rotation
        return np.array(position).ravel(), np.array(rotation)

    def poses(self, times: Array) -> tuple[Array, Array]:
        """Return positions (m, 3) and rotation matrices (m, 3, 3) at times (m,) [s]."""
        count = len(times)
        if not self.moves:
            position, rotation = self._fixed
            return np.broadcast_to(position, (count, 3)), np.broadcast_to(rotation, (count, 3, 3))
        positions, rotations = self._motion_at(count)(np.reshape(times, (1, -1)))
        columns = np.array(rotations).reshape(3, count, 3)
        return np.array(positions).T, columns.transpose(1, 0, 2)

    def speed_bounds(self, breaks: Array) -> Array:
        """Return bounds (K,) [m/s] on the speeds of the shape's points between times ``breaks`` (K + 1,) [s].

        The speed of a point is at most abs(d position / dt) + 2 abs(d quaternion / dt) reach.

        Raises
        ------
        InputError
            The pose uses an operation that ``speed_bounds.ranges_of`` does not support.
        """
        lower, upper = ranges_of(self._rates, breaks[:-1], breaks[1:], f"the pose of {self.label!r}")
        largest = np.maximum(np.abs(lower), np.abs(upper))
        linear, turning = (np.linalg.norm(part, axis=0) for part in (largest[:3], largest[3:]))
        return np.asarray(linear + np.where(turning > 0.0, 2.0 * turning * self.reach, 0.0))

    @cached_property
    def _rates(self) -> ca.Function:
        """Map t to the rates of position and unit quaternion, (7,)."""
        t = ca.SX.sym("t")
        parts = ca.vertcat(*self._symbols("position", self.position, 3, t), *self._quaternion(t))
        return ca.Function("rates", [t], [ca.densify(ca.jacobian(parts, t))])

    @cached_property
    def _fixed(self) -> tuple[Array, Array]:
        position, quaternion = (np.array(value, dtype=float) for value in (self.position, self.quaternion))
        rotation = np.array(rotation_of(list(quaternion)), dtype=float)
        for part in (position, rotation):
            part.setflags(write=False)
        return position, rotation

    def _motion_at(self, count: int) -> ca.Function:
        """Return ``_motion`` for a number of times; a control loop evaluates the same number at every step."""
        known = self._last_motion_at.get(count)
        if known is None:
            known = self._motion.map(count)
            self._last_motion_at.clear()
            self._last_motion_at[count] = known
        return known

    @cached_property
    def _last_motion_at(self) -> dict[int, ca.Function]:
        return {}

    @cached_property
    def _motion(self) -> ca.Function:
        """Map t to position and rotation; a quaternion that depends on time is normalised."""
        t = ca.SX.sym("t")
        position = self._symbols("position", self.position, 3, t)
        rotation = ca.vertcat(*(ca.horzcat(*row) for row in rotation_of(self._quaternion(t))))
        return ca.Function("pose", [t], [ca.densify(ca.vertcat(*position)), ca.densify(rotation)])

    def _quaternion(self, t: ca.SX) -> list[Scalar]:
        quaternion = self._symbols("quaternion", self.quaternion, 4, t)
        if not callable(self.quaternion):
            return quaternion
        length = ca.sqrt(sum(value * value for value in quaternion))
        return [value / length for value in quaternion]

    def _symbols(self, name: str, given: FixedOrMoving, size: int, t: ca.SX) -> list[Scalar]:
        if not callable(given):
            return list(given)
        found = rows_of(f"{name} of the obstacle {self.label!r}", given, t)
        if len(found) != size:
            raise InputError(f"{self.label}: the function of its {name} returns {len(found)} values; return {size}.")
        return found

    def _numbers(self, name: str, value: object, size: int) -> tuple[float, ...]:
        try:
            numbers = tuple(float(each) for each in np.asarray(value, dtype=float).ravel())
        except (TypeError, ValueError):
            numbers = ()
        if len(numbers) != size or not np.isfinite(numbers).all():
            raise InputError(f"{self.label}: {name} is {value!r}; give {size} finite numbers{_ORDER.get(size, '')}.")
        return numbers

    def _positive(self, name: str) -> None:
        """Check a length that must be above 0."""
        value = getattr(self, name)
        if not is_finite(value) or value <= 0.0:
            raise InputError(f"{self.label}: {name} is {value!r}; give a positive number of metres.")


def rotation_of(quaternion: Sequence[Scalar]) -> list[list[Scalar]]:
    """Return the rotation matrix of a unit quaternion (x, y, z, w), rows of entries."""
    x, y, z, w = quaternion
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
