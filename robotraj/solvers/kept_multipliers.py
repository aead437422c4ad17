"""Multipliers of a solve whose program was released: raw arrays, from which all else is computed when it is read.

The multipliers of the program's rows, the last iterate and the outline of the NLP determine the multipliers of all
rows and bounds, the formulation for a warm start, and the costates. They take some 0.1 MB, the program 20 MB.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj.problem.problem import Problem
from robotraj.solvers.base import Multipliers, Origin
from robotraj.solvers.compiled import CompiledOrigin, CompiledProgram
from robotraj.solvers.formulation import Formulation, assembled, formulate, multipliers
from robotraj.solvers.stagewise.native import native_program
from robotraj.solvers.stagewise.reduction import Reduction
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.outline import Outline

REBUILT = 2
"""Number of programs that are kept of those that were built again, for warm starts one after the other."""


class KeptMultipliers(Multipliers):
    """Multipliers without the program of the solve that found them.

    Attributes
    ----------
    problem : Problem or None
        None on the way between processes.
    outline : Outline
    w : ndarray (n_w,)
        Last iterate, in physical units.
    lam : ndarray
        Multipliers of the program's rows, or those of the NLP's rows and then of its bounds.
    staged : bool or None
        Whether the program was written in stages; None where ``lam`` belongs to the NLP.
    guessed : mapping of int to float
        Guess of the free durations, by column: the program in stages measures time by it.
    """

    problem: Problem | None
    outline: Outline
    w: Array
    lam: Array
    staged: bool | None
    guessed: Mapping[int, float]

    def __init__(
        self,
        problem: Problem | None,
        outline: Outline,
        w: Array,
        lam: Array,
        staged: bool | None,
        guessed: Mapping[int, float],
    ) -> None:
        self.__dict__.update(problem=problem, outline=outline, w=w, lam=lam, staged=staged, guessed=guessed)

    @classmethod
    def of(cls, known: Multipliers) -> KeptMultipliers | None:
        """Return multipliers without their program; None where they have none, or where it cannot be built again."""
        origin = known.origin
        outline = None if origin is None else Outline.of(origin.nlp)
        if origin is None or outline is None:
            return None
        problem = origin.nlp.problem
        if not isinstance(origin, CompiledOrigin):
            plain = known.plain
            return cls(problem, outline, origin.w, np.append(plain.rows, plain.bounds), None, {})
        formulation = origin.formulation
        staged, guessed = isinstance(formulation, Reduction), dict[int, float]()
        if isinstance(formulation, Reduction) and formulation.stretched is not None:
            clock, unit = formulation.stretched.clock, formulation.stretched.unit
            columns = np.unique(clock[clock >= 0])
            guessed = dict(zip(columns.tolist(), (origin.nlp.scale / unit)[columns].tolist(), strict=True))
        return cls(problem, outline, origin.w, origin.lam, staged, guessed)

    def of_problem(self, problem: Problem | None) -> KeptMultipliers:
        """Return these multipliers with their problem, or without it for another process that has it."""
        return KeptMultipliers(problem, self.outline, self.w, self.lam, self.staged, self.guessed)

    @property
    def nlp(self) -> Nlp:
        """The NLP, transcribed again."""
        assert self.problem is not None
        return self.outline.transcribed(self.problem, self.w, self.guessed)

    @property
    def origin(self) -> Origin:
        """The program of a later solve, built again; the last ``REBUILT`` ones are kept."""
        return _origin(self)

    @cached_property
    def plain(self) -> Multipliers:
        """The arrays."""
        rows = len(self.outline.row_scale.numbers)
        if self.staged is None:
            return Multipliers(self.lam[:rows], self.lam[rows:])
        formulation = self._formulation(self.nlp)
        return Multipliers(*multipliers(formulation, formulation.unknowns(self.w), self.lam))

    @property
    def sizes(self) -> tuple[int, int]:
        """n_g and n_w."""
        return len(self.outline.row_scale.numbers), len(self.outline.scale.numbers)

    @property
    def rows(self) -> Array:
        """Multipliers of rows (n_g,)."""
        return self.plain.rows

    @property
    def bounds(self) -> Array:
        """Multipliers of variable bounds (n_w,)."""
        return self.plain.bounds

    def _formulation(self, nlp: Nlp) -> Formulation:
        return formulate(nlp) if self.staged else assembled(nlp)


class _BuiltAgain(CompiledOrigin):
    """An origin whose program is compiled when it is first used."""

    def __init__(self, nlp: Nlp, w: Array, formulation: Formulation, lam: Array) -> None:
        self.__dict__.update(nlp=nlp, w=w, formulation=formulation, lam=lam)

    @cached_property
    def compiled(self) -> CompiledProgram:
        """The program in C++."""
        threads = len(os.sched_getaffinity(0))
        return CompiledProgram(native_program(self.formulation.program, self.nlp.engine, threads), threads)


@lru_cache(maxsize=REBUILT)
def _origin(kept: KeptMultipliers) -> Origin:
    nlp = kept.nlp
    if kept.staged is None:
        return Origin(replace(nlp, guess=kept.w), kept.w)
    return _BuiltAgain(nlp, kept.w, kept._formulation(nlp), kept.lam)
