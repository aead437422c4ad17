"""Many starts of one problem: what the first plan made, the transcription and the solver's program, serves them all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from robotraj._util.values import dataclass
from robotraj.guess.base import InitialGuess, PhaseGuess
from robotraj.native.engines.base import Engine
from robotraj.solvers.base import Multipliers
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.reuse import started_at
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.transcribe import transcribe

if TYPE_CHECKING:
    from robotraj.problem.links.base import BoundLink
    from robotraj.problem.phase import Phase
    from robotraj.problem.problem import Problem


class Shared:
    """What plans of one problem on one mesh share, made when it is first asked for; for one thread at a time.

    Scales are those of one guess, whichever start comes first, so that every start ends as it would alone.

    Parameters
    ----------
    reference : InitialGuess
        That decides the scales.
    """

    def __init__(self, reference: InitialGuess) -> None:
        self._reference = reference
        self._problem: Problem | None = None
        self._nlp: Nlp | None = None
        self.known: Multipliers | None = None
        """Of the last solve: ``origin`` is what its solver kept."""

    def transcribed(
        self,
        problem: Problem,
        mesh: Mesh | Sequence[Mesh],
        guess: InitialGuess,
        engine: Engine | None,
        interval_limits: ConstraintGeneration,
    ) -> Nlp | None:
        """Give the NLP started at a guess; None for another problem, mesh or engine than the first."""
        meshes = [mesh] * len(problem.phases) if isinstance(mesh, Mesh) else list(mesh)
        if self._nlp is None:
            self._problem, self._nlp = problem, transcribe(problem, meshes, self._reference, engine, interval_limits)
        nlp = self._nlp
        same = (
            problem is self._problem
            and [layout.mesh for layout in nlp.layouts] == meshes
            and (engine is None or engine == nlp.engine)
            and interval_limits == nlp.interval_limits
        )
        return started_at(nlp, guess) if same else None

    def keep(self, nlp: Nlp, known: Multipliers) -> None:
        """Keep what a solve of the shared NLP made."""
        if self._nlp is not None and nlp.blocks is self._nlp.blocks:
            # Functions that were assembled for the solver come along.
            self._nlp, self.known = nlp, known


@dataclass(frozen=True, eq=False)
class Start(InitialGuess):
    """A guess whose plan uses what earlier plans of the same problem made.

    Parameters
    ----------
    guess : InitialGuess
    shared : Shared
    """

    guess: InitialGuess
    shared: Shared

    def prepared(self, problem: Problem) -> InitialGuess:
        """Prepare the guess itself."""
        return replace(self, guess=self.guess.prepared(problem))

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Guess as the guess itself does."""
        return self.guess.of(phase, index)

    def of_link(self, link: BoundLink, index: int) -> Mapping[str, float]:
        """Guess as the guess itself does."""
        return self.guess.of_link(link, index)
