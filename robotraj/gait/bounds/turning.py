"""Bounds on the height and attitude of a root that turns once over."""

from __future__ import annotations

from dataclasses import field

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.gait.bounds.upright import Upright
from robotraj.problem.constraints.bounds import Between, between
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class Turning(Upright):
    """Bounds on height and attitude of a root that turns once about a horizontal axis.

    A turn by the angle s about the unit vector e has the quaternion (sin(s / 2) e, cos(s / 2)). Each entry of its
    vector stays between 0 and that of e, up to sin(tilt / 2). The pitch of a planar root stays between 0 and 2 pi e_y,
    up to the tilt.

    Parameters
    ----------
    axis : (float, float, float)
        e in world axes; the turn is counter-clockwise about it.
    """

    axis: tuple[float, float, float] = field(default=(0.0, -1.0, 0.0), kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        axis = np.asarray(self.axis, dtype=float)
        if axis.shape != (3,) or not np.isfinite(axis).all() or axis[2] or not axis.any():
            raise InputError(
                f"axis= is {self.axis!r}; give a horizontal axis: (0, -1, 0) is a backflip, (0, 1, 0) a frontflip, "
                "(1, 0, 0) and (-1, 0, 0) are side flips."
            )
        object.__setattr__(self, "axis", tuple(float(part) for part in axis / np.linalg.norm(axis)))

    def states(self, robot: Robot) -> dict[str, Between]:
        """Return the bounds by state name, for ``rt.Phase(states=...)``."""
        if robot.root == "planar":
            if self.axis[0]:
                raise InputError(f"{robot.name!r} has root='planar', which turns about y; axis= is {self.axis}.")
            turn = 2.0 * np.pi * self.axis[1]
            return {"q.root_pitch": between(min(turn, 0.0) - self.tilt, max(turn, 0.0) + self.tilt)}
        small = float(np.sin(0.5 * self.tilt))
        return {
            f"q.root_{name}": between(min(part, 0.0) - small, max(part, 0.0) + small)
            for name, part in zip(("qx", "qy", "qz"), self.axis, strict=True)
        }
