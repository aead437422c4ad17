"""A foot held on an edge, its heel or toe: it can only roll about that line."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import (
    BoundContact,
    Wrench,
    held_rows,
    keep,
    label_of,
    positive,
)
from robotraj.dynamics.contacts.cones import FrictionCone, SecondOrder, checked_cone
from robotraj.dynamics.contacts.foot_axes import foot_axes, unit
from robotraj.dynamics.contacts.footing import BoundFoothold, Footing, keep_footing
from robotraj.dynamics.contacts.mobility import mobility, require_plane, require_rank
from robotraj.dynamics.contacts.point_contact import FrictionContact, bind_point, cone_share
from robotraj.dynamics.contacts.point_on_frame import Spot, Triple
from robotraj.dynamics.contacts.vectors import add, cross, dot, scale
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.row import Row
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import as_ground
from robotraj.dynamics.variable import Column, Scalar, Variable
from robotraj.robot.robot import Robot

VERTICAL = (0.0, 0.0, 1.0)


class EdgeContact(FrictionContact):
    """A contact along a line: its frame can turn about the line alone.

    Attributes
    ----------
    width : float or None
        Length of the line [m].
    """

    width: float | None


@dataclass(frozen=True)
class LineContact(EdgeContact):
    """An edge of a foot held on the ground: five rows; in a plane, the two rows of a point.

    The edge's middle is held at (x, y, h(x, y)). Its direction l lies in the ground's tangent plane, at right angles
    to the heading c = t_1 cos(yaw) + t_2 sin(yaw). x, y and yaw are unknown and constant; the foot rolls about l.
    Beside the force the contact has two moments, about axes that are fixed in the world while the foot rolls,

        u = l x z,    w = z - (z . l) l,

    forward and upward on level ground. The centre of pressure is on the edge, |m . c| <= f_n width / 2. Torsion is
    bounded, |m . n| <= mu r f_n, with r = width / 4: the largest moment of a uniform pressure along the edge.

    Parameters
    ----------
    frame : str
    width : float
        Length of the edge [m]; required unless the robot moves in a plane.
    friction, ground, name, cone, normal_force
        As for ``PointContact``.
    offset : sequence of 3 float
        Middle of the edge in the frame's axes [m], (0.1, 0, 0) for a toe 0.1 m ahead of the frame.
    margin : float
        Share of friction and edge that plans keep back, 0 to less than 1.
    direction : sequence of 3 float, optional
        l, to the foot's left, in the frame's axes. Default: the left axis that ``FlatFoot`` derives.

    Raises
    ------
    InputError
        A width or friction that is not positive, crossed bounds, a direction of length zero.
    """

    frame: str
    width: float | None = None
    friction: float = 0.7
    ground: Ground | Callable[[ca.SX, ca.SX], Scalar] = field(default_factory=Flat)
    name: str | None = None
    cone: FrictionCone = field(default_factory=SecondOrder)
    normal_force: tuple[float, float] = (0.0, np.inf)
    offset: Triple = (0.0, 0.0, 0.0)
    direction: Triple | None = None
    margin: float = 0.0

    def __post_init__(self) -> None:
        what = f"LineContact {self.label!r}"
        keep_footing(self, what)
        if self.width is not None:
            positive(self.width, f"width of {what}", "m")
        checked_cone(self.cone, what)
        if self.direction is not None:
            keep(self, direction=unit(self.direction, f"direction of {what}"))

    @property
    def label(self) -> str:
        """Name of the contact."""
        return label_of(self.name, self.frame)

    def bind(self, robot: Robot) -> BoundContact:
        """Bind an edge in space; in a plane, bind the point where the plane cuts the edge."""
        robot.frame(self.frame)
        spot = Spot(self.frame, self.offset)
        axes, about = mobility(robot, lambda q: spot.jacobian(robot, q))
        require_plane(robot, self.frame, axes, about)
        if len(axes) < 3:
            return bind_point(self, robot, spot)
        place, rotation = spot.placed(robot, robot.neutral)
        return bind_edge(self, robot, spot, self._along(rotation, as_ground(self.ground).normal_at(place.tolist())))

    def _along(self, rotation: Column, normal: Sequence[Scalar]) -> Triple:
        """Direction of the edge in the frame's axes, a unit vector."""
        if self.direction is None:
            return foot_axes(rotation, normal, None, None, f"LineContact {self.label!r}").left
        return self.direction


