"""The foothold of a contact: its anchors, the ground's axes there, and the components of forces along them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca

from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import (
    BoundContact,
    checked_name,
    force_range,
    friction_coefficient,
    keep,
    share_kept,
    spread,
)
from robotraj.dynamics.contacts.mobility import AXES
from robotraj.dynamics.contacts.point_on_frame import Spot, offset_of
from robotraj.dynamics.contacts.vectors import dot
from robotraj.dynamics.row import Row
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.function import as_ground
from robotraj.dynamics.variable import Scalar, Variable


@dataclass(frozen=True, eq=False)
class Footing:
    """A place (x, y, h(x, y)) on the ground; its coordinates are unknown along the axes the contact can move along.

    On a wall the unknown coordinates are those along the two axes of the ground's ``plan``.

    Attributes
    ----------
    name : str
        Name of the contact.
    ground : Ground
    axes : tuple of int
        World axes along which the contact can move.
    still : tuple of 3 float
        Its coordinates [m] along the other axes.
    """

    name: str
    ground: Ground
    axes: tuple[int, ...]
    still: tuple[float, float, float]

    @property
    def along(self) -> tuple[int, ...]:
        """The axes among ``axes`` over which the ground is a height: x and y, or other two for a wall."""
        return tuple(axis for axis in self.ground.plan if axis in self.axes)

    @property
    def anchors(self) -> tuple[Variable, ...]:
        """``<name>.x``, ``<name>.y`` [m] where the contact can move along them; other axes on a wall."""
        return tuple(Variable(f"{self.name}.{AXES[i]}", "m", "foothold", self.name) for i in self.along)

    def place(self, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Point [x, y, h] of the ground [m]."""
        return self.ground.at(*self._plan(anchors))

    def tangents(self, anchors: Mapping[str, Scalar]) -> tuple[list[list[Scalar]], list[Scalar]]:
        """Tangents along which the contact can move (two, one or none), and the normal: unit vectors in world axes.

        In a plane, tangent and normal are those of the curve in which the plane cuts the ground.
        """
        first, second, normal = self.ground.axes(*self._plan(anchors))
        if len(self.along) == 2:
            return [first, second], normal
        height = self.ground.axis
        if not self.along:
            return [], spread([self.ground.side], [height])
        (axis,) = self.along
        across, up = normal[axis], normal[height]
        size = (across * across + up * up) ** -0.5
        tangent = spread([up * size, -across * size], [axis, height])
        return [tangent], spread([across * size, up * size], [axis, height])

    def components(self, force: Sequence[Scalar], anchors: Mapping[str, Scalar]) -> tuple[Scalar, list[Scalar]]:
        """Split a force in world axes into its normal part and its tangential parts [N]."""
        tangents, normal = self.tangents(anchors)
        return dot(force, normal), [dot(force, tangent) for tangent in tangents]

    def normal_variable(self, forces: Sequence[Variable]) -> str | None:
        """Name of the force variable that equals the normal force, as on level ground; None where there is none."""
        symbols = ca.SX.sym("f", len(self.axes))
        anchors = {anchor.name: ca.SX.sym(anchor.name) for anchor in self.anchors}
        normal, _ = self.components(spread(ca.vertsplit(symbols), self.axes), anchors)
        up = self.axes.index(self.ground.axis)
        slope = ca.jacobian(normal, symbols) - ca.DM.eye(len(self.axes))[up, :]
        return forces[up].name if ca.simplify(slope).is_zero() else None

    def rows(self) -> tuple[Row, ...]:
        """Rows of ``values``: the ground's constraints on a foothold, such as a distance from a step's edge."""
        count = len(self.values({anchor.name: ca.SX.sym(anchor.name) for anchor in self.anchors}))
        return tuple(Row("foothold", "m", 0.0, float("inf"), self.name) for _ in range(count))

    def values(self, anchors: Mapping[str, Scalar], sole: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> list[Scalar]:
        """Evaluate the foothold rows [m], which must not be negative.

        Parameters
        ----------
        anchors : mapping of str
        sole : (back, front, half)
            Extent of the sole from the place along the foot's heading, and half its width [m].
        """
        x, y = self._plan(anchors)
        back, front, half = sole
        if not any(sole):
            return list(self.ground.footing(x, y))
        ahead = self._ahead(anchors)
        x, y = (value + 0.5 * (front - back) * part for value, part in zip((x, y), ahead, strict=True))
        along, across = (_size(part) for part in ahead)
        length = 0.5 * (front + back)
        return list(self.ground.footing(x, y, (length * along + half * across, length * across + half * along)))

    def _ahead(self, anchors: Mapping[str, Scalar]) -> tuple[Scalar, Scalar]:
        """Heading of a foot on level ground, world x and y: from its yaw, or along the plane."""
        if self.along == (0, 1):
            yaw = anchors[f"{self.name}.yaw"]
            return ca.cos(yaw), ca.sin(yaw)
        return (1.0, 0.0) if self.along == (0,) else (0.0, -1.0)

    def _plan(self, anchors: Mapping[str, Scalar]) -> tuple[Scalar, Scalar]:
        """World x and y [m] of the anchor, or its coordinates along the two axes of the ground's ``plan``."""
        x, y = (anchors[f"{self.name}.{AXES[i]}"] if i in self.axes else self.still[i] for i in self.ground.plan)
        return x, y


@dataclass(frozen=True, eq=False)
class BoundFoothold(BoundContact):
    """A contact whose point stays at its place on the ground while it holds.

    Attributes
    ----------
    spot : Spot
        The point of the robot.
    where : Footing
        Its place.
    """

    spot: Spot
    where: Footing

    @property
    def touching(self) -> Spot:
        """The spot."""
        return self.spot

    def place(self, anchors: Mapping[str, Scalar]) -> list[Scalar] | None:
        """Place on the ground (3) [m]."""
        return self.where.place(anchors)

    def normal_at(self, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Return the unit normal there; in a plane that of the curve in which the plane cuts the ground."""
        return self.where.tangents(anchors)[1]


def _size(value: Scalar) -> Scalar:
    """Smooth upper bound on the absolute value, too large by at most 0.01."""
    return abs(value) if isinstance(value, float) else (value * value + 1e-4) ** 0.5


def keep_footing(contact: Any, what: str) -> None:
    """Check the fields that all contacts on a ground have, and keep them as plain values; ``what`` is for errors.

    Raises
    ------
    InputError
        The name is no text, the friction is not positive, bounds of the normal force are crossed, the offset is no
        vector, the ground is none, or the margin is no share.
    """
    checked_name(contact.name, what)
    friction_coefficient(contact.friction, what)
    keep(contact, normal_force=force_range(contact.normal_force, what), offset=offset_of(contact.offset, what))
    keep(contact, ground=as_ground(contact.ground), margin=share_kept(contact.margin, what))
