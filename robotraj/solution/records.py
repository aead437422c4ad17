"""Records of how a solution was found: meshes of a refinement, steps of a continuation, times, and every solve."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
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
        Processor time [s].
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
        Processor time [s].
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
    """Return a solution or an outcome with the times, iterations and rounds of another attempt added to its own."""
    effort = {"times": added_times(other.times, found.times), "iterations": other.iterations + found.iterations}
    rounds = {"rounds": merged(getattr(other, "rounds", ()), found.rounds)} if hasattr(found, "rounds") else {}
    return replace(found, **effort, **rounds)


_NUMBERS = itertools.count()


@dataclass(frozen=True)
class Lack(OneLine):
    """A measure of a solution that is beyond what is allowed.

    Attributes
    ----------
    kind : str
        What is measured, such as ``"excess over limits"``.
    amount, allowed : float
    """

    kind: str
    amount: float
    allowed: float

    def __str__(self) -> str:
        return f"{self.kind} {self.amount:.1e} (allowed {self.allowed:.0e})"


@dataclass(frozen=True)
class Round(OneLine):
    """One solve of a program.

    Attributes
    ----------
    intervals : int
        Intervals of all phases.
    status : Status
    objective : float
    iterations : int
    seconds : float
        Building the program included [s].
    start : str
        What it started from, other than the guess or the last solution: a variation of the guess, softer friction ...
    lacked : str
        What the solution lacked; empty where it was not measured.
    response : str
        What followed; empty where the same mesh was solved again, or where the plan ended.
    number : int
        Number by which the rounds of several attempts are put in their order.
    """

    intervals: int
    status: Status
    objective: float
    iterations: int
    seconds: float
    start: str = ""
    lacked: str = ""
    response: str = ""
    number: int = field(default_factory=lambda: next(_NUMBERS), compare=False, repr=False)


@dataclass(frozen=True, repr=False)
class History(OneLine):
    """The rounds of a plan in their order; ``print(solution.history)`` shows one a line.

    Attributes
    ----------
    rounds : sequence of Round
    """

    rounds: Sequence[Round]

    def __iter__(self) -> Iterator[Round]:
        return iter(self.rounds)

    def __len__(self) -> int:
        return len(self.rounds)

    def __getitem__(self, index: int) -> Round:
        return self.rounds[index]

    @property
    def start(self) -> str:
        """The start that led to a solution last, other than the guess; empty where the guess did."""
        return next((each.start for each in reversed(self.rounds) if each.start and each.status is Status.SOLVED), "")

    def __str__(self) -> str:
        head = ("round", "intervals", "status", "iterations", "seconds", "objective", "start", "lacked", "response")
        rows = [
            (
                str(number),
                str(each.intervals),
                each.status.value,
                str(each.iterations),
                f"{each.seconds:.2f}",
                f"{each.objective:.7g}",
                each.start,
                each.lacked,
                each.response,
            )
            for number, each in enumerate(self.rounds, 1)
        ]
        filled = [i for i in range(len(head)) if any(row[i] for row in rows)]
        lines = [[row[i] for i in filled] for row in [head, *rows]]
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        return "\n".join("  ".join(map(str.ljust, line, widths)).rstrip() for line in lines)


def merged(first: Sequence[Round], second: Sequence[Round]) -> tuple[Round, ...]:
    """Return the rounds of two attempts in the order in which they were solved."""
    return tuple(sorted((*first, *second), key=lambda each: each.number))


def started_from(rounds: Sequence[Round], start: str) -> tuple[Round, ...]:
    """Return rounds that name their start, where they have none."""
    return tuple(each if each.start else replace(each, start=start) for each in rounds)


def answered(rounds: Sequence[Round], lacked: str, response: str) -> tuple[Round, ...]:
    """Return rounds whose last one has what it lacked and what followed."""
    return (*rounds[:-1], replace(rounds[-1], lacked=lacked, response=response)) if rounds else ()
