"""Alternative constraints, such as grasps from several sides, of which the plan chooses the best."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.problem.constraints.base import BoundConstraint, Constraint


@dataclass(frozen=True)
class OneOf(Constraint):
    """One of several constraints holds; ``rt.plan`` plans with each and returns the plan of least objective.

    Parameters
    ----------
    candidates : sequence of Constraint
        Alternatives such as ``rt.FramePose`` values; wrap the whole in ``rt.AtEnd``.
    chosen : int
        Index of the candidate whose rows the phase has. The returned plan holds its own.
    """

    candidates: Sequence[Constraint]
    chosen: int = 0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.candidates or not all(isinstance(each, Constraint) for each in self.candidates):
            raise InputError(f"OneOf chooses among constraints such as rt.FramePose(...); got {self.candidates!r}.")
        if not 0 <= self.chosen < len(self.candidates):
            raise InputError(f"OneOf has {len(self.candidates)} candidates; there is no number {self.chosen}.")

    def bind(self, dynamics: Dynamics, parameters: Sequence[str] = ()) -> BoundConstraint:
        """Bind every candidate, so that each is checked, and return the chosen one."""
        bound = [each.bind(dynamics, parameters) for each in self.candidates]
        return bound[self.chosen]

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the variables of the chosen candidate."""
        return self.candidates[self.chosen].augment(dynamics)
