"""A thruster: a force of free size along an axis that turns with a frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.applied_forces.external_force import Unheld
from robotraj.dynamics.contacts.base import (
    BoundContact,
    Contact,
    Wrench,
    checked_name,
    force_variables,
    keep,
    label_of,
)
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class Thruster(Contact):
    """A force along an axis of a frame, whose size is a control: a propeller, a jet.

    It stands among the contacts of a phase and holds nothing. ``point.forces[name]`` is its force (3,) in world axes
    [N], and ``solution.at(t).forces`` the planned one.

    Parameters
    ----------
    frame : str
        The frame at whose origin it pushes.
    direction : (3,)
        Direction of the force on the robot, in the frame's axes.
    limits : (float, float)
        Least and greatest thrust [N].
    spin : float
        Moment about the direction per thrust [m]: that of a propeller's drag.
    name : str, optional
        The frame's name by default.

    Raises
    ------
    InputError
        The direction is no vector above 0, the limits are not in order, or the spin is not finite.

    Notes
    -----
    With the unit axis d in world axes and the thrust f the force is f d and the moment ``spin`` f d.
    """

    frame: str
    direction: tuple[float, float, float] = (0.0, 0.0, 1.0)
    limits: tuple[float, float] = (0.0, np.inf)
    spin: float = 0.0
    name: str | None = None
    ground = None

    def __post_init__(self) -> None:
        checked_name(self.name, "rt.Thruster")
        axis, ends = (np.asarray(value, dtype=float) for value in (self.direction, self.limits))
        if axis.shape != (3,) or not np.isfinite(axis).all() or not np.linalg.norm(axis) > 0.0:
            raise InputError(f"The direction of {self.label!r} is {self.direction!r}; give three numbers.")
        if ends.shape != (2,) or not ends[0] < ends[1]:
            raise InputError(f"The limits of {self.label!r} are {self.limits!r}; give (least, greatest) [N].")
        if not np.isfinite(self.spin):
            raise InputError(f"The spin of {self.label!r} is {self.spin!r}; give a length [m].")
        unit = axis / np.linalg.norm(axis)
        keep(self, direction=tuple(unit.tolist()), limits=tuple(ends.tolist()), spin=float(self.spin))

    @property
    def label(self) -> str:
        """Name of the thruster."""
        return label_of(self.name, self.frame)

    def bind(self, robot: Robot) -> BoundContact:
        """Return the force's world components, which lie along the axis within the limits."""
        robot.frame(self.frame)
        name = self.label
        rows = (
            Row("thrust", "N", *self.limits, name),
            Row("force across the thruster's axis", "N", 0.0, 0.0, name),
            Row("force across the thruster's axis", "N", 0.0, 0.0, name),
        )
        return BoundThruster(self, name, self.frame, force_variables(name, [0, 1, 2]), (), (), rows, ())


@dataclass(frozen=True, eq=False)
class BoundThruster(Unheld):
    """The thruster of one robot."""

    contact: Thruster

    def wrench(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Wrench]:
        """Force, and the moment of a propeller, at the frame's origin in world axes."""
        return [(self.frame, [*forces, *(self.contact.spin * each for each in forces)])]

    def vector(self, forces: Sequence[Scalar]) -> list[Scalar]:
        """Force in world axes [N]."""
        return list(forces)

    def limits(self, point: FramePoint, forces: Sequence[Scalar], anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Components along the axis and across it [N]."""
        turn = point.frame(self.frame).rotation
        # The axis and two normals to it, in the frame's axes.
        basis = np.linalg.svd(np.array([self.contact.direction]))[2]
        axes = [np.array(self.contact.direction), basis[1], basis[2]]
        world = [[sum(turn[i, k] * float(axis[k]) for k in range(3)) for i in range(3)] for axis in axes]
        return [sum(part * force for part, force in zip(axis, forces, strict=True)) for axis in world]
