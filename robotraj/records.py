"""What led to a solution: the meshes of a refinement and the stages before the last."""

from __future__ import annotations

from robotraj.status import Status
from robotraj.values import dataclass


@dataclass(frozen=True)
class MeshStep:
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
class StageRecord:
    """One stage that was solved before the problem itself.

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
