"""Time, as a cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from robotraj.objectives.base import EndCost

if TYPE_CHECKING:
    from robotraj.dynamics.dae import Dynamics


@dataclass(frozen=True)
class Duration(EndCost):
    """Duration of the phase, t_end - t_start [s]."""

    def value(self, start: Any, end: Any) -> Any:
        """Duration [s]."""
        return end.t - start.t

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Accept any dynamics."""
