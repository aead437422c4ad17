"""Frames that keep a height above the ground."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from robotraj.constraints.base import BoundConstraint, Constraint, Row, robot_of
from robotraj.errors import InputError
from robotraj.terrain import Flat, Ground, as_ground

if TYPE_CHECKING:
    from robotraj.dynamics.dae import Dynamics


@dataclass(frozen=True)
class GroundClearance(Constraint):
    """Vertical clearance of frames: z_f(q) - h(x_f, y_f) >= height.

    Parameters
    ----------
    frames : str or sequence of str
        Frames whose origins are kept clear.
    height : float
        Clearance [m].
    ground : Ground or callable
        ``rt.Flat()`` (the default), ``rt.Slope(...)`` or any function of (x, y) written with CasADi.
    """

    frames: str | Sequence[str]
    height: float = 0.0
    ground: Ground | Any = field(default_factory=Flat)

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Write one row for each frame."""
        robot = robot_of(dynamics, "GroundClearance")
        names = (self.frames,) if isinstance(self.frames, str) else tuple(self.frames)
        if not names:
            raise InputError("GroundClearance names no frame.")
        for name in names:
            robot.frame(name)
        if not np.isfinite(self.height):
            raise InputError(f"GroundClearance of {', '.join(names)}: the height is {self.height}; give metres.")
        ground = as_ground(self.ground)

        def expression(point: Any) -> list[Any]:
            positions = [point.frame(name).position for name in names]
            return [p[2] - ground.height(p[0], p[1]) for p in positions]

        rows = tuple(Row("ground clearance", "m", float(self.height), np.inf, name) for name in names)
        return BoundConstraint("ground clearance", rows, expression)
