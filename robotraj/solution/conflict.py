"""A limit that must be relaxed for a motion to exist."""

from __future__ import annotations

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass

CERTAIN = 2e-2
"""Relative relaxation on a coarse mesh below which a finer mesh may still have a motion."""
ROOM, ROOM_OF_DURATION = 1.5e-2, 5e-3
"""What a bound that barely suffices on a coarse mesh gives way further, relative to the larger of both bounds."""


@dataclass(frozen=True)
class Conflict(OneLine):
    """A row that must be relaxed, with a bound that suffices.

    Attributes
    ----------
    phase : str
        Name of the phase.
    name : str
        Name of the row, such as ``"effort limit, elbow"``.
    time : float
        Time of the largest violation of the row along the relaxed motion [s].
    bound, needed : float
        The given bound, and one that suffices, in ``unit``.
    unit : str
    relative : float
        The relaxation relative to the scale of the row.
    physical : bool
        Whether it is a limit of a joint or of the duration, which does not depend on the guess.
    reason : str
        Purpose of the needed bound, or the rows with which it conflicts; empty if unknown.
    exact : bool
        Whether the conflict follows from the ends of the motion alone, on any mesh.
    """

    phase: str
    name: str
    time: float
    bound: float
    needed: float
    unit: str
    relative: float
    physical: bool = False
    reason: str = ""
    exact: bool = False

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        where = "" if self.name == "duration" else f", t = {self.time:.3g} s"
        reason = f" ({self.reason})" if self.reason else ""
        return f"{self.name}{where}: {self.bound:.4g}{unit} must become {self.needed:.4g}{unit}{reason}"


def are_certain(conflicts: tuple[Conflict, ...]) -> bool:
    """Whether a conflict would remain on a finer mesh."""
    return any(conflict.exact or conflict.relative > CERTAIN for conflict in conflicts)


def with_room(bound: float, needed: float, room: float = ROOM) -> float:
    """Return a bound beyond one that barely suffices on a coarse mesh, so that it suffices on finer meshes too."""
    size = room * max(abs(bound), abs(needed))
    return needed + size if needed >= bound else needed - size
