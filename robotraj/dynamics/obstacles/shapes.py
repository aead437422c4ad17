"""Boxes, spheres, cylinders, capsules and half spaces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.obstacles.base import ORIGIN, UPRIGHT, FixedOrMoving, Obstacle


@dataclass(frozen=True)
class Box(Obstacle):
    """A box, abs(x) <= a / 2, abs(y) <= b / 2, abs(z) <= c / 2 in its own axes.

    Parameters
    ----------
    sides : (3,)
        Full side lengths a, b, c [m].
    position, quaternion, frame, name
        See ``Obstacle``.

    Raises
    ------
    InputError
        A side is not positive, or the position or quaternion is invalid.
    """

    sides: Sequence[float]
    position: FixedOrMoving = ORIGIN
    quaternion: FixedOrMoving = UPRIGHT
    frame: str | None = None
    name: str = ""

    kind: ClassVar[str] = "box"

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "sides", self._numbers("sides", self.sides, 3))
        if min(self.sides) <= 0.0:
            raise InputError(f"{self.label}: sides are {self.sides}; give three positive lengths in metres.")

    @property
    def dimensions(self) -> tuple[float, ...]:
        """Half the sides [m]."""
        return tuple(0.5 * side for side in self.sides)

    def distance(self, points: Array) -> Array:
        """Exact signed distance (m,) [m]."""
        return _from_corner(np.abs(points) - self.dimensions)

    @property
    def reach(self) -> float:
        """Half the diagonal [m]."""
        return float(np.linalg.norm(self.dimensions))


@dataclass(frozen=True)
class Sphere(Obstacle):
    """A ball, x^2 + y^2 + z^2 <= r^2.

    Parameters
    ----------
    radius : float
        r [m].
    position, quaternion, frame, name
        See ``Obstacle``.
    """

    radius: float
    position: FixedOrMoving = ORIGIN
    quaternion: FixedOrMoving = UPRIGHT
    frame: str | None = None
    name: str = ""

    kind: ClassVar[str] = "sphere"

    def __post_init__(self) -> None:
        super().__post_init__()
        self._positive("radius")

    @property
    def dimensions(self) -> tuple[float, ...]:
        """The radius [m]."""
        return (float(self.radius),)

    def distance(self, points: Array) -> Array:
        """Exact signed distance (m,) [m]."""
        return np.asarray(np.linalg.norm(points, axis=1) - self.radius)

    @property
    def reach(self) -> float:
        """The radius [m]."""
        return float(self.radius)


@dataclass(frozen=True)
class _Round(Obstacle):
    """A shape about its z axis, with a radius and a length."""

    radius: float
    length: float
    position: FixedOrMoving = ORIGIN
    quaternion: FixedOrMoving = UPRIGHT
    frame: str | None = None
    name: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        self._positive("radius")
        self._positive("length")

    @property
    def dimensions(self) -> tuple[float, ...]:
        """Radius and half the length [m]."""
        return float(self.radius), 0.5 * self.length


@dataclass(frozen=True)
class Cylinder(_Round):
    """A cylinder about its z axis, x^2 + y^2 <= r^2, abs(z) <= length / 2.

    Parameters
    ----------
    radius, length : float
        Radius and length [m].
    position, quaternion, frame, name
        See ``Obstacle``.
    """

    kind: ClassVar[str] = "cylinder"

    def distance(self, points: Array) -> Array:
        """Exact signed distance (m,) [m]."""
        radial = np.linalg.norm(points[:, :2], axis=1) - self.radius
        return _from_corner(np.column_stack([radial, np.abs(points[:, 2]) - 0.5 * self.length]))

    @property
    def reach(self) -> float:
        """Distance of the rims from the centre [m]."""
        return float(np.hypot(self.radius, 0.5 * self.length))


@dataclass(frozen=True)
class Capsule(_Round):
    """All points within a radius of a segment on its z axis.

    Parameters
    ----------
    radius : float
        Radius [m].
    length : float
        Length of the segment, without the caps [m].
    position, quaternion, frame, name
        See ``Obstacle``.
    """

    kind: ClassVar[str] = "capsule"

    def distance(self, points: Array) -> Array:
        """Exact signed distance (m,) [m]."""
        half = 0.5 * self.length
        beyond = points[:, 2] - np.clip(points[:, 2], -half, half)
        return np.asarray(np.linalg.norm(np.column_stack([points[:, :2], beyond]), axis=1) - self.radius)

    @property
    def reach(self) -> float:
        """Distance of the tips from the centre [m]."""
        return float(self.radius + 0.5 * self.length)


@dataclass(frozen=True)
class HalfSpace(Obstacle):
    """A half space, normal . x <= offset: ``HalfSpace((0, 0, 1), 0.0)`` is the ground below z = 0.

    Parameters
    ----------
    normal : (3,)
        Outward direction of the surface; it is normalised.
    offset : float
        Distance of the surface from the origin along the normal [m].
    position, quaternion, frame, name
        See ``Obstacle``.

    Raises
    ------
    InputError
        The normal is zero, or a value is not finite.
    """

    normal: Sequence[float]
    offset: float = 0.0
    position: FixedOrMoving = ORIGIN
    quaternion: FixedOrMoving = UPRIGHT
    frame: str | None = None
    name: str = ""

    kind: ClassVar[str] = "half space"

    def __post_init__(self) -> None:
        super().__post_init__()
        normal = np.array(self._numbers("normal", self.normal, 3))
        length = float(np.linalg.norm(normal))
        if length == 0.0:
            raise InputError(f"{self.label}: the normal is zero; give the outward direction of the surface.")
        object.__setattr__(self, "normal", tuple(float(value) for value in normal / length))
        object.__setattr__(self, "offset", self._numbers("offset", self.offset, 1)[0])

    @property
    def dimensions(self) -> tuple[float, ...]:
        """Normal and offset [m]."""
        return *self.normal, self.offset

    def distance(self, points: Array) -> Array:
        """Exact signed distance (m,) [m]."""
        return np.asarray(points @ np.array(self.normal) - self.offset)

    @property
    def reach(self) -> float:
        """Infinite."""
        return float("inf")


def _from_corner(beyond: Array) -> Array:
    """Signed distance (m,) where the shape is beyond <= 0, (m, n)."""
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    return np.asarray(outside + np.minimum(beyond.max(axis=1), 0.0))
