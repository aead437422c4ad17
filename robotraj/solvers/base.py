"""What a solver is: a value that takes an Nlp and returns where it stopped and why."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.solvers.status import Status

if TYPE_CHECKING:
    from robotraj.transcription.nlp import Nlp

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Iteration:
    """What a solver tells while it runs: number, objective and largest violated scaled row."""

    number: int
    objective: float
    infeasibility: float


Progress = Callable[[Iteration], None]


@dataclass(frozen=True, eq=False)
class Origin:
    """What is kept of a solve, for others like it.

    Attributes
    ----------
    nlp : Nlp
    w : ndarray (n_w,)
        Where it ended, in physical units.
    """

    nlp: Nlp
    w: Array


@dataclass(frozen=True, eq=False)
class Multipliers(OneLine):
    """Multipliers of rows (n_g,) and of variable bounds (n_w,), in physical units: grad f + J' rows + bounds = 0.

    Physical units carry them from one scaling to the next, as a warm start needs.
    """

    rows: Array
    bounds: Array

    @property
    def sizes(self) -> tuple[int, int]:
        """n_g and n_w."""
        return len(self.rows), len(self.bounds)

    @property
    def origin(self) -> Origin | None:
        """What the solver that found them keeps, to start from it again."""
        return None

    @property
    def plain(self) -> Multipliers:
        """The numbers alone."""
        return self


class LateMultipliers(Multipliers):
    """Multipliers found when they are first read: a solver that eliminated rows gets theirs by a further solve.

    Parameters
    ----------
    find : callable
        Gives them.
    sizes : (int, int)
    origin : Origin, optional
    """

    def __init__(self, find: Callable[[], Multipliers], sizes: tuple[int, int], origin: Origin | None = None) -> None:
        self.__dict__.update(find=find, _sizes=sizes, _origin=origin)

    @cached_property
    def plain(self) -> Multipliers:
        """The numbers alone."""
        find: Callable[[], Multipliers] = self.__dict__["find"]
        return find()

    @property
    def sizes(self) -> tuple[int, int]:
        """n_g and n_w."""
        sizes: tuple[int, int] = self.__dict__["_sizes"]
        return sizes

    @property
    def origin(self) -> Origin | None:
        """What the solver that found them keeps."""
        origin: Origin | None = self.__dict__["_origin"]
        return origin

    @property
    def rows(self) -> Array:
        """Of rows (n_g,)."""
        return self.plain.rows

    @property
    def bounds(self) -> Array:
        """Of variable bounds (n_w,)."""
        return self.plain.bounds

    def __reduce__(self) -> tuple[Any, ...]:
        # What comes back from another process holds the numbers alone.
        return Multipliers, (self.rows, self.bounds)


@dataclass(frozen=True, eq=False)
class Outcome:
    """Where a solver stopped.

    Attributes
    ----------
    status : Status
    message : str
        The solver's own words.
    w : ndarray (n_w,)
        Last iterate, in physical units.
    multipliers : Multipliers
    iterations : int
    times : dict of str to float
        Seconds: ``"setup"``, ``"solve"``; what is part of another entry is named after it, ``"solve: functions"``.
    """

    status: Status
    message: str
    w: Array
    multipliers: Multipliers
    iterations: int
    times: dict[str, float] = field(default_factory=dict)


class Solver(OneLine, ABC):
    """A solver and its options, as one frozen value. A new solver is one new file."""

    @property
    def stagewise(self) -> bool:
        """Whether it works stage by stage: it calls native functions itself, and rows within a stage cost it little."""
        return False

    def at_most(self, iterations: int) -> Solver:
        """Return this solver with no more than these iterations; itself where it counts none."""
        return self

    def from_nearby(self) -> Solver:
        """Give the same solver for a start near the optimum, such as the solution on a coarser mesh."""
        return self

    def resolve(
        self, nlp: Nlp, known: Multipliers, progress: Progress | None = None, multipliers: Multipliers | None = None
    ) -> Outcome:
        """Solve an NLP like one that was solved before, with what the solver has from then.

        Parameters
        ----------
        nlp : Nlp
            That differs from the earlier one in bounds, fixed values or guess; where it differs in more, this is
            ``solve``.
        known : Multipliers
            The earlier outcome's, whose ``origin`` is what the solver kept.
        progress, multipliers
            As for ``solve``.
        """
        return self.solve(nlp, progress, multipliers)

    def within(self, seconds: float) -> Solver:
        """Give the same solver with at most so many wall-clock seconds a solve; one without a clock gives itself."""
        return self

    def sharper(self, factor: float) -> Solver:
        """Give the same solver, leaving ``factor`` of what it leaves of the objective; one without a say gives itself.

        An interior-point method stops where multiplier times distance from its bound is small, bound by bound: the
        finer the mesh, the more bounds there are.
        """
        return self

    @abstractmethod
    def solve(self, nlp: Nlp, progress: Progress | None = None, multipliers: Multipliers | None = None) -> Outcome:
        """Solve from ``nlp.guess``; keep the last iterate whatever happens.

        Parameters
        ----------
        nlp : Nlp
        progress : callable, optional
            Called once an iteration.
        multipliers : Multipliers, optional
            Of an earlier solution, for a warm start.
        """
