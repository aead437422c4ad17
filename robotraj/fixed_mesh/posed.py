"""A problem on a mesh, with the rows that it has so far."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from robotraj._util.arrays import Array
from robotraj.fixed_mesh.between.clearing import Clearing
from robotraj.fixed_mesh.sizes.slack_powers import with_slack_powers
from robotraj.fixed_mesh.warm_start import (
    earlier_multipliers,
    earlier_program,
    earlier_rows,
    lengthened,
)
from robotraj.guess.default import as_guess, default_guess
from robotraj.guess.from_solution import FromSolution
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Multipliers
from robotraj.transcription.clearance.surface_rows import NearSurfaces
from robotraj.transcription.interval_limits.added_rows import rows_against_swings, with_added_rows
from robotraj.transcription.interval_limits.margins import with_margins
from robotraj.transcription.interval_limits.row_places import AddedRow, Margins
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.reuse import continued_at
from robotraj.transcription.schemes.mesh import MovingMesh
from robotraj.transcription.transcribe import transcribe


class Posed(NamedTuple):
    """A transcribed problem with the rows that it has so far.

    Attributes
    ----------
    problem : Problem
    nlp, without_clearance : Nlp
        What is solved, and the same without rows on distances.
    clearing : Clearing
    added : tuple of AddedRow
        Rows between the points.
    surfaces : sequence of NearSurfaces or None
        For each phase, links of the robot that rows keep apart.
    """

    problem: Problem
    nlp: Nlp
    without_clearance: Nlp
    clearing: Clearing
    added: tuple[AddedRow, ...]
    surfaces: Sequence[NearSurfaces | None]

    @property
    def moving(self) -> bool:
        """Whether knots move."""
        return any(isinstance(layout.mesh, MovingMesh) for layout in self.nlp.layouts)

    def again(
        self,
        settings: Settings,
        solution: Solution,
        w: Array,
        new: Sequence[AddedRow],
        replaced: bool,
        margins: Margins,
    ) -> Posed:
        """Return the problem with new rows and lowered limits, from a solution with the decision vector w.

        Rows on distances are built again where these have further rows or other planes (``replaced``), not where bounds
        change.
        """
        added = (*self.added, *new)
        if self.moving:
            # Knots start again from those of the mesh, since moved knots stay on the arcs that they have reached.
            last = FromSolution(solution)
            base = transcribe(
                self.problem, settings.mesh, last, settings.engine, settings.interval_limits, settings.smoothing
            )
            base = with_surfaces(with_added_rows(base, added, base.guess), self.surfaces)
        else:
            base = with_added_rows(self.without_clearance, new, w) if new else continued_at(self.without_clearance, w)
        rebuilt = bool(self.clearing) and (bool(new) or replaced)
        nlp = with_margins(base if rebuilt or new or not self.clearing else continued_at(self.nlp, w), margins)
        nlp = self.clearing.rows(nlp) if rebuilt else nlp
        return self._replace(nlp=nlp, without_clearance=base, added=added)


def posed_problem(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    surfaces: Sequence[NearSurfaces | None],
) -> tuple[Posed, Multipliers | None]:
    """Transcribe a problem with the rows of its guess; also return the multipliers of the guess that are of use.

    Parameters
    ----------
    problem : Problem
    guess : InitialGuess, Solution or None
    settings : Settings
    surfaces : sequence of NearSurfaces or None
        For each phase, links of the robot that rows keep apart.
    """
    mesh, limits = settings.mesh, settings.interval_limits
    start = as_guess(guess) or default_guess(problem)
    plain = earlier_program(problem, mesh, guess, settings.engine, limits, settings.smoothing) or transcribe(
        problem, mesh, with_slack_powers(start, problem), settings.engine, limits, settings.smoothing
    )
    added, same = earlier_rows(problem, mesh, guess) if limits.rounds else ([], False)
    if settings.goals is not None:
        missing = [each for each in rows_against_swings(plain) if each not in set(added)]
        added, same = [*added, *missing], same and not missing
    nlp = with_surfaces(with_added_rows(plain, added, plain.guess) if added else plain, surfaces)
    clearing = Clearing(nlp, start)
    posed = Posed(problem, clearing.rows(nlp), nlp, clearing, tuple(added), surfaces)
    extended = bool(added) and same and not any(surfaces)
    multipliers = earlier_multipliers(guess, posed.nlp if extended else plain, extended)
    if (clearing or any(surfaces) or (added and not same)) and multipliers is not None:
        multipliers = lengthened(multipliers, posed.nlp)
    return posed, multipliers


def with_surfaces(nlp: Nlp, surfaces: Sequence[NearSurfaces | None]) -> Nlp:
    """Return the NLP with rows that keep links of the robots apart."""
    if not any(surfaces):
        return nlp
    from robotraj.transcription.clearance.surface_rows import with_surface_rows

    return with_surface_rows(nlp, surfaces)
