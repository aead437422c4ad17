"""A closed kinematic loop: two frames in different branches of the URDF's tree coincide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import (
    BoundContact,
    Contact,
    Wrench,
    checked_name,
    force_variables,
    held_rows,
    keep,
    spread,
)
from robotraj.dynamics.contacts.mobility import mobility, require_rank
from robotraj.dynamics.contacts.point_on_frame import Spot, Triple, offset_of
from robotraj.dynamics.contacts.vectors import add, cross, scale, subtract
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.variable import Scalar

if TYPE_CHECKING:
    from robotraj.robot.robot import Robot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LoopClosure(Contact):
    """Two points fixed in frames coincide (three rows); optionally the frames' axes coincide too (six rows).

    World axes along or about which the frames cannot move relative to each other have no rows and no forces. A
    linkage in a plane therefore has two rows. The rows of orientation are half the sum over the axes of b_i x a_i, the
    rotation from b to a to first order. Where they are zero, their time derivative is the difference of the angular
    velocities. The force and moment act at the point on a's body, and their opposites on b's.

    Parameters
    ----------
    frame_a, frame_b : str
        One may be ``"universe"``, the world.
    rigid : bool
        Whether the frames' axes coincide too.
    name : str, optional
        ``"<frame_a>-<frame_b>"`` where none is given.
    offset_a, offset_b : sequence of 3 float
        The points in the frames' axes [m].

    Raises
    ------
    InputError
        The frames are the same. On binding: a frame does not exist, or the relative motion does not span the rows.
    """

    frame_a: str
    frame_b: str
    rigid: bool = False
    name: str | None = None
    offset_a: Triple = (0.0, 0.0, 0.0)
    offset_b: Triple = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        what = f"LoopClosure {self.label!r}"
        checked_name(self.name, what)
        keep(self, offset_a=offset_of(self.offset_a, what), offset_b=offset_of(self.offset_b, what))
        if self.frame_a == self.frame_b:
            raise InputError(f"LoopClosure joins frame {self.frame_a!r} to itself; give two frames.")

    @property
    def label(self) -> str:
        """Name of the contact."""
        return f"{self.frame_a}-{self.frame_b}" if self.name is None else self.name

    def bind(self, robot: Robot) -> BoundLoopClosure:
        """Find the axes in which the frames move relative to each other."""
        ends = Spot(self.frame_a, self.offset_a), Spot(self.frame_b, self.offset_b)
        for end in ends:
            robot.frame(end.frame)

        def relative(q: Array) -> Array:
            return ends[0].jacobian(robot, q) - ends[1].jacobian(robot, q)

        if len({robot.model.frames[robot.frame(end.frame)].parentJoint for end in ends}) == 1:
            raise InputError(
                f"Frames {self.frame_a!r} and {self.frame_b!r} of {robot.name!r} are fixed to one body: there is no "
                "loop to close. Name frames of two bodies."
            )
        axes, about = mobility(robot, relative)
        about = about if self.rigid else ()
        if not axes and not about:
            raise InputError(
                f"Frames {self.frame_a!r} and {self.frame_b!r} of {robot.name!r} do not move relative to each other: "
                "there is no loop to close. Remove the contact."
            )
        rows = [*axes, *(3 + i for i in about)]
        require_rank(robot, lambda q: relative(q)[rows], len(rows), f"LoopClosure {self.label!r}")
        forces, holds = force_variables(self.label, axes, about), held_rows(self.label, axes, about, "rz")
        return BoundLoopClosure(self, self.label, self.frame_a, forces, (), holds, (), (), *ends, axes, about)


@dataclass(frozen=True, eq=False)
class BoundLoopClosure(BoundContact):
    """Two spots held together by a wrench between them."""

    first: Spot
    second: Spot
    axes: tuple[int, ...]
    about: tuple[int, ...]

    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Displacement from b to a [m], then the rotation from b to a [rad near zero]."""
        gap = subtract(self.first.position(point), self.second.position(point))
        return self._held(gap, self._rotation(point) if self.about else [])

    def velocity(self, point: FramePoint) -> list[Scalar]:
        """Velocity of a minus that of b [m/s, rad/s]."""
        gap = subtract(self.first.velocity(point), self.second.velocity(point))
        return self._held(gap, subtract(self.first.angular_velocity(point), self.second.angular_velocity(point)))

    def acceleration(self, point: FramePoint) -> list[Scalar]:
        """Acceleration of a minus that of b [m/s^2, rad/s^2]."""
        gap = subtract(self.first.acceleration(point), self.second.acceleration(point))
        turn = subtract(self.first.angular_acceleration(point), self.second.angular_acceleration(point))
        return self._held(gap, turn)

    def wrench(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Wrench]:
        """Wrench on a and its opposite on b, each at its own frame's origin."""
        values = self._spread(forces)
        back = [-1.0 * value for value in values]
        return [
            (self.first.frame, self.first.wrench(point, values[:3], values[3:])),
            (self.second.frame, self.second.wrench(point, back[:3], back[3:])),
        ]

    def vector(self, forces: Sequence[Scalar]) -> list[Scalar]:
        """Force on a's body (3) [N]; with its moment (6) [N, N m] where the axes coincide too."""
        return self._spread(forces)[: 6 if self.about else 3]

    def _rotation(self, point: FramePoint) -> list[Scalar]:
        """Rotation from b to a in world axes, to first order (3) [rad]."""
        a, b = point.frame(self.first.frame).rotation, point.frame(self.second.frame).rotation
        turns = [cross([b[j, i] for j in range(3)], [a[j, i] for j in range(3)]) for i in range(3)]
        return scale(0.5, add(*turns))

    def _spread(self, forces: Sequence[Scalar]) -> list[Scalar]:
        values, count = [forces[i] for i in range(len(self.forces))], len(self.axes)
        return spread(values[:count], self.axes) + spread(values[count:], self.about)

    def _held(self, linear: Sequence[Scalar], angular: Sequence[Scalar]) -> list[Scalar]:
        return [linear[i] for i in self.axes] + [angular[i] for i in self.about]
