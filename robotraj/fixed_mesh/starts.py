"""Starts of one problem: all use the transcription and the solver's program of the first plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from robotraj._util.values import dataclass
from robotraj.native.engines.base import Engine
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solvers.base import Multipliers
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.reuse import started_at
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.transcribe import meshes_of, transcribe


class Shared:
    """Data that plans of one problem on one mesh share, built at first use. One thread may use it at a time.

    Variables and rows are scaled at one guess, so that the result of a start does not depend on the order of starts.

    Parameters
    ----------
    reference : InitialGuess
        Guess at which the problem is scaled.
    """

    def __init__(self, reference: InitialGuess) -> None:
        self._reference = reference
        self._problem: Problem | None = None
        self._nlp: Nlp | None = None
        self.known: Multipliers | None = None
        """Multipliers of the last solve. Their ``origin`` holds the program of its solver."""

    def transcribed(
        self,
        problem: Problem,
        mesh: Mesh | Sequence[Mesh],
        guess: InitialGuess,
        engine: Engine | None,
        interval_limits: ConstraintGeneration,
        smoothing: float,
    ) -> Nlp | None:
        """Return the NLP with a guess; None if more than the guess differs from the first."""
        meshes = meshes_of(problem, mesh)
        if self._nlp is None:
            self._problem = problem
            self._nlp = transcribe(problem, meshes, self._reference, engine, interval_limits, smoothing)
        nlp = self._nlp
        same = (
            problem is self._problem
            and tuple(layout.mesh for layout in nlp.layouts) == meshes
            and (engine is None or engine == nlp.engine)
            and interval_limits == nlp.interval_limits
            and smoothing == nlp.smoothing
        )
        return started_at(nlp, guess) if same else None

    def keep(self, nlp: Nlp, known: Multipliers) -> None:
        """Keep the results of a solve of the shared NLP."""
        if self._nlp is not None and nlp.blocks is self._nlp.blocks:
            # This NLP has the cached functions that were assembled for the solver.
            self._nlp, self.known = nlp, known


@dataclass(frozen=True, eq=False)
class Start(InitialGuess):
    """A guess whose plan uses data of earlier plans of the same problem.

    Parameters
    ----------
    guess : InitialGuess
        The guess itself.
    shared : Shared
        Data of the earlier plans.
    """

    guess: InitialGuess
    shared: Shared

    def prepared(self, problem: Problem) -> InitialGuess:
        """Prepare the inner guess."""
        return replace(self, guess=self.guess.prepared(problem))

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Return the inner guess of a phase."""
        return self.guess.of(phase, index)

    def of_link(self, link: BoundLink, index: int) -> Mapping[str, float]:
        """Return the inner guess of the parameters of a link."""
        return self.guess.of_link(link, index)