def bind_edge(contact: EdgeContact, robot: Robot, spot: Spot, along: Triple) -> BoundLineContact:
    """Bind a contact that holds a spot and lets its frame turn about an axis alone.

    Raises
    ------
    InputError
        The contact has no width, its ground is not below it, or the frame cannot move in the five rows.
    """
    name, what = contact.label, f"{type(contact).__name__} {contact.label!r}"
    if contact.width is None:
        raise InputError(f"{what} has no width; give width= [m], since {robot.name!r} does not move in a plane.")
    ground = as_ground(contact.ground)
    if not ground.below:
        raise InputError(f"{what} touches a ground that is not below it; use PointContact or FlatFoot on a wall.")

    def held(q: Array) -> Array:
        jacobian = spot.jacobian(robot, q)
        left = spot.placed(robot, q)[1] @ np.array(along)
        return np.vstack([jacobian[:3], np.array(_across(left)) @ jacobian[3:]])

    require_rank(robot, held, 5, what)
    place, _ = spot.placed(robot, robot.neutral)
    where = Footing(name, ground, (0, 1, 2), (float(place[0]), float(place[1]), float(place[2])))
    least, greatest = contact.normal_force
    rows = [("friction cone", unit) for unit in contact.cone.units]
    rows += [("centre of pressure", "N m")] * 2 + [("torsional friction", "N m")] * 2
    forces = _forces(name)
    normal = Row("normal force", "N", float(least), float(greatest), name, where.normal_variable(forces[:3]))
    return BoundLineContact(
        contact,
        name,
        spot.frame,
        forces,
        (*where.anchors, Variable(f"{name}.yaw", "rad", "foothold", name)),
        held_rows(name, (0, 1, 2), (0, 2)),
        (normal, *(Row(title, unit, 0.0, np.inf, name) for title, unit in rows)),
        where.rows(),
        spot,
        where,
        along,
        float(contact.width),
    )


