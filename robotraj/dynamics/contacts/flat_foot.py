"""A flat foot: its sole lies on the ground and neither slides, turns nor tips."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import (
    Contact,
    Wrench,
    force_variables,
    held_rows,
    keep,
    label_of,
    positive,
    spread,
)
from robotraj.dynamics.contacts.foot_axes import FootAxes, foot_axes, unit
from robotraj.dynamics.contacts.footing import BoundFoothold, Footing, keep_footing
from robotraj.dynamics.contacts.mobility import mobility, require_plane, require_rank
from robotraj.dynamics.contacts.point_contact import cone_share, require_normal
from robotraj.dynamics.contacts.point_on_frame import Spot, Triple
from robotraj.dynamics.contacts.soles import PressureAndTorsion, Rectangle, Sole
from robotraj.dynamics.contacts.vectors import add, cross, dot, scale
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.row import Row
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import as_ground
from robotraj.dynamics.variable import Scalar, Variable
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class FlatFoot(Contact):
    """A rectangular sole held on the ground: six rows and a wrench; in a plane three, for x, z and pitch.

    The point at ``offset`` is held at (x, y, h(x, y)). The foot's up axis e is along the ground's normal n there.
    Its forward axis f is along t_1 cos(yaw) + t_2 sin(yaw). x, y and yaw are unknown and constant. The rows of
    orientation are the world components of the small rotation between foot and ground,

        r = -(e . t_2) t_1 + (e . t_1) t_2 + (f . l) n,    l = -t_1 sin(yaw) + t_2 cos(yaw),

    whose time derivative is the angular velocity where r = 0. The force along e is not negative. This also excludes
    the root of r where the foot is upside down. The sole bounds the tangential forces and the moments.

    Parameters
    ----------
    frame : str
    length : float or (float, float)
        Length of the sole, centred at the point, or its extent (back, front) from the point [m].
    width : float
        Width of the sole [m]; required unless the robot moves in a plane.
    friction : float
        Coefficient mu.
    ground : Ground or callable
        As for ``PointContact``.
    name : str, optional
        The frame's name where none is given.
    sole : Sole
        ``PressureAndTorsion(cone, radius)`` or ``FourCorners()``.
    normal_force : (float, float)
        Least and greatest f_n [N].
    offset : sequence of 3 float
        The sole's point in the frame's axes [m], (0, 0, -0.1) for a frame 0.1 m above the sole.
    margin : float
        Share of friction and sole that plans keep back, 0 to less than 1.
    normal, forward : sequence of 3 float, optional
        Up and forward axis of the foot in the frame's axes. Default: the frame's axes nearest the ground's normal
        and world x (the horizontal of the plane, in a plane) where the robot is neutral.

    Raises
    ------
    InputError
        The sole's size or the friction is not positive, the axes are parallel, or the bounds are crossed.
    """

    frame: str
    length: float | tuple[float, float]
    width: float | None = None
    friction: float = 0.7
    ground: Ground | Callable[[ca.SX, ca.SX], Scalar] = field(default_factory=Flat)
    name: str | None = None
    sole: Sole = field(default_factory=PressureAndTorsion)
    normal_force: tuple[float, float] = (0.0, np.inf)
    offset: Triple = (0.0, 0.0, 0.0)
    normal: Triple | None = None
    forward: Triple | None = None
    margin: float = 0.0

    def __post_init__(self) -> None:
        what = f"FlatFoot {self.label!r}"
        keep_footing(self, what)
        if not isinstance(self.sole, Sole):
            raise InputError(
                f"The sole of {what} is {self.sole!r}; give rt.contacts.PressureAndTorsion() or "
                f"rt.contacts.FourCorners()."
            )
        keep(self, length=sole_length(self.length, f"length of {what}"))
        if self.width is not None:
            keep(self, width=positive(self.width, f"width of {what}", "m"))
        if self.normal is not None:
            keep(self, normal=unit(self.normal, f"normal of {what}"))
        if self.forward is not None:
            keep(self, forward=unit(self.forward, f"forward axis of {what}"))
        if self.normal is not None and self.forward is not None:
            foot_axes(np.eye(3), self.normal, self.normal, self.forward, what)

    @property
    def label(self) -> str:
        """Name of the contact."""
        return label_of(self.name, self.frame)

    def bind(self, robot: Robot) -> BoundFlatFoot:
        """Find the foot's axes and whether it moves in a plane, and return its rows and forces."""
        what = f"FlatFoot {self.label!r}"
        robot.frame(self.frame)
        spot = Spot(self.frame, self.offset)
        axes, about = mobility(robot, lambda q: spot.jacobian(robot, q))
        require_plane(robot, self.frame, axes, about)
        ground = as_ground(self.ground)
        require_normal(robot, self.frame, axes, ground)
        require_rank(
            robot, lambda q: spot.jacobian(robot, q)[[*axes, *(3 + i for i in about)]], len(axes) + len(about), what
        )
        spatial = (axes, about) == ((0, 1, 2), (0, 1, 2))
        if not spatial and not (len(axes) == 2 and about == (1 - axes[0],)):
            raise InputError(
                "FlatFoot needs a frame that moves and turns freely, or only in an upright plane; frame "
                f"{self.frame!r} of {robot.name!r} does neither. Use PointContact."
            )
        if spatial and self.width is None:
            raise InputError(f"{what} has no width; give width= [m], since {robot.name!r} does not move in a plane.")
        place, rotation = spot.placed(robot, robot.neutral)
        where = Footing(self.label, ground, axes, (float(place[0]), float(place[1]), float(place[2])))
        ahead = np.eye(3)[where.along[0]]
        feet = foot_axes(rotation, ground.normal_at(where.still), self.normal, self.forward, what, ahead)
        yaw = (Variable(f"{self.label}.yaw", "rad", "foothold", self.label),) if spatial else ()
        return BoundFlatFoot(
            self,
            self.label,
            self.frame,
            force_variables(self.label, axes, about),
            (*where.anchors, *yaw),
            held_rows(self.label, axes, about, ground.axis),
            self._limit_rows(spatial),
            where.rows(),
            spot,
            where,
            about,
            feet,
            self._shape() if spatial else self._section(rotation @ np.array(feet.left), about[0], robot),
        )

    def _shape(self) -> Rectangle:
        """Return the sole as a rectangle."""
        back, front = self.length  # type: ignore[misc]  # as __post_init__ keeps it
        return Rectangle(back, front, 0.0 if self.width is None else self.width / 2.0)

    def _section(self, left: Triple, axis: int, robot: Robot) -> Rectangle:
        """Return the rectangle in the plane of motion; the axis out of the plane is the foot's left or right."""
        if abs(left[axis]) < 0.99:
            raise InputError(
                f"The normal and forward axes of FlatFoot {self.label!r} do not lie in the plane that {robot.name!r} "
                "moves in; give others, or omit them."
            )
        shape = self._shape()
        return shape if left[axis] > 0.0 else Rectangle(shape.front, shape.back, shape.half)

    def _limit_rows(self, spatial: bool) -> tuple[Row, ...]:
        least, greatest = self.normal_force
        planar = [("friction cone", "N")] * 2 + [("centre of pressure", "N m")] * 2
        labels = self.sole.labels() if spatial else planar
        normal = Row("normal force", "N", float(least), float(greatest), self.label)
        return (normal, *(Row(name, unit, 0.0, np.inf, self.label) for name, unit in labels))


