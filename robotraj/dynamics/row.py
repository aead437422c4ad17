"""One scalar row: a value between two bounds. Contacts, constraints and links write their conditions as rows."""

from __future__ import annotations

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass


@dataclass(frozen=True)
class Row(OneLine):
    """One scalar row: lower <= value <= upper.

    Attributes
    ----------
    name : str
        What is bounded, for example ``"effort limit"``.
    unit : str
        SI unit of the value and of both bounds.
    lower, upper : float
        Bounds, infinite where open.
    joint : str or None
        The joint, frame, contact or variable it is about.
    variable : str or None
        Name of the variable of the DAE, where the value is a single one: it becomes a bound of the NLP. With
        ``Where.RATE`` the row bounds its time derivative. Ask ``Phase.rows`` which rows bound which variables.
    """

    name: str
    unit: str
    lower: float
    upper: float
    joint: str | None = None
    variable: str | None = None

    @property
    def label(self) -> str:
        """Name and joint, as reports show them."""
        return f"{self.name}, {self.joint}" if self.joint else self.name