@dataclass(frozen=True, eq=False)
class BoundLineContact(BoundFoothold):
    """A held edge with a force and two moments."""

    along: Triple
    width: float

    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Place of the edge's middle [m], then the rotation of l from its held direction about u and w [rad]."""
        spot, place = self.spot.position(point), self.where.place(anchors)
        left = self.spot.axis(point, self.along)
        ahead, normal = self._heading_and_normal(anchors)
        turn = add(scale(dot(left, normal), ahead), scale(-dot(left, ahead), normal))
        return [spot[i] - place[i] for i in range(3)] + [dot(turn, axis) for axis in _across(left)]

    def velocity(self, point: FramePoint) -> list[Scalar]:
        """Velocity of the edge's middle [m/s], then angular velocity about u and w [rad/s]."""
        spin = self.spot.angular_velocity(point)
        return self.spot.velocity(point) + [dot(spin, axis) for axis in _across(self.spot.axis(point, self.along))]

    def acceleration(self, point: FramePoint) -> list[Scalar]:
        """Time derivative of ``velocity``; dl/dt is the angular velocity times l."""
        left, spin = self.spot.axis(point, self.along), self.spot.angular_velocity(point)
        rate = cross(spin, left)
        forward, upward = _across(left)
        # spin . dw/dt = -(z . dl/dt) (spin . l), since dl/dt = spin x l is at right angles to spin.
        turning = [dot(spin, cross(rate, VERTICAL)), -rate[2] * dot(left, spin)]
        angular = self.spot.angular_acceleration(point)
        rows = [dot(angular, axis) + more for axis, more in zip((forward, upward), turning, strict=True)]
        return self.spot.acceleration(point) + rows

    def wrench(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Wrench]:
        """Force at the edge's middle and moments about u and w, as a wrench at the frame's origin."""
        return [(self.frame, self.spot.wrench(point, [forces[i] for i in range(3)], self._moment(point, forces)))]

    def vector(self, forces: Sequence[Scalar]) -> list[Scalar]:
        """Force in world axes, moment about u, zero, and moment about w (6) [N, N m]."""
        return [forces[0], forces[1], forces[2], forces[3], 0.0, forces[4]]

    def limits(self, point: FramePoint, forces: Sequence[Scalar], anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Evaluate normal force, friction, centre of pressure on the edge, torsion."""
        contact: EdgeContact = self.contact  # type: ignore[assignment]
        normal, tangential = self.where.components([forces[i] for i in range(3)], anchors)
        moment = self._moment(point, forces)
        ahead, upward = self._heading_and_normal(anchors)
        tipping, twist = dot(moment, ahead), dot(moment, upward)
        width, mu = (1.0 - contact.margin) * self.width, contact.planned_friction
        reach, grip = 0.5 * width * normal, 0.25 * width * mu * normal
        friction = contact.cone.rows(mu, normal, *tangential)
        return [normal, *friction, reach - tipping, reach + tipping, grip - twist, grip + twist]

    def shares(self, point: FramePoint, forces: Sequence[float], anchors: Mapping[str, float]) -> dict[str, float]:
        """Return the shares of the cone, and of half the edge by the centre of pressure."""
        normal, tangential = self.where.components([forces[i] for i in range(3)], anchors)
        ahead, _ = self._heading_and_normal(anchors)
        tipping = abs(float(dot(self._moment(point, forces), ahead)))
        reach = 0.5 * self.width * float(normal)
        share = tipping / reach if reach > 0.0 else np.inf if tipping else 0.0
        return {**cone_share((normal, tangential), self.contact.friction), "sole": share}

    def footing(self, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Evaluate the ground's foothold rows for the whole edge."""
        return self.where.values(anchors, (0.0, 0.0, 0.5 * self.width))

    @property
    def half_width(self) -> float:
        """Half the length of the edge [m]."""
        return 0.5 * self.width

    def outline(self) -> list[Spot]:
        """Return the middle of the edge."""
        return [self.spot]

    def locate(self, robot: Robot, q: Array) -> dict[str, float]:
        """Place of the edge's middle and heading across it in configuration q."""
        place, rotation = self.spot.placed(robot, q)
        found = {f"{self.name}.x": float(place[0]), f"{self.name}.y": float(place[1])}
        (first, second), _ = self.where.tangents(found)
        left = rotation @ np.array(self.along)
        return {**found, f"{self.name}.yaw": float(np.arctan2(-left @ np.array(first), left @ np.array(second)))}

    def _moment(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Scalar]:
        forward, upward = _across(self.spot.axis(point, self.along))
        return add(scale(forces[3], forward), scale(forces[4], upward))

    def _heading_and_normal(self, anchors: Mapping[str, Scalar]) -> tuple[list[Scalar], list[Scalar]]:
        """Heading at right angles to the held edge, and the ground's normal there."""
        (first, second), normal = self.where.tangents(anchors)
        yaw = anchors[f"{self.name}.yaw"]
        return add(scale(ca.cos(yaw), first), scale(ca.sin(yaw), second)), normal


def _across(left: Sequence[Scalar]) -> tuple[list[Scalar], list[Scalar]]:
    """Axes u = l x z and w = z - (z . l) l at right angles to l, of equal length; they vanish where l is upright."""
    up = left[2]
    return [left[1], -left[0], 0.0], [-up * left[0], -up * left[1], 1.0 - up * up]


def _forces(name: str) -> tuple[Variable, ...]:
    force = [Variable(f"force.{name}.{axis}", "N", "contact force", name) for axis in "xyz"]
    return (*force, *(Variable(f"force.{name}.m{axis}", "N m", "contact moment", name) for axis in "xz"))
