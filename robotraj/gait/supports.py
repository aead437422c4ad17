"""The standing feet of each phase of a gait, and the options that all phases share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypedDict

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import Contact
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction, as_ground
from robotraj.gait.bounds.margins import MARGIN
from robotraj.gait.bounds.own_sides import OwnSides
from robotraj.gait.bounds.upright import Upright
from robotraj.gait.feet import FootKind, foot_contact
from robotraj.problem.constraints.bounds import Between
from robotraj.problem.objectives.base import Objective


@dataclass(frozen=True)
class Support(OneLine):
    """One phase of a gait: its standing feet and its duration.

    Attributes
    ----------
    feet : tuple of str
        Frames of the standing feet; none in flight.
    duration : float or (float, float)
        Duration, fixed or bounded [s].
    name : str
    kinds : tuple of Contact or callable
        Contact of each of the feet in this phase, such as the heel of one and the toe of another; the gait's own
        contact of every foot by default.
    """

    feet: tuple[str, ...]
    duration: float | Sequence[float] | Between
    name: str
    kinds: tuple[FootKind, ...] = ()

    def contacts(self, kind: FootKind) -> list[Contact]:
        """Return the contacts of the phase; ``kind`` is the gait's own."""
        kinds = self.kinds or (kind,) * len(self.feet)
        return [foot_contact(each, foot) for each, foot in zip(kinds, self.feet, strict=True)]


class GaitOptions(TypedDict, total=False):
    """``GaitTerms`` as keyword arguments that gaits pass on."""

    contact: FootKind
    clearance: float | None
    objective: Objective | None
    upright: Upright | None
    ground: Ground | GroundFunction
    sides: OwnSides | None
    margin: float


@dataclass(frozen=True)
class GaitTerms(OneLine):
    """Options that all phases of a gait share.

    Attributes
    ----------
    contact : Contact or callable
        Contact of every foot: ``rt.PointContact``, a contact to copy to the other feet, or a function of a frame.
    clearance : float or None
        Height of swinging feet halfway between their footholds [m]; 0 keeps them above the ground, None adds no row.
    objective : Objective or None
        Objective of every phase; ``gait_objective(robot, standing)`` by default.
    upright : Upright or None
    ground : Ground or callable
        Ground for the clearance, which lies below the robot; contacts have their own ground.
    sides : OwnSides or None
        Feet keep to their own sides; None lets legs cross.
    margin : float
        Share of friction cones, soles, torques and speeds that the plan keeps back, 0 to less than 1.

    Raises
    ------
    InputError
        The ground is a wall or a ceiling.
    """

    contact: FootKind = PointContact
    clearance: float | None = 0.0
    objective: Objective | None = None
    upright: Upright | None = None
    ground: Ground | GroundFunction = Flat()
    sides: OwnSides | None = OwnSides()
    margin: float = MARGIN

    def __post_init__(self) -> None:
        if not as_ground(self.ground).below:
            raise InputError(
                f"ground={self.ground!r} is a wall or a ceiling, on which no gait walks; give a ground below the "
                "robot. A contact of a phase may touch a wall, rt.PointContact(frame, ground=...)."
            )
