"""Settings of the solves that look for a motion without overlaps, and of the plans along one."""

from __future__ import annotations

from dataclasses import replace

from robotraj._util.values import dataclass
from robotraj.fixed_mesh.warm_start import PATIENCE
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution

PUSHES = 2
"""Largest number of solves on the coarse mesh along a motion that overlaps.

They share the iterations of the plan without rows.
"""


@dataclass(frozen=True)
class SearchSettings:
    """Settings of a plan whose links overlap, from which those of further solves follow.

    Attributes
    ----------
    own : Settings
        Settings of the plan.
    patience : int
        Iterations of the plan without rows, to which the next ones are limited.
    """

    own: Settings
    patience: int = PATIENCE

    @property
    def from_known(self) -> Settings:
        """Settings of a plan from a known motion, which looks for no other guess."""
        return replace(self.own, restarts=Restarts(0))

    def nearby(self, from_routes: bool) -> Settings:
        """Return settings of solves near a free motion, or near one that overlaps."""
        most = self.patience if from_routes else self.patience // PUSHES
        return replace(self.from_known, solver=self.own.solver.at_most(most))

    def on_meshes_of(self, found: Solution, from_routes: bool) -> Settings:
        """Return settings of a plan near a known one, on its meshes."""
        return replace(self.nearby(from_routes), mesh=tuple(part.mesh for part in found.phases))


def coarsely(settings: Settings) -> Settings:
    """Return settings of a solve whose solution is a guess: limits between the points are left to the next one."""
    return replace(settings, interval_limits=replace(settings.interval_limits, rounds=0))
