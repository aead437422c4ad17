"""Moves of a program: of the joints, and of the tool on a straight line or a circular arc."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.checks import is_number
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.problem.constraints.frame_pose import own_pose

if TYPE_CHECKING:
    from robotraj.problem.constraints.frame_pose import PoseLike, Triple

    Target: TypeAlias = "Triple | PoseLike"


@dataclass(frozen=True)
class MoveJ:
    """A straight line of the joints, q = q0 + (q1 - q0) x.

    Parameters
    ----------
    target : array (nq,), pinocchio.SE3, array (4, 4) or (position, rotation)
        q1 [rad, m], or a pose of the tool, for which inverse kinematics searches near q0.
    radius : float
        Radius [m] of the ball around the target within which the path is blended into the next move. With 0 the robot
        stops at the target.
    """

    target: ArrayLike | PoseLike
    radius: float = 0.0

    def __post_init__(self) -> None:
        _check_radius(self)
        object.__setattr__(self, "target", own_pose(self.target))


@dataclass(frozen=True)
class MoveL:
    """A straight line of the tool; its orientation turns about one axis in proportion to the way.

    Parameters
    ----------
    target : sequence of 3, pinocchio.SE3, array (4, 4) or (position, rotation)
        Pose of the tool in the world, or its position [m]; the orientation then stays.
    radius : float
        Of the blend at the target [m]; 0 stops there.
    """

    target: Target
    radius: float = 0.0

    def __post_init__(self) -> None:
        _check_radius(self)
        object.__setattr__(self, "target", own_pose(self.target))


@dataclass(frozen=True)
class MoveC:
    """A circular arc of the tool; its orientation turns about one axis in proportion to the way.

    Parameters
    ----------
    through : sequence of 3
        A point of the arc between its ends [m].
    target : sequence of 3, pinocchio.SE3, array (4, 4) or (position, rotation)
        As for ``MoveL``.
    radius : float
        Of the blend at the target [m]; 0 stops there.
    """

    through: Triple
    target: Target
    radius: float = 0.0

    def __post_init__(self) -> None:
        _check_radius(self)
        object.__setattr__(self, "target", own_pose(self.target))


Move: TypeAlias = "MoveJ | MoveL | MoveC"
"""A part of a program up to a target."""


def _check_radius(move: Move) -> None:
    if not (is_number(move.radius) and 0.0 <= move.radius < np.inf):
        raise InputError(f"The radius of {type(move).__name__} must be a length of 0 or more [m]; got {move.radius!r}.")
