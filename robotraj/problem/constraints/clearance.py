"""Frames, points and shapes that keep a height above the ground."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace
from typing import cast

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.point_on_frame import Spot
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.row import Row
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction, as_ground
from robotraj.problem.clearance.sole_edges import edge_places
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of, symbols_of
from robotraj.problem.constraints.clearance_geometry import PlacesLike, spots_of, with_known_points
from robotraj.problem.constraints.heights import HeightLike, RequiredHeight, required_height
from robotraj.problem.scalars import Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class GroundClearance(Constraint):
    """Vertical clearance of places on the robot: z_p(q) - h(x_p, y_p) >= height.

    The rows apply at every collocation point; violations between these are searched for. Over uneven ground a constant
    height also applies along the edges between points of one frame or shape. It applies there at the ``noses`` of the
    ground, or at evenly spaced places if it has none.

    Parameters
    ----------
    frames : str, (str, offset), Spot, CollisionShapes, or sequence of these
        Frames, whose origins keep the clearance; points ``("foot", (0.1, 0, -0.02))`` fixed in a frame [m]; or
        ``rt.constraints.CollisionShapes("foot")``, the shapes of a link in the URDF.
    height : float, RequiredHeight, callable or None
        Clearance [m]; ``rt.constraints.SwingApex(0.05, start, end)`` over the way of a swing foot; or a
        function of the point. None imposes no row, and lets feet that swing pass through the ground, as those of
        walkers without knees do.
    ground : Ground or callable
        ``rt.terrain.Flat()`` (the default), ``rt.terrain.Slope``, ``rt.terrain.Steps``,
        ``rt.terrain.HeightMap`` or any function of (x, y) written with CasADi; ``rt.terrain.Plane`` keeps places off a
        wall.
    """

    frames: PlacesLike
    height: HeightLike | None = 0.0
    ground: Ground | GroundFunction = field(default_factory=Flat)

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each place, or as many as there are heights to reach.

        Raises
        ------
        InputError
            No place is named, a frame or parameter is unknown, or the height or ground is invalid.
        """
        spots = spots_of(self.frames, robot_of(dynamics, "GroundClearance"))
        if not spots:
            raise InputError("GroundClearance names no frame; name at least one in frames=.")
        ground = as_ground(self.ground)
        labels = [spot.label for spot in spots]
        if self.height is None:
            return BoundConstraint("ground clearance", (), lambda _: [])
        height = required_height(self.height, f"GroundClearance of {', '.join(labels[:3])}")

        def gaps(point: RobotPoint) -> list[tuple[Scalar, list[Scalar]]]:
            places = [spot.position(point) for spot in spots]
            return [(spot.gap(point, place, ground), place) for spot, place in zip(spots, places, strict=True)]

        if not isinstance(height, RequiredHeight):
            edges = edge_places(spots, ground)
            labels += [edge.label for edge in edges]
            rows = tuple(Row("ground clearance", "m", height, np.inf, label) for label in labels)

            def clear(point: RobotPoint) -> list[Scalar]:
                return [*(gap for gap, _ in gaps(point)), *(edge.gap(point, ground) for edge in edges)]

            return BoundConstraint("ground clearance", rows, clear)

        def expression(point: RobotPoint) -> list[Scalar]:
            return [gap - h for gap, place in gaps(point) for h in height.heights(point, place).values()]

        point = cast("RobotPoint", symbols_of(dynamics, parameters))
        names = [list(height.heights(point, spot.position(point))) for spot in spots]
        rows = tuple(
            Row(name, "m", 0.0, np.inf, label) for label, of_spot in zip(labels, names, strict=True) for name in of_spot
        )
        return BoundConstraint("ground clearance", rows, expression)

    def covers(self, robot: Robot, place: Spot) -> bool:
        """Return whether a point or ball of a frame is among the places."""
        wanted = np.array([*place.offset, place.radius])
        return any(
            spot.frame == place.frame and np.allclose([*spot.offset, spot.radius], wanted, rtol=0.0, atol=1e-9)
            for spot in spots_of(self.frames, robot)
        )

    def as_data(self, robot: Robot | None) -> Constraint:
        """Return the constraint with the points of its CollisionShapes."""
        return self if robot is None else replace(self, frames=with_known_points(self.frames, robot))
