"""Comparisons of a plan after its loop: the next plan that follows from each, and what a last one still lacks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.settings import Settings
from robotraj.solution.solution import Solution
from robotraj.solution.violation import Violation
from robotraj.solvers.status import Status
from robotraj.transcription.clearance.surface_rows import NearSurfaces

STOPPED = (Status.INTERRUPTED, Status.TIME_LIMIT, Status.MEMORY_LIMIT)
"""Statuses after which nothing else is tried."""


class PlanAttempt(NamedTuple):
    """What is planned next.

    Attributes
    ----------
    problem : Problem
    guess : InitialGuess, Solution or None
    settings : Settings
    surfaces : sequence of NearSurfaces or None
        For each phase, links of the robot that rows keep apart.
    is_brief : bool
        Whether the plan ends with the first solve that fails.
    lacked, why : str
        What the solution before it lacks, and what this one does about it, for the history of the plan.
    is_single : bool
        Whether it is one solve on the mesh of the settings, whose solution is a guess.
    """

    problem: Problem
    guess: InitialGuess | Solution | None
    settings: Settings
    surfaces: Sequence[NearSurfaces | None]
    lacked: str
    why: str
    is_brief: bool = True
    is_single: bool = False


class Correction(Protocol):
    """A comparison of plans with what their rows do not state, such as exact shapes or Coulomb's law."""

    def next_attempt(self, found: Solution, dropped: Solution | None) -> PlanAttempt | None:
        """Return the next plan where a solution lacks something; None where it does not, or nothing is left to try.

        ``dropped`` is the plan of the last attempt where it did not replace the one before it.
        """

    def accepts(self, again: Solution) -> bool:
        """Whether the plan of an attempt may replace the one before it."""

    def allows(self, again: Solution) -> bool:
        """Whether a plan of another correction is as good as the one before it in this comparison."""

    def judged(self, found: Solution) -> Solution:
        """Return the last solution with what it still lacks."""


def short_of(found: Solution, amount: float, violations: Sequence[Violation], is_met: bool = False) -> Solution:
    """Return a solution whose proof does not hold, since distances fall short by an amount [m].

    It still counts as solved where this is met with (``is_met``), such as an overlap that no row can move.
    """
    assert found.proof is not None
    return replace(
        found,
        status=Status.NOT_PROVED if found.status is Status.SOLVED and not is_met else found.status,
        proof=replace(found.proof, shortfall=max(found.proof.shortfall, amount)),
        interval_violations=(*found.interval_violations, *violations),
    )
