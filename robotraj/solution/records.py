"""Records of how a solution was found: meshes of a refinement, steps of a continuation, times."""

from __future__ import annotations

from collections.abc import Mapping

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.solvers.status import Status


@dataclass(frozen=True)
class MeshStep(OneLine):
    """One mesh of a refinement.

    Attributes
    ----------
    intervals, points : int
        Intervals and collocation points of all phases.
    error : float
        Largest relative error of an interval.
    objective : float
    iterations : int
    seconds : float
    """

    intervals: int
    points: int
    error: float
    objective: float
    iterations: int
    seconds: float


@dataclass(frozen=True)
class ContinuationRecord(OneLine):
    """One continuation step, which was solved before the problem itself.

    Attributes
    ----------
    name : str
    status : Status
    objective : float
    iterations : int
    seconds : float
    """

    name: str
    status: Status
    objective: float
    iterations: int
    seconds: float


def added_times(first: Mapping[str, float], second: Mapping[str, float]) -> dict[str, float]:
    """Add the times [s] of two solves, part by part. Solves by different solvers have different parts."""
    return {part: first.get(part, 0.0) + second.get(part, 0.0) for part in dict.fromkeys([*first, *second])}
