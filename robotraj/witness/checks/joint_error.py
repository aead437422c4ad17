"""An error of one joint, relative to its size in the motion."""

from __future__ import annotations

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass


@dataclass(frozen=True)
class JointError(OneLine):
    """An error of one joint in a phase.

    Attributes
    ----------
    joint, phase, unit : str
    amount, size : float
        The error, and what it is relative to [unit].
    """

    joint: str
    phase: str
    unit: str
    amount: float
    size: float

    @property
    def relative(self) -> float:
        """``amount`` / ``size``."""
        return self.amount / self.size
