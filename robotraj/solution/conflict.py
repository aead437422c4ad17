"""A limit that excludes every motion, or beyond which a motion was found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass

NOTICED = 1e-3
"""Relative excess or relaxation that is reported, and difference of two results that agree."""
CLEAR = 2e-2
"""Relative relaxation on a coarse mesh below which a finer mesh may still have a motion."""
ROOM, ROOM_OF_DURATION = 1.5e-2, 4e-2
"""What a bound that barely suffices on a coarse mesh gives way further, relative to the larger of both bounds."""


@dataclass(frozen=True)
class Conflict(OneLine):
    """A row that excludes motions, with a bound that suffices.

    Attributes
    ----------
    phase : str
        Name of the phase.
    name : str
        Name of the row, such as ``"effort limit, elbow"``.
    time : float
        Time of the largest violation of the row along the relaxed motion [s]; NaN where it may be any.
    bound, needed : float
        The given bound, and one that suffices, in ``unit``.
    unit : str
    relative : float
        The relaxation relative to the scale of the row.
    physical : bool
        Whether it is a limit of a joint or of the duration, which does not depend on the guess.
    reason : str
        Purpose of the needed bound, or the rows with which it conflicts; empty if unknown.
    certain : bool
        Whether no motion exists within the given bound and the others, and the needed one was derived or tried.
        Otherwise no motion was found within it.
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
    certain: bool = False

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        where = "" if self.name == "duration" or np.isnan(self.time) else f", t = {self.time:.3g} s"
        reason = f" ({self.reason})" if self.reason else ""
        verb = "must become" if self.certain else "may have to become"
        return f"{self.name}{where}: {self.bound:.4g}{unit} {verb} {self.needed:.4g}{unit}{reason}"


def are_certain(conflicts: Sequence[Conflict]) -> bool:
    """Whether they exclude every motion."""
    return any(conflict.certain for conflict in conflicts)


def are_clear(conflicts: Sequence[Conflict]) -> bool:
    """Whether a conflict would remain on a finer mesh. From another guess a motion may exist nevertheless."""
    return any(conflict.certain or conflict.relative > CLEAR for conflict in conflicts)


def with_room(bound: float, needed: float, room: float = ROOM) -> float:
    """Return a bound beyond one that barely suffices on a coarse mesh, so that it suffices on finer meshes too."""
    size = room * max(abs(bound), abs(needed))
    return needed + size if needed >= bound else needed - size
