"""A second solver for a problem that a first one did not solve."""

from __future__ import annotations

from dataclasses import replace

from robotraj.solvers.base import Multipliers, Outcome, Progress, Solver
from robotraj.transcription.nlp import Nlp

SHORTEST = 1e-3
"""Shortest time limit of a fallback [s]."""


def fall_back(
    fallback: Solver,
    nlp: Nlp,
    progress: Progress | None,
    multipliers: Multipliers | None,
    reason: str,
    seconds: float | None,
) -> Outcome:
    """Solve from ``nlp.guess`` by ``fallback``; the message of the outcome names it and the reason.

    Parameters
    ----------
    reason : str
        Why the first solver did not solve the problem.
    seconds : float or None
        Wall-clock seconds that are left, None without a limit.
    """
    if seconds is not None:
        fallback = fallback.within(max(SHORTEST, seconds))
    outcome = fallback.solve(nlp, progress, multipliers)
    by = f"{type(fallback).__name__}, since {reason}"
    return replace(outcome, message=f"{outcome.message} (by {by})", by=by)
