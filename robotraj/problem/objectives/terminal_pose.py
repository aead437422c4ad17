"""Cost of the distance of a frame from a pose at the end of a phase."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError
from robotraj._util.printing import short
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.constraints.base import robot_of
from robotraj.problem.constraints.frame_pose import PoseLike, Triple, as_pose, own_pose
from robotraj.problem.objectives.base import EndCost
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class TerminalPose(EndCost):
    """Distance of a frame from a pose at the end of the phase.

        w_p |p - p*|^2 + w_R (3 - trace(R*' R)),    3 - trace(R*' R) = 2 (1 - cos angle),

    smooth everywhere, and near angle^2 for small angles.

    Parameters
    ----------
    frame : str
    pose : sequence of 3 float, pinocchio.SE3 or (position, rotation)
        A position p* in the world [m] alone, or with R* from frame to world as a matrix (3, 3), a
        ``pinocchio.Quaternion`` or a quaternion (x, y, z, w).
    position_weight, rotation_weight : float
        w_p [1/m^2], w_R.
    """

    frame: str
    pose: Triple | PoseLike
    position_weight: float = 1.0
    rotation_weight: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "pose", own_pose(self.pose))

    def value(self, start: RobotPoint, end: RobotPoint) -> Scalar:
        """Weighted squared distance."""
        view = end.frame(self.frame)
        position, rotation = target_of(self.pose, self._what)
        gap: Scalar = sum((view.position[i] - float(position[i])) ** 2 for i in range(3))
        if rotation is None:
            return self.position_weight * gap
        trace = sum(float(rotation[i, j]) * view.rotation[i, j] for i in range(3) for j in range(3))
        return self.position_weight * gap + self.rotation_weight * (3.0 - trace)

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check frame, pose and weights."""
        robot_of(dynamics, "TerminalPose").frame(self.frame)
        target_of(self.pose, self._what)
        for weight in (self.position_weight, self.rotation_weight):
            if not is_finite(weight) or weight < 0:
                raise InputError(f"{self._what}: a weight is {short(weight)}; it must be finite and not negative.")

    @property
    def _what(self) -> str:
        return f"terminal pose of frame {self.frame!r}"


def target_of(value: Triple | PoseLike, what: str) -> tuple[np.ndarray, np.ndarray | None]:
    """Position (3,) and rotation (3, 3) of a pose, or a position and None.

    Raises
    ------
    InputError
        The value is neither three numbers nor a pose.
    """
    placed = hasattr(value, "rotation") or not hasattr(value, "__len__") or len(value) != 3
    position, rotation = as_pose(value, what) if placed else (value, None)
    try:
        place = np.asarray(position, dtype=float)
    except (TypeError, ValueError, OverflowError):
        place = np.empty(0)
    if place.shape != (3,) or not np.all(np.isfinite(place)):
        raise InputError(f"The position of the {what} must be three finite numbers; got {position!r}.")
    return place, rotation