def sole_length(value: float | Sequence[float], what: str) -> tuple[float, float]:
    """Read the extent of a sole backwards and forwards [m]; one of the two may be zero."""
    if np.ndim(value) == 0:
        half = positive(value, what, "m") / 2.0
        return half, half
    if np.shape(value) != (2,):
        raise InputError(f"The {what} is {value!r}; give one number or (back, front) [m].")
    back, front = (0.0 if entry == 0.0 else positive(entry, what, "m") for entry in np.asarray(value).tolist())
    positive(back + front, what, "m")
    return back, front


@dataclass(frozen=True, eq=False)
class BoundFlatFoot(BoundFoothold):
    """A held sole with a wrench."""

    about: tuple[int, ...]
    feet: FootAxes
    shape: Rectangle

    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Place of the sole's point [m], then the rotation r from ground to foot [rad near zero]."""
        spot, place = self.spot.position(point), self.where.place(anchors)
        turn = self._rotation(point, anchors)
        return [spot[i] - place[i] for i in self.where.axes] + [turn[i] for i in self.about]

    def velocity(self, point: FramePoint) -> list[Scalar]:
        """Velocity of the sole's point, then angular velocity [m/s, rad/s]."""
        return self._held(self.spot.velocity(point), self.spot.angular_velocity(point))

    def acceleration(self, point: FramePoint) -> list[Scalar]:
        """Acceleration of the sole's point, then angular acceleration [m/s^2, rad/s^2]."""
        return self._held(self.spot.acceleration(point), self.spot.angular_acceleration(point))

    def wrench(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Wrench]:
        """Move the wrench to the frame's origin."""
        vector = self.vector(forces)
        return [(self.frame, self.spot.wrench(point, vector[:3], vector[3:]))]

    def vector(self, forces: Sequence[Scalar]) -> list[Scalar]:
        """Force and moment at the sole's point (6) [N, N m]."""
        values = [forces[i] for i in range(len(self.forces))]
        count = len(self.where.axes)
        return spread(values[:count], self.where.axes) + spread(values[count:], self.about)

    def limits(self, point: FramePoint, forces: Sequence[Scalar], anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Evaluate normal force, friction, centre of pressure and torsion, in the foot's own axes."""
        contact: FlatFoot = self.contact  # type: ignore[assignment]
        shape = self.shape.scaled(1.0 - contact.margin)
        friction = contact.planned_friction
        if len(self.about) == 1:
            return self._planar(self.vector(forces), self.spot.axis(point, self.feet.up), friction, shape)
        force, moment = self._in_axes(point, forces)
        return [force[2], *contact.sole.rows(friction, shape, force, moment)]

    def shares(self, point: FramePoint, forces: Sequence[float], anchors: Mapping[str, float]) -> dict[str, float]:
        """Return the shares of the cone, and of the sole: the way of the centre of pressure to the nearest edge."""
        if len(self.about) == 1:
            vector, up = self.vector(forces), self.spot.axis(point, self.feet.up)
            axis = spread([1.0], self.about)
            force = [dot(vector[:3], cross(axis, up)), 0.0, dot(vector[:3], up)]
            moment = [0.0, dot(vector[3:], axis), 0.0]
        else:
            force, moment = self._in_axes(point, forces)
        cone = cone_share((force[2], force[:2]), self.contact.friction)
        return {**cone, "sole": self.shape.share(float(force[2]), [float(part) for part in moment])}

    def _in_axes(self, point: FramePoint, forces: Sequence[Scalar]) -> tuple[list[Scalar], list[Scalar]]:
        """Return force and moment along the forward, left and up axes of the foot."""
        vector = self.vector(forces)
        axes = [self.spot.axis(point, each) for each in (self.feet.forward, self.feet.left, self.feet.up)]
        return [dot(vector[:3], axis) for axis in axes], [dot(vector[3:], axis) for axis in axes]

    def footing(self, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Evaluate the ground's foothold rows for the whole sole."""
        return self.where.values(anchors, (self.shape.back, self.shape.front, self.shape.half))

    @property
    def half_width(self) -> float:
        """Half the width of the sole [m]."""
        return self.shape.half

    def outline(self) -> list[Spot]:
        """Return the corners of the sole, or its two ends for a robot in a plane."""
        ahead, left, shape = np.array(self.feet.forward), np.array(self.feet.left), self.shape
        corners = itertools.product((-shape.back, shape.front), sorted({-shape.half, shape.half}))
        places = (np.array(self.spot.offset) + x * ahead + y * left for x, y in corners)
        return [Spot(self.frame, (float(p[0]), float(p[1]), float(p[2]))) for p in places]

    def locate(self, robot: Robot, q: Array) -> dict[str, float]:
        """Place of the sole's point and heading of the foot in configuration q."""
        place, rotation = self.spot.placed(robot, q)
        found = {anchor.name: float(place[i]) for anchor, i in zip(self.anchors, self.where.along, strict=False)}
        if len(self.about) == 3:
            (first, second), _ = self.where.tangents(found)
            ahead = rotation @ np.array(self.feet.forward)
            found[f"{self.name}.yaw"] = float(np.arctan2(ahead @ np.array(second), ahead @ np.array(first)))
        return found

    def _rotation(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Rotation r from ground to foot in world axes, to first order (3) [rad]."""
        up = self.spot.axis(point, self.feet.up)
        tangents, normal = self.where.tangents(anchors)
        if len(self.about) == 1:
            axis = spread([1.0], self.about)
            return scale(dot(up, cross(axis, normal)), axis)
        first, second = tangents
        yaw = anchors[f"{self.name}.yaw"]
        across = add(scale(-ca.sin(yaw), first), scale(ca.cos(yaw), second))
        ahead = self.spot.axis(point, self.feet.forward)
        return add(scale(-dot(up, second), first), scale(dot(up, first), second), scale(dot(ahead, across), normal))

    def _planar(
        self, vector: Sequence[Scalar], up: Sequence[Scalar], friction: float, shape: Rectangle
    ) -> list[Scalar]:
        """Rows of a foot in an upright plane: forward is along left x up, and left is out of the plane."""
        axis = spread([1.0], self.about)
        along, normal, moment = dot(vector[:3], cross(axis, up)), dot(vector[:3], up), dot(vector[3:], axis)
        reach = friction * normal
        # An upward force f at a distance c forward has the moment -c f about the axis to the left.
        front, back = shape.front * normal + moment, shape.back * normal - moment
        return [normal, reach - along, reach + along, front, back]

    def _held(self, linear: Sequence[Scalar], angular: Sequence[Scalar]) -> list[Scalar]:
        return [linear[i] for i in self.where.axes] + [angular[i] for i in self.about]
