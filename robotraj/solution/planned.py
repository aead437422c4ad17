"""The interface of a solution for exports and plots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from robotraj.solution.feedback.gains import Gains
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.violation import Violation
from robotraj.solvers.status import Status


class Planned(Protocol):
    """A solution; see ``robotraj.solution.solution.Solution``."""

    @property
    def phases(self) -> Sequence[PhaseSolution]:
        """The motion of each phase."""

    @property
    def status(self) -> Status:
        """How the solve ended."""

    @property
    def success(self) -> bool:
        """Whether every row holds."""

    @property
    def message(self) -> str:
        """Message of the solver."""

    @property
    def objective(self) -> float:
        """Value of the objective."""

    @property
    def duration(self) -> float:
        """From the first start to the last end [s]."""

    @property
    def iterations(self) -> int:
        """Iterations of the solver."""

    @property
    def times(self) -> dict[str, float]:
        """Seconds by part."""

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the parameters of all phases."""

    @property
    def violation_list(self) -> Sequence[Violation]:
        """Violated rows, worst first."""

    @property
    def gains(self) -> Gains:
        """Feedback along the motion."""
