"""Types of the options of ``rt.plan`` by name, for functions that pass them on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypedDict

if TYPE_CHECKING:
    from robotraj.native.engines.base import Engine
    from robotraj.planning.continuation import ContinuationStep
    from robotraj.problem.initial_guess import InitialGuess
    from robotraj.replay_page.live.live_window import LiveWindow
    from robotraj.solution.proof import Goals
    from robotraj.solution.settings import Restarts, Settings
    from robotraj.solution.solution import Solution
    from robotraj.solvers.base import Solver
    from robotraj.transcription.interval_limits.methods import ConstraintGeneration
    from robotraj.transcription.refinement.base import Refinement
    from robotraj.transcription.schemes.mesh import Mesh


class Choices(TypedDict, total=False):
    """Options of ``rt.plan`` that may be left open, except for the guess."""

    mesh: Mesh | Sequence[Mesh] | None
    solver: Solver | None
    engine: Engine | None
    tolerance: float | None
    refinement: Refinement | None
    continuation: Sequence[ContinuationStep]
    interval_limits: ConstraintGeneration | None
    restarts: Restarts | None
    smoothing: float | None
    goals: Goals | None
    settings: Settings | None
    time_limit: float | None
    memory_limit: float | None


class GuessedChoices(Choices, total=False):
    """Options that may be left open, with the guess."""

    guess: InitialGuess | Solution | Sequence[InitialGuess] | None


class PlanOptions(GuessedChoices, total=False):
    """All options of ``rt.plan``."""

    check: bool
    progress: bool | None
    watch: bool | LiveWindow
    keep_program: bool
