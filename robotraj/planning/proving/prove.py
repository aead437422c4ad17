"""Plan until the plan is proved: solve, measure the errors between the points, and refine the mesh.

A first, coarse mesh approximates the motion, and a second one finds its optimum. The order of the scheme predicts the
mesh that is needed, from the errors of the intervals and from the change of the objective. Where an exact motion
exceeds limits of torques between the points, they are lowered there by the excess, on the same mesh. Where a finer
mesh is not solved, a first one takes iterations without end, or errors stagnate, controls of systems become lines.
Where that does not help either, and the solution on the coarse mesh is no motion, the plan begins again from its guess.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from robotraj.planning.proving.best_motion import BestMotion
from robotraj.planning.proving.kept_apart import KeptApart
from robotraj.planning.proving.measures import proof_on
from robotraj.planning.proving.soft_solves import finer_where_bent, soft_solution
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import are_clear
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.equidistribution import Equidistribute, evenly_finer
from robotraj.transcription.refinement.linear_controls import ENDLESS, on_lines
from robotraj.transcription.schemes.mesh import Mesh

if TYPE_CHECKING:
    from robotraj.transcription.clearance.surface_rows import NearSurfaces

MOST_MESHES = 8
"""Largest number of meshes of a plan."""
ENOUGH = 4
"""Largest number of meshes for a proved motion whose objective has not settled, unless joints stick and slide."""
ENOUGH_OF_POWERS = 3
"""The same where joints stick and slide and the objective has kinks. It does not settle on some motions, whatever the
mesh, and limits between the points are imposed from the second mesh on."""
MET = 1e-3
"""Shortfall of a distance on a given path from which finer meshes are of no use [m]."""
SPENT = (Status.TIME_LIMIT, Status.MEMORY_LIMIT)
LIMITS_OF_THE_USER = (Status.ITERATION_LIMIT, *SPENT)
"""Statuses after which no finer mesh is tried."""
SECOND = 1.5
"""Growth of the number of intervals from a first mesh that could not be solved to the second one."""
DOUBLED = 2.0
"""Growth of the number of intervals of phases that miss their goal where an error stagnates.

