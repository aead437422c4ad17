"""A closed kinematic loop: two frames in different branches of the URDF's tree coincide."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
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
from robotraj.robot.configuration import UNIT
from robotraj.robot.robot import Robot

Quaternion: TypeAlias = tuple[float, float, float, float]

UNTURNED: Quaternion = (0.0, 0.0, 0.0, 1.0)
"""The rotation by no angle."""


@dataclass(frozen=True)
class LoopClosure(Contact):
    """Two points fixed in frames coincide (three rows); optionally the frames do not turn either (six rows).

    World axes along or about which the frames cannot move relative to each other have no rows and no forces. A
    linkage in a plane therefore has two rows. The rows of orientation are half the sum over the axes of b_i x a_i, the
    rotation from b to a to first order. Where they are zero, their time derivative is the difference of the angular
    velocities. The force and moment act at the point on a's body, and their opposites on b's.

    Parameters
    ----------
    frame_a, frame_b : str
        One may be ``"universe"``, the world.
    rigid : bool
        Whether the frames' axes coincide too, up to ``rotation_b``.
    name : str, optional
        ``"<frame_a>-<frame_b>"`` where none is given.
    offset_a, offset_b : sequence of 3 float
        The points in the frames' axes [m].
    rotation_b : sequence of 4 float
        Quaternion (x, y, z, w) from b's axes to those that coincide with a's, where the loop is rigid.

    Raises
    ------
    InputError
        The frames are the same, or a loop that is not rigid has a rotation. On binding: a frame does not exist, or the
        relative motion does not span the rows.
    """

    ground = None
    frame_a: str
    frame_b: str
    rigid: bool = False
    name: str | None = None
    offset_a: Triple = (0.0, 0.0, 0.0)
    offset_b: Triple = (0.0, 0.0, 0.0)
    rotation_b: Quaternion = UNTURNED

    def __post_init__(self) -> None:
        what = f"LoopClosure {self.label!r}"
        checked_name(self.name, what)
        keep(self, offset_a=offset_of(self.offset_a, what), offset_b=offset_of(self.offset_b, what))
        if self.frame_a == self.frame_b:
            raise InputError(f"LoopClosure joins frame {self.frame_a!r} to itself; give two frames.")
        turn = np.asarray(self.rotation_b, dtype=float)
        size = float(np.linalg.norm(turn))
        if turn.shape != (4,) or not abs(size - 1.0) <= UNIT:
            raise InputError(
                f"rotation_b of {what} is {self.rotation_b!r}; give a quaternion (x, y, z, w) of length 1. The "
                "identity is (0, 0, 0, 1), w last."
            )
        keep(self, rotation_b=tuple((turn / size).tolist()))
        if not self.rigid and self.rotation_b != UNTURNED:
            raise InputError(f"{what} has a rotation_b, but its frames turn freely; give rigid=True.")

    @classmethod
    def closed_at(
        cls, robot: Robot, q: ArrayLike, frame_a: str, frame_b: str, rigid: bool = True, name: str | None = None
    ) -> LoopClosure:
        """Return the loop that is closed in a configuration, such as of two hands that hold one body.

        The point is the origin of ``frame_a``.

        Parameters
        ----------
        robot : Robot
        q : array_like (nq,)
            Configuration in which the frames are where the loop holds them.
        frame_a, frame_b, rigid, name
            As for ``LoopClosure``.

        Examples
        --------
        >>> rod = rt.contacts.LoopClosure.closed_at(pair, start, "left_tool0", "right_tool0")
        """
        configuration = robot.configuration(q, "q of LoopClosure.closed_at")
        (at, axes), (origin, rotation) = (Spot(frame).placed(robot, configuration) for frame in (frame_a, frame_b))
        offset = tuple((rotation.T @ (at - origin)).tolist())
        turn = tuple(pin.Quaternion(rotation.T @ axes).coeffs().tolist()) if rigid else UNTURNED
        return cls(frame_a, frame_b, rigid, name, offset_b=offset, rotation_b=turn)

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
        forces, holds = force_variables(self.label, axes, about), held_rows(self.label, axes, about, None)
        x, y, z, w = self.rotation_b
        turn = np.array(pin.Quaternion(w, x, y, z).toRotationMatrix())
        return BoundLoopClosure(self, self.label, self.frame_a, forces, (), holds, (), (), *ends, turn, axes, about)


@dataclass(frozen=True, eq=False)
class BoundLoopClosure(BoundContact):
    """Two spots held together by a wrench between them; a's axes are those of b after the rotation ``turn``."""

    first: Spot
    second: Spot
    turn: Array
    axes: tuple[int, ...]
    about: tuple[int, ...]

    def is_turned_over(self, robot: Robot, q: Array) -> bool:
        """Whether the axes are far apart in a configuration (nq,), as at half a turn, where the rows are zero too."""
        (_, a), (_, b) = self.first.placed(robot, q), self.second.placed(robot, q)
        return bool(self.about) and float(np.trace(a.T @ b @ self.turn)) < 1.0

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
        a = point.frame(self.first.frame).rotation
        turns = [
            cross(self.second.axis(point, self.turn[:, i].tolist()), [a[j, i] for j in range(3)]) for i in range(3)
        ]
        return scale(0.5, add(*turns))

    def _spread(self, forces: Sequence[Scalar]) -> list[Scalar]:
        values, count = [forces[i] for i in range(len(self.forces))], len(self.axes)
        return spread(values[:count], self.axes) + spread(values[count:], self.about)

    def _held(self, linear: Sequence[Scalar], angular: Sequence[Scalar]) -> list[Scalar]:
        return [linear[i] for i in self.axes] + [angular[i] for i in self.about]
