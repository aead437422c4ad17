"""Cost of transport: the ratio of work to weight times distance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.variable import Variable
from robotraj.problem.augmentation import RunningIntegral, body_of, has
from robotraj.problem.constraints.base import BoundConstraint, robot_of
from robotraj.problem.objectives.base import EndCost, Integral
from robotraj.problem.objectives.work import MechanicalWork
from robotraj.problem.scalars import Scalar


@dataclass(frozen=True)
class CostOfTransport(EndCost):
    """Work over weight and distance, W / (m g d), without unit.

    W is the work done in the phase, a further state with Wdot = its rate and W = 0 at the start. m is the mass of all
    moving links. d is the displacement from start to end along a direction. Bound d from below by a start and an end,
    or by a constraint, since the ratio has no minimum around d = 0.

    Source: Gabrielli and von Karman, Mechanical Engineering 72 (1950); Collins et al., Science 307 (2005).

    Parameters
    ----------
    frame : str, optional
        Frame whose displacement counts, such as that of the base; by default the centre of mass.
    direction : sequence of 3 float
        Direction in the world, of any length; x by default.
    work : Integral
        ``rt.objectives.MechanicalWork()``, positive work, by default; or any other integral in J.
    """

    frame: str | None = None
    direction: Sequence[float] = (1.0, 0.0, 0.0)
    work: Integral = field(default_factory=MechanicalWork)

    def value(self, start: RobotPoint, end: RobotPoint) -> Scalar:
        """W / (m g d)."""
        weight = end.mass * float(np.linalg.norm(end.robot.model.gravity.linear))
        direction = np.asarray(self.direction, dtype=float) / np.linalg.norm(self.direction)
        before, after = (p.com if self.frame is None else p.frame(self.frame).position for p in (start, end))
        distance = sum(float(e) * (after[i] - before[i]) for i, e in enumerate(direction) if e)
        return end.extra["work"] / (weight * distance)

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check frame, direction, weight and work."""
        robot = robot_of(dynamics, "CostOfTransport")
        if self.frame is not None:
            robot.frame(self.frame)
        direction = np.asarray(self.direction, dtype=float)
        if direction.shape != (3,) or not np.all(np.isfinite(direction)) or not np.any(direction):
            raise InputError(f"CostOfTransport: direction is {self.direction!r}; it must be a vector of 3 numbers.")
        if not np.any(robot.model.gravity.linear):
            raise InputError(
                "CostOfTransport needs gravity, but that of the robot's model is zero; load it with gravity=."
            )
        if not isinstance(self.work, Integral):
            raise InputError(
                f"CostOfTransport: work is {self.work!r}; give an integral such as rt.objectives.AbsolutePower()."
            )
        self.work.check(dynamics, parameters)

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the state W, and the variables of the work."""
        if has(dynamics, ["work"]):
            raise InputError("The objective has two CostOfTransport terms; keep one.")
        return RunningIntegral(self.work.augment(dynamics), Variable("work", "J", "work"), self.work.rate)

    def definitions(self, dynamics: Dynamics) -> tuple[BoundConstraint, ...]:
        """Rows of the work's own variables."""
        return self.work.definitions(body_of(dynamics))
