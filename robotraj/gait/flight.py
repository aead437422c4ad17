"""Phases without contacts."""

from __future__ import annotations

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.problem.phase import Phase


@dataclass(frozen=True, eq=False)
class Flight(Phase):
    """A phase of a robot with a free root and without contacts.

    The centre of mass falls freely and the angular momentum about it is constant. Parameters are those of ``rt.Phase``.

    Raises
    ------
    InputError
        The phase has contacts, or moves a System or a robot with a fixed root.
    """

    name: str = "flight"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.robot is None or self.robot.root == "fixed":
            raise InputError(
                f"Flight {self.name!r} moves {'a System' if self.robot is None else repr(self.robot.name)}, which is "
                "fixed in the world; load the robot with root='floating' or root='planar'."
            )
        if self.contacts:
            names = ", ".join(repr(contact.label) for contact in self.contacts)
            raise InputError(f"Flight {self.name!r} has contacts ({names}); use rt.Phase for a phase with contacts.")
