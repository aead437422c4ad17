"""Solves of relaxed problems: few intervals, one solver, and no limits between the points."""

from __future__ import annotations

from dataclasses import replace

from robotraj._util.values import dataclass
from robotraj.fixed_mesh.at_points import solved_once
from robotraj.fixed_mesh.between.limits_between import limited_between
from robotraj.native.engines.native import Native
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.problem import Problem
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.refinement.equidistribution import evenly_finer
from robotraj.transcription.schemes.lobatto import HermiteSimpson, LobattoIIIA
from robotraj.transcription.schemes.mesh import Mesh

COARSE, COARSE_STEP, FINER = 15, 6, 12
"""Intervals of a phase: without and with contacts, and by Lobatto IIIA with four points."""
PATIENCE, BRIEFLY = 700, 200
"""Largest number of iterations of a solve, and of one with contacts or limits of rates.

Many motions may need the same relaxation, such as those under a limit of the tool's speed. Solves then take hundreds.
With contacts an iteration takes longer. Limits of rates are not relaxed, so that there may be no solution.
"""


@dataclass(frozen=True, eq=False)
class CoarseSolves:
    """Brief solves beside a plan: of relaxed problems on few intervals, and of others on the mesh of the plan.

    Attributes
    ----------
    settings : Settings
        Those of the plan.
    progress : callable, optional
    finer : bool
        Whether the few intervals have a higher order.
    """

    settings: Settings
    progress: Progress | None = None
    finer: bool = False

    @property
    def on_finer(self) -> CoarseSolves:
        """The same on finer meshes."""
        return replace(self, finer=True)

    def solve(self, problem: Problem, guess: InitialGuess | Solution | None) -> Solution:
        """Solve a relaxed problem once."""
        own = self._settings(problem)
        return limited_between(solved_once(problem, guess, own, self.progress), own, self.progress)

    def has_motion(self, problem: Problem) -> bool:
        """Whether a brief solve on the mesh of the plan finds a motion, and another one near it on a finer mesh.

        Where durations are free, the fastest motion is looked for. What a long one does quickly falls between the
        points.
        """
        free = [low < high for low, high in (phase.duration_bounds for phase in problem.phases)]
        fastest = [
            phase.with_(objective=Duration()) if is_free else phase
            for phase, is_free in zip(problem.phases, free, strict=True)
        ]
        problem, solver = Problem(fastest, problem.links), self.settings.solver
        own = replace(self.settings, solver=solver.at_most(BRIEFLY), restarts=Restarts(0))
        found = self._without_limits(problem, None, own)
        if not found.success:
            return False
        finer = tuple(evenly_finer(part.mesh, 2.0) for part in found.phases)
        near = replace(own, mesh=finer, solver=solver.from_nearby().at_most(BRIEFLY))
        return self._without_limits(problem, found, near).success

    def _without_limits(self, problem: Problem, guess: Solution | None, settings: Settings) -> Solution:
        return limited_between(solved_once(problem, guess, settings, self.progress), settings, self.progress, False)

    def _settings(self, problem: Problem) -> Settings:
        contacts = any(phase.contacts for phase in problem.phases)
        rates = any(phase.rows.rates for phase in problem.phases)
        coarse = Mesh(COARSE_STEP if contacts else COARSE, HermiteSimpson())
        return replace(
            self.settings,
            mesh=Mesh(FINER, LobattoIIIA(4)) if self.finer else coarse,
            solver=InteriorPoint(max_iterations=BRIEFLY if contacts or rates else PATIENCE, fallback=None),
            engine=Native(),
            interval_limits=ConstraintGeneration(rounds=0),
            restarts=Restarts(0),
        )
