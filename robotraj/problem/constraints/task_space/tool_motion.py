"""Limits on the speed and the acceleration of a frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.row import Magnitude, Row
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class FrameMotionLimit(Constraint):
    """Bounds on the magnitudes of a linear and an angular vector w of a frame: |w|^2 / limit^2 <= 1.

    Parameters
    ----------
    frame : str
    linear, angular : float, optional
        Largest magnitudes; None leaves one free.
    """

    frame: str
    linear: float | None = None
    angular: float | None = None

    vector: ClassVar[str]
    quantity: ClassVar[str]
    units: ClassVar[dict[str, str]]

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each limit.

        Raises
        ------
        InputError
            The phase has no robot or no such frame, or a limit is missing or not above 0.
        """
        robot_of(dynamics, type(self).__name__).frame(self.frame)
        both = (("linear", self.linear), ("angular", self.angular))
        given = [(kind, limit) for kind, limit in both if limit is not None]
        if not given or not all(0.0 < limit < np.inf for _, limit in given):
            raise InputError(
                f"{type(self).__name__} of {self.frame!r} needs linear= or angular= above 0; got {self.linear!r} and "
                f"{self.angular!r}."
            )
        frame, vector = self.frame, self.vector
        rows = tuple(
            Row(f"{kind} {self.quantity}", "", -np.inf, 1.0, frame, measure=Magnitude(limit, self.units[kind]))
            for kind, limit in given
        )

        def expression(point: RobotPoint) -> list[Scalar]:
            values = getattr(point.frame(frame), vector)
            parts = {"linear": range(3), "angular": range(3, 6)}
            return [sum(values[i] ** 2 for i in parts[kind]) / limit**2 for kind, limit in given]

        return BoundConstraint(f"frame {self.quantity}", rows, expression)


@dataclass(frozen=True)
class FrameSpeed(FrameMotionLimit):
    """Largest speed [m/s] and angular speed [rad/s] of a frame, at every time."""

    vector: ClassVar[str] = "velocity"
    quantity: ClassVar[str] = "speed"
    units: ClassVar[dict[str, str]] = {"linear": "m/s", "angular": "rad/s"}


@dataclass(frozen=True)
class FrameAcceleration(FrameMotionLimit):
    """Largest acceleration [m/s^2] and angular acceleration [rad/s^2] of a frame."""

    vector: ClassVar[str] = "acceleration"
    quantity: ClassVar[str] = "acceleration"
    units: ClassVar[dict[str, str]] = {"linear": "m/s^2", "angular": "rad/s^2"}
