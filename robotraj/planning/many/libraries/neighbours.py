"""Solved neighbours of a case: a plan starts from the mesh, the program, the multipliers and the proof of the nearest.

Solutions keep raw multipliers. One program a mesh is kept, of the last plan on it, for all solutions on that mesh.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.guess.from_solution import FromSolution
from robotraj.planning.many.one_of_many import continued, planned
from robotraj.problem.problem import Problem
from robotraj.solution.released import released
from robotraj.solution.solution import Solution
from robotraj.solvers.base import LazyMultipliers
from robotraj.solvers.compiled import CompiledOrigin, origin_of
from robotraj.solvers.kept_multipliers import KeptMultipliers
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.transcribe import start_of

if TYPE_CHECKING:
    from robotraj.planning.many.options import GuessedChoices

Array = NDArray[np.float64]
Case = Mapping[str, float]

PROGRAMS = 2
"""Number of meshes whose programs are kept."""


class Neighbours:
    """Solutions by the numbers of their cases. One thread may use them at a time.

    Parameters
    ----------
    ranges : mapping of str to float
        Names of the numbers, and the range of each: distances are relative to it.
    """

    def __init__(self, ranges: Mapping[str, float]) -> None:
        self.names = sorted(ranges)
        self._ranges = np.array([ranges[name] or 1.0 for name in self.names])
        self._rows: list[Array] = []
        self._solutions: list[Solution | Callable[[], Solution]] = []
        self._programs: OrderedDict[tuple[Mesh, ...], Solution] = OrderedDict()

    def add(self, case: Case, solution: Solution | Callable[[], Solution]) -> None:
        """Add a solution, or the function that reads it from its file when it is the nearest one."""
        self._rows.append(self._row(case))
        if isinstance(solution, Solution):
            self._keep_program(solution)
            solution = released(solution)
        self._solutions.append(solution)

    def nearest(self, case: Case) -> Solution | None:
        """Return the solution of the nearest case; None where there is none."""
        if not self._rows:
            return None
        number = int(np.argmin(np.sum((np.array(self._rows) - self._row(case)) ** 2, axis=1)))
        known = self._solutions[number]
        if not isinstance(known, Solution):
            known = self._solutions[number] = known()
        return known

    def plan(self, options: GuessedChoices, problem: Problem, case: Case) -> Solution:
        """Plan the problem of a case from the nearest solution, if there is one."""
        near = self.nearest(case)
        if near is None:
            return planned(options, problem, keep_program=True)
        found = continued(options, problem, self._with_program(near))
        self._keep_program(found)
        return found

    def _row(self, case: Case) -> Array:
        return row_of(case, self.names) / self._ranges

    def _keep_program(self, solution: Solution) -> None:
        """Keep the program of a solution for its mesh, if the program can serve other ones."""
        origin = origin_of(solution.multipliers)
        if origin is None or solution.added_rows or origin.nlp.keeps_clear or not solution.success:
            return
        meshes = _meshes(solution)
        self._programs[meshes] = solution
        self._programs.move_to_end(meshes)
        while len(self._programs) > PROGRAMS:
            self._programs.popitem(last=False)

    def _with_program(self, known: Solution) -> Solution:
        """Return a solution with the program that is kept for its mesh, at its own motion and multipliers."""
        holder = self._programs.get(_meshes(known))
        origin = None if holder is None else origin_of(holder.multipliers)
        if holder is None or origin is None or known.added_rows:
            return known
        moved = _moved(origin, known)
        given = known.multipliers or holder.multipliers
        assert given is not None
        multipliers = LazyMultipliers(lambda: given.plain, given.sizes, moved)
        return replace(known, problem=holder.problem, multipliers=multipliers)


def _moved(origin: CompiledOrigin, known: Solution) -> CompiledOrigin:
    """Return the origin of a program at another motion on its mesh, with that motion's multipliers if it has some."""
    kept, nlp = known.multipliers, origin.nlp
    if isinstance(kept, KeptMultipliers) and kept.w.shape == origin.w.shape and kept.lam.shape == origin.lam.shape:
        w, lam = kept.w, kept.lam
    else:
        w = start_of(nlp.problem, nlp.layouts, nlp.link_columns, nlp.variables, FromSolution(known))
        lam = origin.lam
    return CompiledOrigin(nlp, w, origin.formulation, lam, origin.compiled, origin.accuracy)


def _meshes(solution: Solution) -> tuple[Mesh, ...]:
    return tuple(part.mesh for part in solution.phases)


def row_of(case: Case, names: Sequence[str]) -> Array:
    """Return the numbers of a case in the order of their names.

    Raises
    ------
    InputError
        It has other names, or numbers that are not finite.
    """
    if sorted(case) != list(names):
        raise InputError(
            f"The case {dict(case)!r} has other numbers than {', '.join(names)}, which all cases must have."
        )
    row = np.array([float(case[name]) for name in names])
    if not np.isfinite(row).all():
        raise InputError(f"The case {dict(case)!r} has numbers that are not finite.")
    return row
