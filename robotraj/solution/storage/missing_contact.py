"""The placeholder for a contact whose class or ground a file does not hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NoReturn

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact, Contact, Wrench
from robotraj.dynamics.contacts.point_on_frame import Spot, Triple
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.variable import Scalar, Variable
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class MissingContact(Contact):
    """A contact of a file without its equations: it has variables, so that the solution can be sampled and replayed.

    Attributes
    ----------
    printed : str
        The contact as it was printed.
    name, frame : str
    offset : tuple of 3 float
        The point that touches, in the frame's axes [m].
    forces, anchors : sequence of Variable
    components : array (3 or 6, m)
        Force and moment in world axes for each force variable.
    friction : float
    ground : Ground or None
    """

    printed: str
    name: str
    frame: str
    offset: Triple
    forces: Sequence[Variable]
    anchors: Sequence[Variable]
    components: Array
    friction: float
    ground: Ground | None

    @classmethod
    def of(cls, contact: Contact, robot: Robot, ground: Ground | None) -> MissingContact:
        """Return the placeholder of a contact; its ground is that which a file holds."""
        bound = contact.bound_to(robot)
        unit = np.eye(len(bound.forces)).tolist()
        columns = [[float(part) for part in bound.vector(forces)] for forces in unit]
        parts = len(bound.vector([0.0] * len(unit)))
        return cls(
            repr(contact),
            bound.name,
            bound.touching.frame,
            bound.touching.offset,
            bound.forces,
            bound.anchors,
            np.reshape(columns, (len(unit), parts)).T,
            float(contact.friction),
            ground,
        )

    @property
    def label(self) -> str:
        """Name of the contact."""
        return self.name

    def bind(self, robot: Robot) -> BoundMissingContact:
        """Return the variables."""
        robot.frame(self.frame)
        return BoundMissingContact(
            self, self.name, self.frame, tuple(self.forces), tuple(self.anchors), (), (), (), self
        )


@dataclass(frozen=True, eq=False)
class BoundMissingContact(BoundContact):
    """Variables of a contact; its equations raise an error that names the remedy."""

    stored: MissingContact

    @property
    def touching(self) -> Spot:
        """The point that touches."""
        return Spot(self.frame, self.stored.offset)

    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """No rows are known."""
        return []

    def velocity(self, point: FramePoint) -> list[Scalar]:
        """No rows are known."""
        return []

    def acceleration(self, point: FramePoint) -> NoReturn:
        """Raise InputError."""
        self._refuse()

    def wrench(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Wrench]:
        """Raise InputError."""
        self._refuse()

    def vector(self, forces: Sequence[Scalar]) -> list[Scalar]:
        """Force, or force and moment, in world axes [N, N m]."""
        return [sum((c * f for c, f in zip(row, forces, strict=True)), 0.0) for row in self.stored.components.tolist()]

    def _refuse(self) -> NoReturn:
        raise InputError(
            f"The equations of contact {self.stored.printed} are Python functions, which a file does not hold; "
            "load it with rt.load_solution(path, problem=...) to have them."
        )
