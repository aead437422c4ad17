"""Motions without collisions: the robot keeps its distance from obstacles and from itself."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import cast

import numpy as np
import pinocchio as pin

from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError, warn
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import short
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.dynamics.point import RobotPoint
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.problem.constraints.base import BoundConstraint, Constraint, robot_of
from robotraj.problem.scalars import Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class CollisionFree(Constraint):
    """The robot touches neither obstacles nor itself: every distance is at least ``margin``, at every time.

    The robot's collision shapes are spheres of its URDF, or spheres that enclose its other shapes
    (``rt.robot.collision.robot_spheres``); distances from obstacles are exact. Rows are imposed on pairs that come
    near each other. Between the collocation points a bound on the speed of each pair proves the distances, and
    ``solution.proof`` lists unproved pairs. ``rt.validate`` checks the exact shapes with coal.

    Parameters
    ----------
    obstacles : sequence of Obstacle
        ``rt.obstacles.Box((0.2, 0.2, 0.4), position=(0.5, 0, 0.2))``, in the world or on a ``frame`` of the robot.
    margin : float
        Least distance [m]. Links that are nearer to each other in every sampled configuration need not keep it. Those
        around which the spheres are nearer have no rows: they keep apart, and where they come nearer than the margin,
        ``rt.validate`` names them and does not judge the claim on obstacles.
    self_collision : bool
        Whether the distances between the robot's links are bounded too.
    srdf : path or sequence of (str, str), optional
        Pairs of links that are not checked: an SRDF with ``<disable_collisions>``, or names. Links that a joint joins
        or that touch in every sampled configuration are never checked.

    Raises
    ------
    InputError
        An entry is no obstacle, or the margin is negative. On binding: the robot has no collision shapes, or the phase
        moves a System.
    """

    avoids_collisions = True

    obstacles: Sequence[Obstacle] = ()
    margin: float = 0.0
    self_collision: bool = True
    srdf: str | os.PathLike[str] | Sequence[tuple[str, str]] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        given: object = self.obstacles
        obstacles = tuple(given) if isinstance(given, Iterable) else (given,)
        for obstacle in obstacles:
            if not isinstance(obstacle, Obstacle):
                raise InputError(f"CollisionFree: {obstacle!r} is no obstacle such as rt.obstacles.Box((1, 1, 1)).")
        object.__setattr__(self, "obstacles", obstacles)
        margin: object = self.margin
        if not is_finite(margin) or margin < 0.0:
            raise InputError(f"CollisionFree: margin is {short(margin)}; give a distance in metres, 0 or more.")
        if not isinstance(self.self_collision, bool | np.bool_):
            raise InputError(
                f"CollisionFree: self_collision is {short(self.self_collision)}; give True or False. "
                "Pairs of links that may touch go into srdf=."
            )
        if isinstance(self.srdf, str | os.PathLike):
            from robotraj.robot.collision.link_pairs import read_srdf

            object.__setattr__(self, "srdf", read_srdf(self.srdf))
        named: object = () if self.srdf is None else self.srdf
        listed = tuple(named) if isinstance(named, Iterable) else (None,)
        pairs = tuple(tuple(pair) if isinstance(pair, Sequence) else () for pair in listed)
        if not all(len(pair) == 2 and all(isinstance(name, str) for name in pair) for pair in pairs):
            raise InputError(
                f"CollisionFree: srdf= is {self.srdf!r}; give the path of an SRDF, or pairs of names of links."
            )
        object.__setattr__(self, "srdf", pairs)

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Check the robot, and return a constraint without rows; ``pairs`` describes what is bounded.

        Raises
        ------
        InputError
            The phase moves a System, or has a design, which may move the shapes.
        """
        robot = robot_of(dynamics, "CollisionFree")
        if getattr(dynamics, "design", None) is not None:
            raise InputError(
                "CollisionFree cannot be planned with a design, which may move the shapes; fix the design."
            )
        for obstacle in self.obstacles:
            if obstacle.frame is not None:
                robot.frame(obstacle.frame)
        named = [name for pair in disabled_pairs((self,)) for name in pair]
        if named and not any(name in robot.frame_names for name in named):
            links = [frame.name for frame in robot.model.frames if frame.type == pin.FrameType.BODY]
            warn(
                f"CollisionFree: srdf= names no link of {robot.name!r}, so it disables no pair. It names "
                f"{', '.join(dict.fromkeys(named[:4]))}; the links are {', '.join(links[:8])}."
            )
        return BoundConstraint("clearance", (), _nothing)

    @cached_property
    def _known(self) -> dict[Robot, ClearancePairs]:
        return {}

    def pairs(self, robot: Robot) -> ClearancePairs:
        """Return the pairs of shapes whose distances are bounded; they are computed once per robot."""
        if robot not in self._known:
            self._known[robot] = self._pairs(robot)
        return self._known[robot]

    def _pairs(self, robot: Robot) -> ClearancePairs:
        from robotraj.problem.clearance.pairs import clearance_pairs

        return clearance_pairs(robot, self.obstacles, float(self.margin), self.self_collision, self.srdf or ())  # type: ignore[arg-type]


def disabled_pairs(constraints: Iterable[Constraint]) -> tuple[tuple[str, str], ...]:
    """Return the pairs of links that the ``srdf`` of any ``CollisionFree`` disables."""
    free = (each for each in constraints if isinstance(each, CollisionFree))
    return tuple(pair for each in free for pair in cast("Sequence[tuple[str, str]]", each.srdf or ()))


def _nothing(point: RobotPoint) -> list[Scalar]:
    return []
