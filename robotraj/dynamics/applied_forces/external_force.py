"""A force of the world on a frame, as a function of the frame's place: wind, a process, a spring to the wall."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact, Contact, Wrench, checked_name, label_of
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot


class FramePlace(NamedTuple):
    """Where a frame is: symbols in the NLP, numbers in the witness.

    Attributes
    ----------
    position : (3,)
        Of its origin in the world [m].
    rotation : (3, 3)
        From its axes to the world's.
    """

    position: Any
    rotation: Any


@dataclass(frozen=True)
class ExternalForce(Contact):
    """A force on a frame, given as a function of its place; it holds nothing and has no unknowns.

    It stands among the contacts of a phase: ``contacts=[rt.ExternalForce("tool0", lambda place: [0, 0, -20])]``.
    Plan, validation and simulation evaluate the same function.

    Parameters
    ----------
    frame : str
        The frame at whose origin the force acts.
    force : callable
        ``force(place)`` returns the force (3,) [N], or force and moment (6,) [N, N m], in world axes.
    name : str, optional
        The frame's name by default.

    Examples
    --------
    >>> grinding = rt.ExternalForce("tool0", lambda place: [0.0, 0.0, -200.0 * (place.position[2] - 0.3)])
    """

    frame: str
    force: Callable[[FramePlace], Sequence[Scalar]]
    name: str | None = None
    ground = None

    def __post_init__(self) -> None:
        checked_name(self.name, "rt.ExternalForce")
        if not callable(self.force):
            raise InputError(f"The force of rt.ExternalForce is {self.force!r}; give a function of the frame's place.")

    @property
    def label(self) -> str:
        """Name of the force."""
        return label_of(self.name, self.frame)

    def bind(self, robot: Robot) -> BoundExternalForce:
        """Check the frame, and the function at a neutral place."""
        robot.frame(self.frame)
        bound = BoundExternalForce(self, self.label, self.frame, (), (), (), (), ())
        value = bound.at(FramePlace(np.zeros(3), np.eye(3)))
        if len(value) not in (3, 6) or not np.isfinite([float(each) for each in value]).all():
            raise InputError(
                f"The force of {self.label!r} is {value!r} for a frame at the origin; return 3 numbers [N], or 6 with "
                "the moment [N m]."
            )
        return bound


@dataclass(frozen=True, eq=False)
class Unheld(BoundContact):
    """A force on a frame that holds no row."""

    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Nothing is held."""
        return []

    def velocity(self, point: FramePoint) -> list[Scalar]:
        """Nothing is held."""
        return []

    def acceleration(self, point: FramePoint) -> list[Scalar]:
        """Nothing is held."""
        return []


@dataclass(frozen=True, eq=False)
class BoundExternalForce(Unheld):
    """The external force of one robot."""

    contact: ExternalForce

    def at(self, place: FramePlace) -> list[Scalar]:
        """Evaluate the function."""
        found = self.contact.force(place)
        return list(ca.vertsplit(found)) if isinstance(found, ca.SX) else list(np.ravel(np.array(found, dtype=object)))

    def wrench(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Wrench]:
        """Force and moment at the frame's origin, in world axes."""
        frame = point.frame(self.frame)
        value = self.at(FramePlace(frame.position, frame.rotation))
        return [(self.frame, [*value, *[0.0] * (6 - len(value))])]

    def vector(self, forces: Sequence[Scalar]) -> list[Scalar]:
        """Return zeros: the force has no unknowns to draw."""
        return [0.0, 0.0, 0.0]
