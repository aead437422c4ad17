"""Records of how a solution was found: meshes of a refinement, steps of a continuation, times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar, Protocol, TypeVar

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.solvers.status import Status


class _Attempt(Protocol):
    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def times(self) -> dict[str, float]: ...

    @property
    def iterations(self) -> int: ...


T = TypeVar("T", bound=_Attempt)


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


def with_effort_of(other: _Attempt, found: T) -> T:
    """Return a solution or an outcome with the times and iterations of another attempt added to its own."""
    return replace(found, times=added_times(other.times, found.times), iterations=other.iterations + found.iterations)
