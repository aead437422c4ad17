"""Entries of problems that ended without a solution: an error, a process that died, a limit of the operating system."""

from __future__ import annotations

import signal
from typing import ClassVar

import numpy as np

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.applications.many.processes import WorkerDied
from robotraj.fixed_mesh.diagnosis.memory import is_shortage
from robotraj.solvers.status import Status

TIMERS = (signal.SIGALRM, signal.SIGPROF)
"""Signals of the operating system's timers, which end a process."""


@dataclass(frozen=True)
class Failure(OneLine):
    """A problem of many that ended without a ``Solution``; the other problems are not affected.

    Attributes
    ----------
    number : int
        Number of the problem.
    status : Status
        ``Status.ERROR`` where its equations or its statement raised an error, ``Status.DIED`` where its process ended,
        ``Status.TIME_LIMIT`` or ``Status.MEMORY_LIMIT`` where the operating system ended it.
    message : str
        What happened: the error with its kind, or how the process ended.
    """

    number: int
    status: Status
    message: str

    success: ClassVar[bool] = False
    objective: ClassVar[float] = np.nan
    iterations: ClassVar[int] = 0
    seconds: ClassVar[float] = 0.0

    @property
    def cause(self) -> str:
        """The message, as of a ``Solution``."""
        return self.message

    def __str__(self) -> str:
        return f"problem {self.number}: {self.status.value}, {self.message}. {self.status.remedy}"


def failure_of(number: int, error: BaseException) -> Failure:
    """Return the entry of an error that a problem raised, or of the end of its process."""
    if isinstance(error, WorkerDied) and error.code is not None and -error.code in TIMERS:
        return Failure(number, Status.TIME_LIMIT, "the operating system's timer ended it, since it passed its limit")
    text = str(error).strip().rstrip(".")
    if is_shortage(error):
        return Failure(number, Status.MEMORY_LIMIT, f"no memory was left within its limit: {text or 'MemoryError'}")
    if isinstance(error, WorkerDied):
        return Failure(number, Status.DIED, text)
    return Failure(number, Status.ERROR, f"{type(error).__name__}: {text}")
