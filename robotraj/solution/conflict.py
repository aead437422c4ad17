"""A limit that must give before a motion exists."""

from __future__ import annotations

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass


@dataclass(frozen=True)
class Conflict(OneLine):
    """One row that has to be stretched, with a bound that would do.

    Attributes
    ----------
    phase : str
        Name of the phase.
    name : str
        ``"effort limit, elbow"``.
    time : float
        Where along the stretched motion the row is furthest beyond its bound [s].
    bound, needed : float
        The bound as it is, and one with which a motion was found, in ``unit``.
    unit : str
    relative : float
        The stretch relative to the row's scale.
    physical : bool
        Whether it is a limit of a joint or of the duration, which no other guess relieves.
    """

    phase: str
    name: str
    time: float
    bound: float
    needed: float
    unit: str
    relative: float
    physical: bool = False

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        where = "" if self.name == "duration" else f", t = {self.time:.3g} s"
        return f"{self.name}{where}: {self.bound:.4g}{unit} must become {self.needed:.4g}{unit}"
