"""Solved neighbours of a case, from the nearest of which its plan starts: with its motion, multipliers and proof.

All plans start on the mesh of the first one and use its program. The first plan is more accurate than its goal, so that
the others mostly need no further mesh. Solutions keep raw multipliers and no program.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.applications.many.one_of_many import continued, planned
from robotraj.applications.many.options import GuessedChoices
from robotraj.guess.from_solution import FromSolution
from robotraj.problem.problem import Problem
from robotraj.solution.proof import Goals
from robotraj.solution.released import released
from robotraj.solution.solution import Solution
from robotraj.solvers.base import LazyMultipliers
from robotraj.solvers.compiled import CompiledOrigin, origin_of
from robotraj.solvers.kept_multipliers import KeptMultipliers
from robotraj.transcription.extract import extract
from robotraj.transcription.transcribe import start_of

Case = Mapping[str, float]

RESERVE = 4.0
"""Ratio by which the equations of the first plan are more accurate than their goal, for the others on its mesh."""
GOALS = "mesh", "tolerance", "goals", "settings"
"""Options of a plan that decide on its mesh or on its goals."""


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
        self._first: Solution | None = None

    def add(self, case: Case, solution: Solution | Callable[[], Solution]) -> None:
        """Add a solution, or the function that reads it from its file when it is the nearest one."""
        self._rows.append(self._row(case))
        self._solutions.append(without_program(solution) if isinstance(solution, Solution) else solution)

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
        if self._first is not None:
            return continued(options, problem, self._first if near is None else _on_mesh_of(self._first, near))
        found = _first_plan(options if near is None else {**options, "guess": near}, problem)
        if found.success:
            self._first = found
        return found

    def _row(self, case: Case) -> Array:
        return row_of(case, self.names) / self._ranges


def _first_plan(options: GuessedChoices, problem: Problem) -> Solution:
    """Plan with a reserve of accuracy, unless the options decide on the mesh or the goals."""
    if not any(options.get(name) is not None for name in GOALS):
        goals = Goals()
        found = planned({**options, "goals": replace(goals, error=goals.error / RESERVE)}, problem, keep_program=True)
        if found.proved and found.proof is not None:
            return replace(found, proof=replace(found.proof, goals=goals))
    return planned(options, problem, keep_program=True)


def _on_mesh_of(first: Solution, near: Solution) -> Solution:
    """Return the motion, multipliers and proof of a solution on the mesh and the program of the first one.

    Where that program cannot serve others, or where rows on distances held the solution, it is returned as it is.
    """
    origin = origin_of(first.multipliers)
    if (
        origin is None
        or near.multipliers is None
        or first.added_rows
        or origin.nlp.keeps_clear
        or len(near.phases) != len(first.phases)
    ):
        return near
    moved = _moved(origin, near)
    trajectories = extract(moved.nlp, moved.w)
    phases = tuple(replace(part, trajectory=own) for part, own in zip(first.phases, trajectories, strict=True))
    given = first.multipliers
    assert given is not None
    multipliers = LazyMultipliers(lambda: given.plain, given.sizes, moved)
    return replace(first, phases=phases, proof=near.proof, multipliers=multipliers)


def _moved(origin: CompiledOrigin, known: Solution) -> CompiledOrigin:
    """Return the origin of a program at another motion on its mesh, with that motion's multipliers if it has some."""
    kept, nlp = known.multipliers, origin.nlp
    meshes = [part.mesh for part in known.phases] == [layout.mesh for layout in nlp.layouts]
    if meshes and isinstance(kept, KeptMultipliers) and kept.lam.shape == origin.lam.shape:
        w, lam = kept.w, kept.lam
    else:
        w = start_of(nlp.problem, nlp.layouts, nlp.link_columns, nlp.variables, FromSolution(known))
        lam = origin.lam
    return CompiledOrigin(nlp, w, origin.formulation, lam, origin.compiled, origin.accuracy)


def without_program(solution: Solution) -> Solution:
    """Return a solution that holds no program: of one with rows on distances, multipliers and costates are left out."""
    found = released(solution)
    if found.multipliers is None or isinstance(found.multipliers, KeptMultipliers):
        return found
    return replace(found, multipliers=None, duals=())


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
