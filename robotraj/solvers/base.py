"""What a solver is: a value that takes an Nlp and returns where it stopped and why."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj.status import Status

if TYPE_CHECKING:
    from robotraj.transcription import Nlp

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Iteration:
    """What a solver tells while it runs: number, objective and largest violated scaled row."""

    number: int
    objective: float
    infeasibility: float


Progress = Callable[[Iteration], None]


@dataclass(frozen=True, eq=False)
class Multipliers:
    """Multipliers of rows (n_g,) and of variable bounds (n_w,), in physical units: grad f + J' rows + bounds = 0.

    Physical units carry them from one scaling to the next, as a warm start needs.
    """

    rows: Array
    bounds: Array


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


class Solver(ABC):
    """A solver and its options, as one frozen value. A new solver is one new file."""

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
