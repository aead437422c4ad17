"""Outlines: what an NLP was transcribed from, beside its problem.

An NLP with its functions takes some 20 MB, its outline some ten kilobytes. The NLP that is transcribed from an outline
has the same rows, columns and scales.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.native.engines.base import Engine
from robotraj.problem.problem import Problem
from robotraj.transcription.interval_limits.added_rows import with_added_rows
from robotraj.transcription.interval_limits.margins import with_margins
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.interval_limits.row_places import AddedRow, Margins
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.transcribe import KnownStart, transcribe


@dataclass(frozen=True, eq=False)
class Repeated(OneLine):
    """An array of few distinct values: scales are equal for all columns of one meaning.

    Attributes
    ----------
    values : ndarray
        The distinct values.
    numbers : ndarray of int (n,)
        Index of each entry among them.
    """

    values: Array
    numbers: NDArray[np.unsignedinteger]

    @classmethod
    def of(cls, array: Array) -> Repeated:
        """Return an array in this form."""
        values, numbers = np.unique(array, return_inverse=True)
        return cls(values, numbers.ravel().astype(np.min_scalar_type(len(values))))

    @property
    def array(self) -> Array:
        """The array (n,)."""
        return self.values[self.numbers]


@dataclass(frozen=True, eq=False)
class Outline(OneLine):
    """What an NLP was transcribed from, beside its problem and its start.

    Attributes
    ----------
    meshes : tuple of Mesh
    engine : Engine
    interval_limits : ConstraintGeneration
    additions, margins
        Of the NLP.
    scale, row_scale : Repeated
    """

    meshes: tuple[Mesh, ...]
    engine: Engine
    interval_limits: ConstraintGeneration
    additions: tuple[tuple[AddedRow, ...], ...]
    margins: Margins
    scale: Repeated
    row_scale: Repeated

    @classmethod
    def of(cls, nlp: Nlp) -> Outline | None:
        """Return the outline of an NLP; None with rows on distances, whose planes belong to one motion."""
        if nlp.keeps_clear:
            return None
        meshes = tuple(layout.mesh for layout in nlp.layouts)
        scales = Repeated.of(nlp.scale), Repeated.of(nlp.row_scale)
        return cls(meshes, nlp.engine, nlp.interval_limits, nlp.additions, nlp.margins, *scales)

    def transcribed(self, problem: Problem, w: Array, guessed: Mapping[int, float]) -> Nlp:
        """Transcribe the problem again.

        Parameters
        ----------
        problem : Problem
        w : ndarray (n_w,)
            The start, in physical units.
        guessed : mapping of int to float
            Entries of ``guess`` that differ from w, by column.
        """
        start = KnownStart(w, self.scale.array, self.row_scale.array)
        nlp = transcribe(problem, self.meshes, start, self.engine, self.interval_limits)
        for batch in self.additions:
            nlp = with_added_rows(nlp, batch, w[: len(nlp.variables)])
        guess = w.copy()
        guess[list(guessed)] = list(guessed.values())
        nlp = replace(nlp, guess=w, scale=start.scale, row_scale=start.row_scale)
        return replace(with_margins(nlp, self.margins), guess=guess)
