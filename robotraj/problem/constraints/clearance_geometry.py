"""Places on a robot for ground clearance: points of frames, and points, balls or discs of shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace
from typing import TypeAlias, TypeGuard, cast

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.point_on_frame import Spot
from robotraj.dynamics.point import FrameMotion, FramePoint
from robotraj.dynamics.terrain.base import Ground
from robotraj.problem.scalars import Scalar
from robotraj.robot.robot import Robot

Vector = tuple[float, float, float]
Triple: TypeAlias = Sequence[float] | NDArray[np.float64]
ROUNDING = 1e-2
"""Rounding of a disc relative to its radius. The height of its lowest point is not smooth where the disc lies along the
ground; the rounded height is smaller."""


@dataclass(frozen=True)
class ClearancePoint(OneLine):
    """A point, ball or disc fixed in a frame.

    Attributes
    ----------
    frame : str
    label : str
        Name for reports.
    offset : (3,)
        Centre in the frame's axes [m].
    radius : float
        Radius [m], 0 for a point.
    axis : (3,) or None
        Unit axis of a disc in the frame; None for a ball.
    shape : str
        Name of the collision shape that it belongs to; empty for points that the user fixed in a frame.
    """

    frame: str
    label: str
    offset: Vector = (0.0, 0.0, 0.0)
    radius: float = 0.0
    axis: Vector | None = None
    shape: str = ""

    def position(self, point: FramePoint) -> list[Scalar]:
        """Centre in the world [m]."""
        view = point.frame(self.frame)
        place, turned = view.position, _turned(view, self.offset)
        return [place[i] + turned[i] for i in range(3)]

    def gap(self, point: FramePoint, position: Sequence[Scalar], ground: Ground) -> Scalar:
        """Least vertical distance z - h(x, y) [m] over the ground's tangent plane below the spot's ``position``.

        The distance from a wall is that along its axis.

        With g = (-h_x, -h_y, 1), a ball's lowest point lies r |g| below its centre, a disc's
        r sqrt(|g|^2 - (g . axis)^2), rounded where the disc lies along the ground.
        """
        if self.axis is None:
            return ground.gap(position, self.radius)
        (first, second), up = ground.plan, ground.axis
        height, slope_x, slope_y = ground.plane(position[first], position[second])
        axis = _turned(point.frame(self.frame), self.axis)
        along = axis[up] - slope_x * axis[first] - slope_y * axis[second]
        steep = (1.0 + ROUNDING**2) * (1.0 + slope_x * slope_x + slope_y * slope_y) - along * along
        return ground.side * (position[up] - height) - self.radius * steep**0.5


def _turned(view: FrameMotion, vector: Vector) -> Sequence[Scalar]:
    """Rotate a frame's vector into world axes; a vector of zeros adds no operations to the graph."""
    return view.rotation @ np.array(vector) if any(vector) else (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class CollisionShapes(OneLine):
    """Collision shapes of links, from the robot's URDF, for ``GroundClearance``.

    The clearance of a box is that of its 8 corners, and of a sphere that of its lowest point. That of a capsule is
    measured at its two end spheres, and that of a cylinder at the rims of its two ends. This is exact over a plane, and
    over other ground at those points. The clearance of a mesh is that of the 8 corners of its bounding box.

    Parameters
    ----------
    links : str or sequence of str
        Links (frames); by default every link that moves.
    known : tuple of ClearancePoint
        Points of the shapes from a saved file, which replace those of the URDF.
    """

    links: str | Sequence[str] = ()
    known: tuple[ClearancePoint, ...] = field(default=(), compare=False, repr=False)

    def spots(self, robot: Robot) -> list[ClearancePoint]:
        """Read the shapes.

        Raises
        ------
        InputError
            The robot has no shapes, a link carries none or does not move, or a shape is of another kind.
        """
        if self.known:
            return list(self.known)
        wanted = (self.links,) if isinstance(self.links, str) else tuple(self.links)
        for link in wanted:
            robot.frame(link)
        shapes = [(robot.model.frames[s.parentFrame].name, s) for s in robot.collision_model.geometryObjects]
        carriers = list(dict.fromkeys(link for link, shape in shapes if shape.parentJoint > 0))
        absent = [link for link in wanted if link not in carriers] if wanted or carriers else ["any link"]
        if absent:
            raise InputError(
                f"{robot.name} has no collision shape that moves on {absent[0]}. Links that carry one: "
                f"{', '.join(carriers) or 'none'}. Name frames, or points of frames, instead."
            )
        chosen = wanted or carriers
        return [spot for link, shape in shapes if link in chosen for spot in _spots(robot, link, shape)]


PlacesLike: TypeAlias = "str | tuple[str, Triple] | Spot | CollisionShapes | Sequence[PlacesLike]"
"""Frames, points and balls fixed in a frame [m], collision shapes of links, or several of these."""


def _spots(robot: Robot, link: str, shape: pin.GeometryObject) -> list[ClearancePoint]:
    """Points, balls or discs that contain the lowest point of one shape."""
    geometry, kind = shape.geometry, type(shape.geometry).__name__
    placement = robot.model.frames[shape.parentFrame].placement.actInv(shape.placement)
    axis = placement.rotation[:, 2]

    def at(local: ArrayLike, label: str, radius: float = 0.0, disc: bool = False) -> ClearancePoint:
        centre = placement.act(np.asarray(local, dtype=float))
        return ClearancePoint(
            link, f"{shape.name} {label}".strip(), _vector(centre), radius, _vector(axis) if disc else None, shape.name
        )

    if kind == "Sphere":
        return [at(np.zeros(3), "", float(geometry.radius))]
    if kind in ("Capsule", "Cylinder"):
        ends = (("lower end", -geometry.halfLength), ("upper end", geometry.halfLength))
        return [at([0.0, 0.0, z], label, float(geometry.radius), kind == "Cylinder") for label, z in ends]
    if kind == "Box":
        low, high = -np.asarray(geometry.halfSide), np.asarray(geometry.halfSide)
    elif kind.startswith(("BVHModel", "Convex")):
        vertices = np.asarray(geometry.vertices() if kind.startswith("BVHModel") else geometry.points())
        low, high = vertices.min(axis=0), vertices.max(axis=0)
    else:
        raise InputError(
            f"The collision shape {shape.name!r} of {robot.name} is a {kind}; GroundClearance supports boxes, spheres, "
            "capsules, cylinders and meshes. Name points of the frame instead."
        )
    corners = np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij")).reshape(3, -1).T
    return [at(corner, f"corner {k}") for k, corner in enumerate(corners)]


def _vector(values: Triple) -> Vector:
    """Round off errors of placements, so that zeros are exact."""
    x, y, z = (float(v) for v in np.round(values, 12) + 0.0)
    return x, y, z


def spots_of(what: PlacesLike, robot: Robot) -> list[ClearancePoint]:
    """Read frames, points ``(frame, offset)``, CollisionShapes, or a sequence of these.

    Raises
    ------
    InputError
        An entry is none of these, or a frame is unknown.
    """
    if isinstance(what, CollisionShapes):
        return what.spots(robot)
    if isinstance(what, str):
        robot.frame(what)
        return [ClearancePoint(what, what)]
    if isinstance(what, Spot):
        robot.frame(what.frame)
        return [ClearancePoint(what.frame, what.frame, what.offset, what.radius)]
    if _is_point(what):
        frame, offset = what[0], _vector(what[1])
        robot.frame(frame)
        if not np.isfinite(offset).all():
            raise InputError(f"GroundClearance: the point of frame {frame!r} lies at {offset}; give three metres.")
        return [ClearancePoint(frame, f"{frame} ({', '.join(f'{v:g}' for v in offset)})", offset)]
    if not isinstance(what, Sequence):
        raise InputError(
            f"GroundClearance names {what!r}; give frames, points ('frame', (x, y, z)) or "
            f"rt.constraints.CollisionShapes('link')."
        )
    return [spot for entry in cast("Sequence[PlacesLike]", what) for spot in spots_of(entry, robot)]


def with_known_points(what: PlacesLike, robot: Robot) -> PlacesLike:
    """Return the places with the points of every CollisionShapes stored in it."""
    if isinstance(what, CollisionShapes):
        return replace(what, known=tuple(what.spots(robot)))
    if isinstance(what, str) or _is_point(what) or not isinstance(what, Sequence):
        return what
    return [with_known_points(entry, robot) for entry in cast("Sequence[PlacesLike]", what)]


def _is_point(what: object) -> TypeGuard[tuple[str, Vector]]:
    """Whether a value is a frame's name and three numbers."""
    if not isinstance(what, Sequence) or len(what) != 2 or not isinstance(what[0], str) or isinstance(what[1], str):
        return False
    try:
        return np.asarray(what[1], dtype=float).shape == (3,)
    except (TypeError, ValueError):
        return False
