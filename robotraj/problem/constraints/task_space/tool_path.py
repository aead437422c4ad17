"""Straight and circular paths of the origin of a frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.row import Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.constraints.task_space.axis import dot, perpendicular, unit_vector
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class LinearPath(Constraint):
    """The origin of a frame stays on the straight segment between two points.

    Two equations across the line are held at every knot with their rates. Along its direction d,
    0 <= d' (p_f - first) <= abs(last - first). For a fixed rotation, add
    ``rt.FramePose(frame, ((None, None, None), rotation))``.

    Parameters
    ----------
    frame : str
    first, last : sequence of 3 float
        Ends of the line in the world [m].
    """

    frame: str
    first: Sequence[float]
    last: Sequence[float]

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write two rows across the line and one along it."""
        robot_of(dynamics, "LinearPath").frame(self.frame)
        frame, start = self.frame, np.array(self.first, dtype=float)
        line = np.array(self.last, dtype=float) - start
        along = unit_vector(line.tolist(), f"LinearPath of {frame!r}")
        across = perpendicular(along)
        rows = [Row(f"linear path {name}", "m", 0.0, 0.0, frame) for name in ("across", "across too")]
        rows.append(Row("linear path along", "m", 0.0, float(np.linalg.norm(line)), frame))

        def expression(point: RobotPoint) -> list[Scalar]:
            position = point.frame(frame).position
            moved = [position[i] - float(start[i]) for i in range(3)]
            return [dot(direction, moved) for direction in (*across, along)]

        return BoundConstraint("linear path", tuple(rows), expression)


@dataclass(frozen=True)
class CircularPath(Constraint):
    """The origin of a frame stays on a circle: n' (p_f - c) = 0 and (|p_f - c|^2 - r^2) / (2 r) = 0.

    Both equations are imposed with their rates at every knot. The ends of the phase determine the arc.

    Parameters
    ----------
    frame : str
    centre : sequence of 3 float
        c in the world [m].
    normal : sequence of 3 float
        n, of any length.
    radius : float
        r [m].
    """

    frame: str
    centre: Sequence[float]
    normal: Sequence[float]
    radius: float

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row of the plane and one of the radius."""
        robot_of(dynamics, "CircularPath").frame(self.frame)
        frame, centre = self.frame, np.array(self.centre, dtype=float)
        if centre.shape != (3,) or not 0.0 < self.radius < np.inf:
            raise InputError(f"CircularPath of {frame!r} needs a centre (3,) and a radius above 0 m.")
        normal, radius = unit_vector(self.normal, f"CircularPath of {frame!r}"), float(self.radius)
        rows = tuple(Row(f"circular path {name}", "m", 0.0, 0.0, frame) for name in ("plane", "radius"))

        def expression(point: RobotPoint) -> list[Scalar]:
            position = point.frame(frame).position
            moved = [position[i] - float(centre[i]) for i in range(3)]
            return [dot(normal, moved), (sum(m * m for m in moved) - radius**2) / (2.0 * radius)]

        return BoundConstraint("circular path", rows, expression)
