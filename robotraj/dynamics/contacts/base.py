"""The base classes of contacts: ``Contact`` is a value, ``BoundContact`` has the held rows and forces for one robot."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, warn
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.mobility import AXES
from robotraj.dynamics.contacts.point_on_frame import Spot
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.row import Row
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction, as_ground
from robotraj.dynamics.variable import Scalar, Variable
from robotraj.robot.per_robot import PerRobot

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from robotraj.robot.robot import Robot


Wrench = tuple[str, list[Scalar]]
"""A frame, and force then moment (6,) [N, N m] on its body, in world axes at the frame's origin."""


def of_impulses(row: Row) -> Row | None:
    """Return a row on forces as one on impulses: only bounds of zero apply to both. None if no bound is left."""
    lower, upper = 0.0 if row.lower >= 0.0 else -inf, 0.0 if row.upper <= 0.0 else inf
    if lower == -inf and upper == inf:
        return None
    return replace(row, lower=lower, upper=upper)


def copied(contact: Contact, **fields: object) -> Contact:
    """Return a contact with other values of some fields, such as its ``frame``, ``name`` or ``ground``.

    None for a field that the kind does not have, such as its own name, changes nothing.
    """
    changes = {name: value for name, value in fields.items() if value is not None or has_field(contact, name)}
    return cast("Contact", replace(cast("DataclassInstance", contact), **changes))


def has_field(contact: Contact, name: str) -> bool:
    """Whether a contact may be copied with another value of a field."""
    return name in getattr(contact, "__dataclass_fields__", ())


class Contact(OneLine, ABC):
    """A constraint between the robot and the ground or another body. A new kind is one class and its bound form.

    Guesses, diagnosis, gaits and replay read the attributes below. A kind replaces them by fields or class
    attributes.

    Attributes
    ----------
    ground : Ground or callable, or None
        The ground that carries the contact, the level one at z = 0 by default, or a wall; None between bodies.
    friction : float
        Coefficient mu of the cone |f_t| <= mu f_n in which the force lies; infinite by default, without such a cone.
    margin : float
        Share of friction and sole that plans keep back, 0 to less than 1; 0 by default.
    """

    ground: Ground | GroundFunction | None = Flat()
    friction: float = inf
    margin: float = 0.0

    @property
    def planned_friction(self) -> float:
        """The coefficient of friction that plans use: (1 - margin) mu."""
        return (1.0 - self.margin) * self.friction

    @property
    @abstractmethod
    def label(self) -> str:
        """Name of the contact; by default that of its frame."""

    @abstractmethod
    def bind(self, robot: Robot) -> BoundContact:
        """Check names against a robot and return the variables and rows.

        Raises
        ------
        InputError
            The frame does not exist or leaves the plane, or the robot cannot move in the rows.
        """

    def bound_to(self, robot: Robot) -> BoundContact:
        """Bind once per robot and reuse the result in all phases; contacts without a hash are bound every time."""
        return _BOUND.get(robot, self, lambda: self.bind(robot))


