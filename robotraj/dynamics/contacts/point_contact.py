"""A point foot: its position is held on the ground and its frame turns freely."""

from __future__ import annotations

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
    label_of,
    spread,
)
from robotraj.dynamics.contacts.cones import FrictionCone, SecondOrder, checked_cone
from robotraj.dynamics.contacts.footing import BoundFoothold, Footing, keep_footing
from robotraj.dynamics.contacts.mobility import AXES, mobility, require_plane, require_rank
from robotraj.dynamics.contacts.point_on_frame import Spot, Triple
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.row import Row
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import as_ground
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot


class FrictionContact(Contact):
    """A contact whose force lies in a friction cone.

    Attributes
    ----------
    friction : float
        Coefficient mu.
    ground : Ground or callable
    cone : FrictionCone
    normal_force : (float, float)
        Least and greatest normal force [N].
    """

    friction: float
    ground: Ground | Callable[[ca.SX, ca.SX], Scalar]
    cone: FrictionCone
    normal_force: tuple[float, float]


@dataclass(frozen=True)
class PointContact(FrictionContact):
    """A point of the robot held on the ground: p(q) = (x, y, h(x, y)) with x, y unknown and constant.

    Its force f pushes, f_n >= 0, and lies in the friction cone, |f_t| <= mu f_n, in the ground's axes at the foothold.
    In a plane the cone is two lines, mu f_n - f_t >= 0 and mu f_n + f_t >= 0, for every ``cone``. World axes along
    which the frame cannot move have no rows and no forces.

    Parameters
    ----------
    frame : str
    friction : float
        Coefficient mu.
    ground : Ground or callable
        ``rt.terrain.Flat()``, ``rt.terrain.Slope(...)`` ... or a function of (x, y) written with CasADi. A hand on a
        wall has ``rt.terrain.Plane(point, outward)``.
    name : str, optional
        The frame's name where none is given.
    cone : FrictionCone
        ``SecondOrder()``, exact, or ``Linearised(faces)``, inside it.
    normal_force : (float, float)
        Least and greatest f_n [N].
    offset : sequence of 3 float
        The point in the frame's axes [m].
    margin : float
        Share of the friction that plans keep back, 0 to less than 1: |f_t| <= (1 - margin) mu f_n.

    Raises
    ------
    InputError
        The friction is not positive, the bounds of the normal force are crossed, the margin is no share, or the ground
        or cone is of a wrong type.
    """

    frame: str
    friction: float = 0.7
    ground: Ground | Callable[[ca.SX, ca.SX], Scalar] = field(default_factory=Flat)
    name: str | None = None
    cone: FrictionCone = field(default_factory=SecondOrder)
    normal_force: tuple[float, float] = (0.0, np.inf)
    offset: Triple = (0.0, 0.0, 0.0)
    margin: float = 0.0

    def __post_init__(self) -> None:
        what = f"PointContact {self.label!r}"
        keep_footing(self, what)
        checked_cone(self.cone, what)

    @property
    def label(self) -> str:
        """Name of the contact."""
        return label_of(self.name, self.frame)

    def bind(self, robot: Robot) -> BoundPointContact:
        """Find the axes in which the point can move, and return one row and one force for each."""
        return bind_point(self, robot, Spot(self.frame, self.offset))


def bind_point(contact: FrictionContact, robot: Robot, spot: Spot) -> BoundPointContact:
    """Bind a contact that holds a spot and leaves its frame free to turn.

    Raises
    ------
    InputError
        The frame does not exist, leaves a planar robot's plane, cannot move to and from the ground, or moves in a
        tilted plane.
    """
    what = f"{type(contact).__name__} {contact.label!r}"
    robot.frame(spot.frame)
    axes, _ = mobility(robot, lambda q: spot.jacobian(robot, q))
    require_plane(robot, spot.frame, axes)
    ground = as_ground(contact.ground)
    require_normal(robot, spot.frame, axes, ground)
    require_rank(robot, lambda q: spot.jacobian(robot, q)[list(axes)], len(axes), what)
    still, _ = spot.placed(robot, robot.neutral)
    footing = Footing(contact.label, ground, axes, (float(still[0]), float(still[1]), float(still[2])))
    forces = force_variables(contact.label, axes)
    least, greatest = contact.normal_force
    normal = Row("normal force", "N", float(least), float(greatest), contact.label, footing.normal_variable(forces))
    return BoundPointContact(
        contact,
        contact.label,
        spot.frame,
        forces,
        footing.anchors,
        held_rows(contact.label, axes),
        (normal, *friction_rows(contact, len(footing.along), contact.label)),
        footing.rows(),
        spot,
        footing,
    )


