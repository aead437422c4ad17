"""Nonlinear programs of problems from their default guesses."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj.guess.default import default_guess
from robotraj.native.engines.base import Engine
from robotraj.problem.problem import Problem
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.transcribe import transcribe


def nlp_of(
    problem: Problem,
    mesh: Mesh | Sequence[Mesh],
    engine: Engine | None = None,
    interval_limits: ConstraintGeneration | None = None,
) -> Nlp:
    return transcribe(problem, mesh, default_guess(problem), engine, interval_limits)
