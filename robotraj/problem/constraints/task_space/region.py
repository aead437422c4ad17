"""Sets of poses: a box of positions in the axes of a pose, a free rotation about an axis, a cone of rotations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.errors import InputError, warn
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.row import Angle, Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.constraints.bounds import BoundsLike, as_bounds
from robotraj.problem.constraints.frame_pose import AXES, PoseLike, as_pose, check_metres, own_pose
from robotraj.problem.constraints.task_space.axis import dot, perpendicular, turned, unit_vector
from robotraj.problem.scalars import Scalar
from robotraj.robot.loading.other_units import in_other_unit, seems_other
from robotraj.robot.size.reach import reach


@dataclass(frozen=True)
class PoseRegion(Constraint):
    """A frame inside a set of poses around a pose (p, R).

    Position: lower <= R' (p_f - p) <= upper, a box in the axes of the pose. Rotation with ``free_axis`` e: the angle
    between R_f e and R e is at most ``angle``, and the frame turns freely about e. Rotation without it: the angle of
    the rotation from R to R_f is at most ``angle``, trace(R' R_f) >= 1 + 2 cos(angle).

    Wrap in ``rt.AtEnd`` for a goal with tolerances.

    Parameters
    ----------
    frame : str
    pose : pinocchio.SE3 or (position, rotation)
        As for ``rt.FramePose``.
    position : number, Between, sequence of 3 or mapping
        Displacements in the axes of the pose [m]: numbers fix, ``rt.between`` bounds, None leaves free.
    free_axis : sequence of 3 float, optional
        e, with the same components in the axes of the frame and of the pose.
    angle : float
        Largest angle [rad], from 0 to below pi.
    """

    frame: str
    pose: PoseLike
    position: BoundsLike = 0.0
    free_axis: Sequence[float] | None = None
    angle: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "pose", own_pose(self.pose))

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write a row for each bounded displacement, and those of the rotation.

        Raises
        ------
        InputError
            The phase has no robot or no such frame, the pose is invalid, or the angle is out of range.
        """
        robot = robot_of(dynamics, "PoseRegion")
        robot.frame(self.frame)
        frame, what = self.frame, f"region of frame {self.frame!r}"
        place, rotation = as_pose(self.pose, what)
        origin = np.array(place, dtype=float)
        lower, upper = as_bounds(self.position, AXES, what, "axis")
        kept = [i for i in range(3) if np.isfinite(lower[i]) or np.isfinite(upper[i])]
        if not 0.0 <= self.angle < np.pi:
            raise InputError(
                f"The {what} has the angle {self.angle} rad; it lies from 0 to below pi. "
                f"{in_other_unit(self.angle, 'rad')}"
            )
        check_metres(robot, origin, origin, what)
        extent = np.minimum(-lower, upper)
        far = reach(robot.model)
        if any(seems_other(float(side), far, "m") for side in extent):
            side = float(np.max(extent[np.isfinite(extent)]))
            warn(
                f"The {what} reaches {side:g} m to all sides of its pose, and {robot.name!r} {far:.2g} m. "
                f"{in_other_unit(side, 'm')}"
            )
        rows = [Row(f"region position {AXES[i]}", "m", lower[i], upper[i], frame) for i in kept]
        exact, limit = np.cos(self.angle) == 1.0, self.angle
        axis = None if self.free_axis is None else unit_vector(self.free_axis, what)
        if not exact:
            rows.append(Row("region angle", "", -np.inf, 1.0, frame, measure=Angle(limit)))
        else:
            names = AXES if axis is None else AXES[:2]
            rows += [Row(f"region rotation {name}", "rad", 0.0, 0.0, frame) for name in names]
            least = 0.0 if axis is not None else 1.0
            rows.append(Row("region half turn", "", least, np.inf, frame, selects_root=True))
        across = None if axis is None else perpendicular(rotation @ axis)

        def expression(point: RobotPoint) -> list[Scalar]:
            view = point.frame(frame)
            moved = [view.position[i] - float(origin[i]) for i in range(3)]
            values = [dot(rotation[:, i], moved) for i in kept]
            if axis is not None and across is not None:
                pointing = turned(view.rotation, axis)
                along = dot(rotation @ axis, pointing)
                if not exact:
                    return [*values, Angle(limit).row(along)]
                return [*values, *(dot(direction, pointing) for direction in across), along]
            error = rotation.T @ view.rotation
            trace = error[0, 0] + error[1, 1] + error[2, 2]
            if not exact:
                return [*values, Angle(limit).row(0.5 * (trace - 1.0))]
            skew = [error[2, 1] - error[1, 2], error[0, 2] - error[2, 0], error[1, 0] - error[0, 1]]
            return [*values, *(0.5 * s for s in skew), trace]

        return BoundConstraint("pose region", tuple(rows), expression)