@dataclass(frozen=True, eq=False)
class BoundContact(OneLine, ABC):
    """A contact of one robot: m held rows, their contact forces, and the foothold.

    Every method takes a point of the NLP (symbols) or of the witness (numbers) and returns symbols or numbers.
    The forces are dual to the velocity rows: the power of J' f on any motion is f . velocity.

    Attributes
    ----------
    contact : Contact
    name : str
    frame : str
        The frame at whose origin the wrench acts.
    forces : tuple of Variable
        ``force.<name>.x`` ... ``force.<name>.mz`` [N, N m], m of them.
    anchors : tuple of Variable
        The foothold ``<name>.x``, ``<name>.y`` [m], ``<name>.yaw`` [rad]: unknown, constant while the contact holds.
    holds : tuple of Variable
        The held rows, named for reports; rows that determine an anchor have its name.
    limit_rows : tuple of Row
        The rows of ``limits``: force normal to the ground, friction, centre of pressure.
    footing_rows : tuple of Row
        The rows of ``footing``: the part of the ground that a foot may be placed on.
    """

    contact: Contact
    name: str
    frame: str
    forces: tuple[Variable, ...]
    anchors: tuple[Variable, ...]
    holds: tuple[Variable, ...]
    limit_rows: tuple[Row, ...]
    footing_rows: tuple[Row, ...]

    @property
    def stands(self) -> bool:
        """Whether the robot stands on the contact: it has a ground, which lies below it."""
        return self.contact.ground is not None and as_ground(self.contact.ground).below

    @property
    def touching(self) -> Spot:
        """The point of the robot on which the force acts; by default the frame's origin."""
        return Spot(self.frame)

    def place(self, anchors: Mapping[str, Scalar]) -> list[Scalar] | None:
        """Place (3) [m] where the point stays while the contact holds; None, the default, where it may slide."""
        return None

    def normal_at(self, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Return the unit normal (3) of the ground towards the robot at the anchors, or at the origin without them."""
        return as_ground(self.contact.ground or Flat()).normal_at(
            [anchors.get(f"{self.name}.{axis}", 0.0) for axis in AXES]
        )

    @property
    def half_width(self) -> float:
        """Half the width of the sole [m]; 0, the default, for a point."""
        return 0.0

    def touched(self, robot: Robot, q: Array) -> Array:
        """Place (3,) [m] where the force acts in configuration q; by default the ``touching`` point."""
        return self.touching.placed(robot, q)[0]

    def outline(self) -> list[Spot]:
        """Points and balls that must stay above the ground while the foot swings: by default the frame's origin."""
        return [Spot(self.frame)]

    @abstractmethod
    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Rows (m) [m, rad] that are zero while the contact is at its anchors.

        Where they are zero, their time derivative is ``velocity``.
        """

    @abstractmethod
    def velocity(self, point: FramePoint) -> list[Scalar]:
        """Rows (m) [m/s, rad/s] that are zero while the contact holds."""

    @abstractmethod
    def acceleration(self, point: FramePoint) -> list[Scalar]:
        """Rows (m) [m/s^2, rad/s^2]: the time derivative of ``velocity``."""

    @abstractmethod
    def wrench(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Wrench]:
        """Wrenches on the robot for values of ``forces``: pairs of a frame and 6 entries."""

    @abstractmethod
    def vector(self, forces: Sequence[Scalar]) -> list[Scalar]:
        """Force (3) or force and moment (6) in world axes [N, N m]; components that the contact lacks are zero."""

    def limits(self, point: FramePoint, forces: Sequence[Scalar], anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Values of ``limit_rows``."""
        return []

    def shares(self, point: FramePoint, forces: Sequence[float], anchors: Mapping[str, float]) -> dict[str, float]:
        """Return how much of the ``"cone"`` and of the ``"sole"`` forces in numbers use; 1 is all, without a margin."""
        return {}

    def footing(self, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Values of ``footing_rows``, evaluated once per phase, since anchors are constant."""
        return []

    def locate(self, robot: Robot, q: Array) -> dict[str, float]:
        """Numeric values of the anchors in configuration q, for guesses."""
        return {}


_BOUND: PerRobot[BoundContact] = PerRobot()


def force_variables(name: str, linear: Sequence[int], angular: Sequence[int] = ()) -> tuple[Variable, ...]:
    """``force.<name>.x`` ... along and ``force.<name>.mx`` ... about world axes."""
    forces = [Variable(f"force.{name}.{AXES[i]}", "N", "contact force", name) for i in linear]
    return (*forces, *(Variable(f"force.{name}.m{AXES[i]}", "N m", "contact moment", name) for i in angular))


def held_rows(
    name: str, linear: Sequence[int], angular: Sequence[int] = (), normal: int | None = 2
) -> tuple[Variable, ...]:
    """``<name>.x`` ... along and ``<name>.rx``, ``<name>.ry``, ``<name>.yaw`` about world axes.

    A row that determines an anchor has its name: that about the axis ``normal`` of the ground is the yaw.
    """
    rows = [Variable(f"{name}.{AXES[i]}", "m", "contact position", name) for i in linear]
    turns = ["yaw" if i == normal else f"r{AXES[i]}" for i in angular]
    return (*rows, *(Variable(f"{name}.{turn}", "rad", "contact position", name) for turn in turns))


def spread(values: Sequence[Scalar], axes: Sequence[int]) -> list[Scalar]:
    """Put values at their axes among x, y and z, zeros elsewhere."""
    full: list[Scalar] = [0.0, 0.0, 0.0]
    for axis, i in zip(axes, range(len(axes)), strict=True):
        full[axis] = values[i]
    return full


def label_of(name: str | None, frame: str) -> str:
    """Return the name, or the frame's if there is none."""
    return frame if name is None else name


def checked_name(name: object, what: str) -> None:
    """Check that a name is a nonempty string or None."""
    if name is not None and (not isinstance(name, str) or not name):
        raise InputError(f"The name of {what} is {name!r}; give some text, or None for the frame's name.")


MATERIAL = 10.0
"""Coefficient of friction above which no pair of materials has one."""


def positive(value: object, what: str, unit: str) -> float:
    """Read a positive finite number."""
    number = _number(value)
    if not (np.isfinite(number) and number > 0.0):
        raise InputError(f"The {what} is {value!r}; give a positive number{f' [{unit}]' if unit else ''}.")
    return number


def friction_coefficient(value: object, what: str) -> float:
    """Read a coefficient of friction.

    Warns
    -----
    UserWarning
        It is one of no material, and plausible in percent.
    """
    number = positive(value, f"friction of {what}", "")
    if MATERIAL < number <= 100.0 * MATERIAL:
        warn(
            f"The friction of {what} is {number:g}, above that of any material. It is the ratio of forces: {number:g} "
            f"percent are {0.01 * number:g}."
        )
    return number


def force_range(value: ArrayLike, what: str) -> tuple[float, float]:
    """Read (least, greatest) normal force [N], 0 <= least < greatest; the greatest may be infinite."""
    pair = np.asarray(value, dtype=object)
    least, greatest = (_number(entry) for entry in (pair.tolist() if pair.shape == (2,) else (None, None)))
    if not 0.0 <= least < greatest or np.isinf(least):
        raise InputError(
            f"The normal_force of {what} is {value!r}; give (least, greatest) [N] with 0 <= least < greatest, since "
            "the ground cannot pull."
        )
    return least, greatest


def share_kept(value: object, what: str) -> float:
    """Read the share of friction and sole that a plan keeps back, from 0 to less than 1."""
    number = _number(value)
    if not 0.0 <= number < 1.0:
        raise InputError(f"The margin of {what} is {value!r}; give a share from 0 to less than 1.")
    return number


def keep(contact: Contact, **values: object) -> None:
    """Replace fields by their checked values; as tuples of floats contacts can be compared, hashed and stored."""
    for name, value in values.items():
        object.__setattr__(contact, name, value)


def _number(value: object) -> float:
    try:
        return float(value)  # type: ignore[arg-type]  # a TypeError becomes NaN, which is refused
    except (TypeError, ValueError):
        return np.nan


def refuse_contacts(contacts: Sequence[BoundContact], what: str) -> None:
    """Raise InputError where dynamics without contact forces are given contacts."""
    if contacts:
        names = ", ".join(repr(contact.name) for contact in contacts)
        raise InputError(
            f"{what} has no contact forces, but the phase has contacts {names}; use rt.dynamics.InverseDynamics()."
        )
