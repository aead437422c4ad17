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
        Name of the joint, frame, contact or variable that the row bounds.
    variable : str or None
        Name of the DAE's variable, if the value is a single variable. The row then becomes a bound of the NLP. With
        ``Where.RATE`` it bounds the variable's time derivative. ``Phase.rows`` lists the rows of a phase.
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
