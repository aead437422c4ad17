"""A foot whose sole is an arc: it rolls on the ground without slipping, and the place where it touches moves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, fields
from typing import Any, TypeVar

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import (
    BoundContact,
    keep,
    label_of,
    positive,
)
from robotraj.dynamics.contacts.cones import FrictionCone, SecondOrder, checked_cone
from robotraj.dynamics.contacts.edges.line_contact import BoundLineContact, EdgeContact, bind_edge
from robotraj.dynamics.contacts.flat_foot import sole_length
from robotraj.dynamics.contacts.foot_axes import foot_axes, unit
from robotraj.dynamics.contacts.footing import BoundFoothold, keep_footing
from robotraj.dynamics.contacts.mobility import mobility
from robotraj.dynamics.contacts.point_contact import BoundPointContact, bind_point
from robotraj.dynamics.contacts.point_on_frame import RollingSpot, Spot, Triple
from robotraj.dynamics.contacts.vectors import add, cross, dot, scale
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.row import Row
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import as_ground
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot

Kind = TypeVar("Kind", bound=BoundFoothold)


@dataclass(frozen=True)
class ArcFoot(EdgeContact):
    """A sole in the shape of an arc that rolls on a plane without slipping: five rows; in a plane two.

    The sole is a part of a cylinder of radius r about an axis l to the foot's left. With the middle of the axis at c,
    the ground's normal n, the heading t, and the roll angle a = atan2(e . t, e . n) of the foot's up axis e,

        c = (x, y, h(x, y)) + r n + r a t,

    so that the foot touches the ground at c - r n, and stands upright at (x, y), unknown and constant. The sole is
    at rest where it touches: dc/dt = r w x n, with w the angular velocity of the foot. The force acts there. In space
    the foot turns about l alone; its moments are those of ``LineContact``.

    Parameters
    ----------
    frame : str
    radius : float
        r [m].
    length : float or (float, float)
        Length of the sole along the arc, centred at its middle, or its extent (back, front) [m]. The place where it
        touches stays on the sole, -back <= r a <= front.
    width : float
        Width of the sole [m]; required unless the robot moves in a plane.
    friction, name, cone, normal_force
        As for ``PointContact``.
    ground : Ground
        A plane below the robot: ``rt.terrain.Flat()``, ``Slope`` or ``Plane``.
    offset : sequence of 3 float
        Middle of the sole in the frame's axes [m], where the foot touches when it is upright. c is r above it.
    margin : float
        Share of friction and sole that plans keep back, 0 to less than 1.
    normal, forward : sequence of 3 float, optional
        Up and forward axis of the foot in the frame's axes, as for ``FlatFoot``.

    Raises
    ------
    InputError
        A size or the friction is not positive, the ground is no plane, bounds are crossed, or axes are parallel.
    """

    frame: str
    radius: float
    length: float | tuple[float, float]
    width: float | None = None
    friction: float = 0.7
    ground: Ground | Callable[[ca.SX, ca.SX], Scalar] = field(default_factory=Flat)
    name: str | None = None
    cone: FrictionCone = field(default_factory=SecondOrder)
    normal_force: tuple[float, float] = (0.0, np.inf)
    offset: Triple = (0.0, 0.0, 0.0)
    normal: Triple | None = None
    forward: Triple | None = None
    margin: float = 0.0

    def __post_init__(self) -> None:
        what = f"ArcFoot {self.label!r}"
        keep_footing(self, what)
        keep(self, radius=positive(self.radius, f"radius of {what}", "m"))
        keep(self, length=sole_length(self.length, f"length of {what}"))
        if self.width is not None:
            keep(self, width=positive(self.width, f"width of {what}", "m"))
        checked_cone(self.cone, what)
        for axis in ("normal", "forward"):
            if (given := getattr(self, axis)) is not None:
                keep(self, **{axis: unit(given, f"{axis} axis of {what}")})
        if not as_ground(self.ground).even:
            raise InputError(
                f"{what} rolls on a plane; the ground is {self.ground!r}. Give rt.terrain.Flat(), "
                "rt.terrain.Slope(...) or rt.terrain.Plane(...), or use rt.PointContact."
            )

    @property
    def label(self) -> str:
        """Name of the contact."""
        return label_of(self.name, self.frame)

    def bind(self, robot: Robot) -> BoundContact:
        """Bind an axis that rolls in space, or its middle in a plane."""
        what = f"ArcFoot {self.label!r}"
        robot.frame(self.frame)
        ground = as_ground(self.ground)
        place, rotation = Spot(self.frame, self.offset).placed(robot, robot.neutral)
        axes, about = mobility(robot, lambda q: Spot(self.frame, self.offset).jacobian(robot, q))
        along = [axis for axis in ground.plan if axis in axes]
        normal = ground.normal(*(float(place[axis]) for axis in ground.plan))
        if not along or not about:
            raise InputError(
                f"{what} needs a frame that moves along the ground and turns; frame {self.frame!r} of {robot.name!r} "
                "does not. Use PointContact."
            )
        ahead = np.eye(3)[along[0]]
        feet = foot_axes(rotation, normal, self.normal, self.forward, what, ahead)
        centre = np.array(self.offset) + self.radius * np.array(feet.up)
        up = np.array(normal, dtype=float)
        spot = RollingSpot(self.frame, _triple(centre), self.radius, _triple(up), feet.up)
        back, front = self.length  # type: ignore[misc]  # as __post_init__ keeps it
        touch = Row("contact on the sole", "m", -(1.0 - self.margin) * back, (1.0 - self.margin) * front, self.label)
        if len(axes) == 3:
            bound = bind_edge(self, robot, spot, feet.left)
            return _extended(BoundArcLine, bound, touch, self.offset)
        if float(rotation @ np.array(feet.forward) @ ahead) < 0.0:
            # In a plane the heading is along its axis, whatever the foot's forward axis.
            touch = Row(touch.name, "m", -touch.upper, -touch.lower, self.label)
        return _extended(BoundArcPoint, bind_point(self, robot, spot), touch, self.offset)


def _extended(kind: type[Kind], bound: BoundFoothold, touch: Row, middle: Triple) -> Kind:
    """Return a held point or edge as one that rolls: it has one limit more, on the place where it touches."""
    known: dict[str, Any] = {each.name: getattr(bound, each.name) for each in fields(bound)}
    return kind(**{**known, "limit_rows": (*bound.limit_rows, touch), "middle": middle})


class Rolling(BoundFoothold):
    """What arcs in a plane and in space share.

    Attributes
    ----------
    spot : RollingSpot
        The axis of the arc.
    middle : tuple of 3 float
        Middle of the sole in the frame's axes [m].
    """

    spot: RollingSpot
    middle: Triple

    @property
    def touching(self) -> Spot:
        """The middle of the sole."""
        return Spot(self.frame, self.middle)

    def place(self, anchors: Mapping[str, Scalar]) -> None:
        """Return None, since the place where the foot touches moves."""
        return None

    def touched(self, robot: Robot, q: Array) -> Array:
        """Place (3,) [m] where the sole touches the ground in configuration q."""
        return self.spot.placed(robot, q)[0]

    def outline(self) -> list[Spot]:
        """Return the ball about the middle of the axis, which touches where the arc does."""
        return [Spot(self.frame, self.spot.offset, self.spot.radius)]

    def reached(self, place: float) -> float:
        """Return the way of the touching place from the middle of the sole towards an end, 1 at the end."""
        contact: ArcFoot = self.contact  # type: ignore[assignment]
        touch, kept = self.limit_rows[-1], 1.0 - contact.margin
        half, middle = 0.5 * (touch.upper - touch.lower) / kept, 0.5 * (touch.upper + touch.lower) / kept
        return abs(float(place) - middle) / half


@dataclass(frozen=True, eq=False)
class BoundArcPoint(Rolling, BoundPointContact):
    """An arc that rolls in an upright plane."""

    spot: RollingSpot
    middle: Triple

    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Return c - r n - r a t - (x, y, h) [m], along the axes of the plane."""
        ahead = self.where.tangents(anchors)[0][0]
        rolled = scale(-self.spot.rolled(point, ahead), ahead)
        return [row + rolled[i] for row, i in zip(super().position(point, anchors), self.where.axes, strict=True)]

    def limits(self, point: FramePoint, forces: Sequence[Scalar], anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Evaluate the limits of a point, then the place where the sole touches, r a."""
        rolled = self.spot.rolled(point, self.where.tangents(anchors)[0][0])
        return [*super().limits(point, forces, anchors), rolled]

    def shares(self, point: FramePoint, forces: Sequence[float], anchors: Mapping[str, float]) -> dict[str, float]:
        """Return the shares of the cone and of the sole."""
        rolled = float(self.spot.rolled(point, self.where.tangents(anchors)[0][0]))
        return {**super().shares(point, forces, anchors), "sole": self.reached(rolled)}

    def locate(self, robot: Robot, q: Array) -> dict[str, float]:
        """Place where the foot stands upright."""
        found = super().locate(robot, q)
        ahead = self.where.tangents(found)[0][0]
        rolled = self.spot.rolled_in(robot, q, ahead)
        return {
            name: value - rolled * float(ahead[i])
            for (name, value), i in zip(found.items(), self.where.along, strict=True)
        }


@dataclass(frozen=True, eq=False)
class BoundArcLine(Rolling, BoundLineContact):
    """An arc that rolls in space about an axis of constant direction."""

    spot: RollingSpot
    middle: Triple

    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Return c - r n - r a t - (x, y, h) [m], then the rotation of the axis [rad].

        The row across the heading has the tilt about t, by which the touching place moves to the side.
        """
        rows = super().position(point, anchors)
        ahead, normal = self._heading_and_normal(anchors)
        tilt = self.spot.radius * dot(self.spot.axis(point, self.along), normal)
        moved = add(scale(-self.spot.rolled(point, ahead), ahead), scale(tilt, cross(normal, ahead)))
        return [*(row + part for row, part in zip(rows[:3], moved, strict=True)), *rows[3:]]

    def limits(self, point: FramePoint, forces: Sequence[Scalar], anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Evaluate the limits of an edge, then the place where the sole touches, r a."""
        rolled = self.spot.rolled(point, self._heading_and_normal(anchors)[0])
        return [*super().limits(point, forces, anchors), rolled]

    def shares(self, point: FramePoint, forces: Sequence[float], anchors: Mapping[str, float]) -> dict[str, float]:
        """Return the shares of the cone and of the sole, across and along it."""
        known = super().shares(point, forces, anchors)
        rolled = float(self.spot.rolled(point, self._heading_and_normal(anchors)[0]))
        return {**known, "sole": max(known["sole"], self.reached(rolled))}

    def locate(self, robot: Robot, q: Array) -> dict[str, float]:
        """Place where the foot stands upright, and its heading."""
        found = super().locate(robot, q)
        ahead = self._heading_and_normal(found)[0]
        rolled = self.spot.rolled_in(robot, q, ahead)
        for i, axis in enumerate("xy"):
            found[f"{self.name}.{axis}"] -= rolled * float(ahead[i])
        return found


def _triple(vector: Array) -> Triple:
    x, y, z = (float(part) for part in vector)
    return x, y, z
