"""An axis of a frame that keeps a direction, exactly or within an angle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.row import Angle, Row
from robotraj.dynamics.variable import Column
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.scalars import Scalar
from robotraj.robot.loading.other_units import in_other_unit


@dataclass(frozen=True)
class FrameAxis(Constraint):
    """An axis e of a frame keeps within an angle of a direction d of the world: (R_f e)' d >= cos(angle).

    The row is sqrt((1 + x) / 2) <= 1 with x = (1 - (R_f e)' d) / (1 - cos(angle)). With angle 0 the two components of
    R_f e across d are 0. Those rows are held with their rates, as ``PathConstraint`` describes, and the frame turns
    freely about the axis.

    Parameters
    ----------
    frame : str
    axis : sequence of 3 float
        e in the axes of the frame, of any length.
    direction : sequence of 3 float
        d in the world, of any length; upwards by default.
    angle : float
        Largest angle between both [rad], from 0 to below pi.
    """

    frame: str
    axis: Sequence[float] = (0.0, 0.0, 1.0)
    direction: Sequence[float] = (0.0, 0.0, 1.0)
    angle: float = 0.0

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row of the angle, or three rows of the exact direction.

        Raises
        ------
        InputError
            The phase has no robot or no such frame, a vector has length 0, or the angle is out of range.
        """
        robot_of(dynamics, "FrameAxis").frame(self.frame)
        axis, wanted = (unit_vector(v, f"FrameAxis of {self.frame!r}") for v in (self.axis, self.direction))
        if not 0.0 <= self.angle < np.pi:
            raise InputError(
                f"FrameAxis of {self.frame!r}: the angle is {self.angle} rad; it lies from 0 to below pi. "
                f"{in_other_unit(self.angle, 'rad')}"
            )
        frame, limit = self.frame, self.angle
        exact = np.cos(limit) == 1.0
        if exact:
            across = perpendicular(wanted)
            rows = [Row(f"frame axis {name}", "rad", 0.0, 0.0, frame) for name in ("across", "across too")]
            rows.append(Row("frame axis half turn", "", 0.0, np.inf, frame, selects_root=True))
        else:
            rows = [Row("frame axis angle", "", -np.inf, 1.0, frame, measure=Angle(limit))]

        def expression(point: RobotPoint) -> list[Scalar]:
            pointing = turned(point.frame(frame).rotation, axis)
            along = dot(wanted, pointing)
            if not exact:
                return [Angle(limit).row(along)]
            return [*(dot(direction, pointing) for direction in across), along]

        return BoundConstraint("frame axis", tuple(rows), expression)


def unit_vector(value: Sequence[float], what: str) -> Array:
    """Return a vector (3,) divided by its length.

    Raises
    ------
    InputError
        The vector has another shape, length 0, or numbers that are not finite.
    """
    array = np.array(value, dtype=float)
    length = float(np.linalg.norm(array)) if array.shape == (3,) else np.nan
    if not 0.0 < length < np.inf:
        raise InputError(f"{what}: a direction has three finite entries that are not all 0; got {value!r}.")
    return np.asarray(array / length)


def perpendicular(direction: Array) -> Array:
    """Return two unit vectors (2, 3) that are perpendicular to a unit vector and to each other."""
    least = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(direction, least)
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(direction, first)])


def dot(numbers: Array, values: Column | Sequence[Scalar]) -> Scalar:
    """Return the sum of the products of three numbers and three values, symbolic or numeric."""
    return sum(float(n) * values[i] for i, n in enumerate(numbers) if n != 0.0)


def turned(rotation: Column, axis: Array) -> list[Scalar]:
    """Return R e (3,) for a rotation matrix (3, 3), symbolic or numeric."""
    return [sum(rotation[i, j] * float(e) for j, e in enumerate(axis) if e != 0.0) for i in range(3)]