def require_normal(robot: Robot, frame: str, axes: tuple[int, ...], ground: Ground) -> None:
    """Refuse a contact whose frame cannot move to and from the ground, up and down by default."""
    if ground.axis not in axes:
        way = "up or down" if ground.axis == 2 else f"along {AXES[ground.axis]}, to and from its ground"
        raise InputError(f"Frame {frame!r} of {robot.name!r} cannot move {way}; give a contact a frame that can.")


@dataclass(frozen=True, eq=False)
class BoundPointContact(BoundFoothold):
    """A held spot with a force in a friction cone."""

    contact: FrictionContact

    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """p(q) - (x, y, h(x, y)) [m]."""
        spot, place = self.spot.position(point), self.where.place(anchors)
        return [spot[i] - place[i] for i in self.where.axes]

    def velocity(self, point: FramePoint) -> list[Scalar]:
        """Velocity of the spot [m/s]."""
        motion = self.spot.velocity(point)
        return [motion[i] for i in self.where.axes]

    def acceleration(self, point: FramePoint) -> list[Scalar]:
        """Acceleration of the spot [m/s^2]."""
        motion = self.spot.acceleration(point)
        return [motion[i] for i in self.where.axes]

    def wrench(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Wrench]:
        """Force at the spot, as a wrench at the frame's origin."""
        return [(self.frame, self.spot.wrench(point, self.vector(forces), [0.0, 0.0, 0.0]))]

    def vector(self, forces: Sequence[Scalar]) -> list[Scalar]:
        """Force (3) [N]."""
        return spread(forces, self.where.axes)

    def limits(self, point: FramePoint, forces: Sequence[Scalar], anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Evaluate normal force, then friction."""
        normal, tangential = self.where.components(self.vector(forces), anchors)
        return [normal, *friction_values(self.contact, normal, tangential)]

    def shares(self, point: FramePoint, forces: Sequence[float], anchors: Mapping[str, float]) -> dict[str, float]:
        """Return the share |f_t| / (mu f_n) of the cone."""
        return cone_share(self.where.components(self.vector(forces), anchors), self.contact.friction)

    def footing(self, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Evaluate the ground's foothold rows."""
        return self.where.values(anchors)

    def outline(self) -> list[Spot]:
        """Return the spot."""
        return [self.spot]

    def locate(self, robot: Robot, q: Array) -> dict[str, float]:
        """Place of the spot in configuration q."""
        place, _ = self.spot.placed(robot, q)
        return {anchor.name: float(place[i]) for anchor, i in zip(self.anchors, self.where.along, strict=True)}


def friction_values(contact: FrictionContact, normal: Scalar, tangential: Sequence[Scalar]) -> list[Scalar]:
    """Friction rows for two tangents (the contact's cone), for one (two lines) or for none."""
    if len(tangential) == 2:
        return contact.cone.rows(contact.planned_friction, normal, *tangential)
    reach = contact.planned_friction * normal
    return [row for along in tangential for row in (reach - along, reach + along)]


def cone_share(components: tuple[Scalar, Sequence[Scalar]], friction: float) -> dict[str, float]:
    """Return the share of the cone that a normal force and tangential forces in numbers use."""
    normal, tangential = components
    size = float(np.linalg.norm([float(part) for part in tangential]))
    return {"cone": size / (float(friction) * float(normal)) if normal > 0.0 else np.inf if size else 0.0}


def friction_rows(contact: FrictionContact, tangents: int, name: str) -> tuple[Row, ...]:
    """Names, units and bounds of the values of ``friction_values``."""
    units = contact.cone.units if tangents == 2 else ("N", "N") * tangents
    return tuple(Row("friction cone", unit, 0.0, np.inf, name) for unit in units)
