"""Integral of squared accelerations of frames, for smooth motions of feet and hands."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.constraints.base import robot_of
from robotraj.problem.objectives.base import Integral
from robotraj.problem.objectives.weights import WeightsLike, weights_of
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class FrameSmoothness(Integral):
    """Integral over the phase of sum_F w_F |d^2 p_F/dt^2|^2, p_F the position of frame F [m^2/s^3].

    Parameters
    ----------
    frames : str or sequence of str
        Frames such as the swinging feet.
    weights : None, sequence or mapping by frame
        Weight of each frame, 1 by default.
    """

    frames: str | Sequence[str]
    weights: WeightsLike = None

    @property
    def _names(self) -> list[str]:
        return [self.frames] if isinstance(self.frames, str) else list(self.frames)

    def rate(self, point: RobotPoint) -> Scalar:
        """Weighted sum of squared accelerations."""
        weighed = zip(self._names, weights_of(self.weights, self._names, "FrameSmoothness"), strict=True)
        accelerations = [(w, point.frame(name).acceleration) for name, w in weighed if w]
        return sum((w * a[i] ** 2 for w, a in accelerations for i in range(3)), 0.0)

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check the frames and the weights."""
        robot = robot_of(dynamics, "FrameSmoothness")
        if not self._names:
            raise InputError("FrameSmoothness names no frame; name at least one in frames=.")
        for name in self._names:
            robot.frame(name)
        weights_of(self.weights, self._names, "FrameSmoothness")