After a second time the plan ends."""

Meshes = tuple[Mesh, ...]
"""The mesh of every phase."""


def prove(
    problem: Problem, guess: InitialGuess | Solution | None, settings: Settings, progress: Progress | None = None
) -> Solution:
    """Plan on finer and finer meshes until ``settings.goals`` hold.

    Returns
    -------
    Solution
        With ``proof``. Its status is ``Status.NOT_PROVED`` if it is no motion within its limits. If a finer mesh cannot
        be solved, it is the solution on the coarser one.
    """
    found = _Refining(problem, settings, progress).plan(guess)
    apart = KeptApart(problem, settings, progress)
    try:
        while (attempt := apart.next_attempt(found)) is not None:
            again = _Refining(problem, attempt.settings, progress, attempt.surfaces, attempt.is_brief)
            found = apart.kept(found, again.plan(attempt.guess))
    except KeyboardInterrupt:
        found = replace(found, status=Status.INTERRUPTED)
    return apart.judged(found)


class _Refining:
    """A plan on one mesh after the other: what follows the solution of a mesh, or its failure."""

    def __init__(
        self,
        problem: Problem,
        settings: Settings,
        progress: Progress | None,
        surfaces: Sequence[NearSurfaces | None] = (),
        is_brief: bool = False,
    ) -> None:
        self.problem, self.settings, self.is_brief = problem, settings, is_brief
        mesh = settings.mesh
        self.coarsest: Meshes = (mesh,) * len(problem.phases) if isinstance(mesh, Mesh) else tuple(mesh)
        self.on_lines = on_lines(problem, self.coarsest)
        self.motion = BestMotion(problem, settings, progress, surfaces)
        refinement = settings.refinement
        self.second = refinement.second if isinstance(refinement, Equidistribute) else SECOND
        """Growth from the first mesh to the second."""
        self.stagnant = 0
        """Meshes in a row on which an error stagnates."""

    def plan(self, guess: InitialGuess | Solution | None) -> Solution:
        """Solve on one mesh after the other."""
        motion, meshes = self.motion, self.coarsest
        if motion.sticking and not isinstance(guess, Solution):
            soft = soft_solution(self.problem, guess, meshes, self.settings, motion.solves)
            if soft is not None:
                guess, meshes = soft, finer_where_bent(soft, self.settings)
                motion.near, self.second = True, SECOND
        motion.neighbour = proof_on(guess, meshes)
        motion.near = motion.near or motion.neighbour is not None
        last: Solution | None = None
        for number in range(MOST_MESHES):
            powers = motion.has_sticking_powers
            enough = number >= (ENOUGH_OF_POWERS if powers else ENOUGH) - 1 and not motion.is_patient
            limited = motion.has_full_friction or (powers and motion.solution is not None)
            motion.limits_between = limited or enough or number == MOST_MESHES - 1
            first = number == 0 and motion.neighbour is None
            try:
                last = motion.solve(meshes, guess, first)
            except KeyboardInterrupt:
                if last is None:
                    raise
                last = replace(last, status=Status.INTERRUPTED)
            if last.status is Status.INTERRUPTED:
                return motion.interrupted(last)
            following = self._finer(last, first, enough) if last.success else self._after_failure(last, meshes, first)
            self._note(last, meshes, following)
            if following is None:
                break
            meshes = following
        assert last is not None
        try:
            return motion.conclude(last)
        except KeyboardInterrupt:
            return motion.interrupted(last)

    def _note(self, last: Solution, meshes: Meshes, following: Meshes | None) -> None:
        """Note what a solution lacks and the response in the history of the plan."""
        proof = self.motion.solution.proof if last.success and self.motion.solution is not None else None
        lacked = last.status.value if proof is None else ", ".join(map(str, proof.lacks))
        if following is None:
            response = "end"
        elif self.motion.afresh and self.motion.solution is None:
            response = "begin again from the guess on finer meshes"
        elif on_lines(self.problem, meshes) != meshes and on_lines(self.problem, following) == following:
            response = "controls as lines"
        else:
            response = f"{sum(mesh.count for mesh in following)} intervals"
        self.motion.solves.answered(lacked, response)

    def _after_failure(self, failed: Solution, meshes: Meshes, first: bool) -> Meshes | None:
        """Return the meshes to try after some that could not be solved; None where none would help."""
        if self.is_brief:
            return None
        # Free controls may exploit the program of a coarse mesh.
        endless = failed.iterations >= ENDLESS and self.on_lines != self.coarsest
        if (not first or endless) and failed.status not in SPENT:
            calmer = on_lines(self.problem, meshes)
            if calmer != meshes:
                return calmer
        if self._strayed(failed, endless):
            self.motion.begin_afresh()
            return tuple(evenly_finer(mesh, SECOND) for mesh in (self.on_lines if endless else self.coarsest))
        if not first or failed.status in LIMITS_OF_THE_USER or are_clear(failed.conflicts):
            return None
        return tuple(evenly_finer(mesh, max(self.second, SECOND)) for mesh in meshes)

    def _strayed(self, failed: Solution, endless: bool) -> bool:
        """Whether a finer mesh has no solution near that of a coarse one, which is no motion."""
        ended = self.motion.afresh or failed.status in (SPENT if endless else LIMITS_OF_THE_USER)
        return not ended and self.motion.solution is not None and not self.motion.is_motion

    def _finer(self, solution: Solution, first: bool, enough: bool) -> Meshes | None:
        """Keep a solution, and return the meshes that its measures need; None where it needs no others."""
        motion, refinement = self.motion, self.settings.refinement
        solution = motion.keep(solution)
        proof, measures = solution.proof, motion.measures
        assert proof is not None and measures is not None and refinement is not None
        if self._meets_obstacle_on_path(solution) or (proof.holds and not first) or (enough and motion.is_motion):
            return None
        phase = measures.stagnant
        self.stagnant = 0 if phase is None else self.stagnant + 1
        meshes = tuple(part.mesh for part in solution.phases)
        least, missed = self.second if first else 1.0, DOUBLED if self.stagnant else 1.0
        finer = measures.next_meshes(solution.phases, refinement, max(least, measures.growth), missed)
        if self.stagnant == 1 or measures.wanders or finer == meshes:
            # Where errors hardly fall, free controls may alternate.
            lines = on_lines(self.problem, finer)
            finer = tuple(lines[k] if k == phase or phase is None else each for k, each in enumerate(finer))
        return None if self.stagnant > 1 or finer == meshes else finer

    def _meets_obstacle_on_path(self, solution: Solution) -> bool:
        """Whether a moving obstacle is met on a given path, which no finer mesh changes."""
        on_path = any(phase.path is not None for phase in self.problem.phases)
        return on_path and solution.proof is not None and solution.proof.shortfall > MET
