"""Limits on the time and the memory of a whole plan, read by a callback of the solvers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.time_left import LimitReached, used_time
from robotraj.fixed_mesh.diagnosis.memory import least_memory, resident
from robotraj.problem.problem import Problem
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Iteration, Progress
from robotraj.solvers.status import Status
from robotraj.transcription.schemes.mesh import Mesh

SHORT, SMALL = 0.2, 20.0
"""Seconds and megabytes of a call that is made whatever is left: the estimate would be less certain than the limit."""


class PlanLimits:
    """A progress callback that stops a plan at its limits of time and memory.

    Both are read at every iteration of a solver, and before every solve but the first one after ``begin``. So there is
    always an iterate to return. Building one program is interrupted while it waits for a compiler, and ends before a
    differentiation that would take longer than the time that is left (``require``).

    Parameters
    ----------
    seconds : float
        Processor time [s] from now on, of all threads of this process and of its compilers; may be infinite.
    megabytes : float
        Resident memory of this process [MB]; may be infinite.
    show : callable or None
        A further callback.

    Attributes
    ----------
    reached : Status or None
        The limit that ended the plan.
    """

    def __init__(self, seconds: float, megabytes: float, show: Progress | None) -> None:
        self._end, self._show = used_time() + seconds, show
        self._begun = False
        self.seconds, self.megabytes = seconds, megabytes
        self.reached: Status | None = None

    @property
    def left(self) -> float:
        """Time that is left [s]."""
        return self._end - used_time()

    @property
    def message(self) -> str:
        """The limit that was reached, in words."""
        if self.reached is Status.MEMORY_LIMIT:
            return f"the memory limit of {self.megabytes:g} MB was reached"
        return f"the time limit of {self.seconds:g} s was reached"

    def unseen(self, iteration: Iteration) -> None:
        """Read the limits without showing the iteration."""
        self._read()

    def __call__(self, iteration: Iteration) -> None:
        """Show an iteration, and read the clock and the memory.

        Raises
        ------
        LimitReached
            The time or the memory of the plan exceeds its limit.
        """
        if self._show is not None:
            self._show(iteration)
        self._read()

    def begin(self) -> None:
        """Let the next solve begin whatever the clock reads: without it there would be no iterate to return."""
        self._begun = False

    def before_solve(self, problem: Problem, mesh: Mesh | Sequence[Mesh]) -> None:
        """Read the clock, unless it is the first solve, and estimate the memory of the next program.

        Raises
        ------
        LimitReached
            The time is over, or a later program takes more memory than is left.
        InputError
            The first program takes more memory than is left.
        """
        if self._begun:
            self._read()
        if np.isfinite(self.megabytes):
            least, held = least_memory(problem, mesh), resident()
            if least + held > self.megabytes:
                if self._begun:
                    self._stop(Status.MEMORY_LIMIT)
                raise InputError(
                    f"memory_limit is {self.megabytes:g} MB, of which the process holds {held:.0f} MB; this mesh takes "
                    f"at least another {least:.1f} MB. Give fewer intervals or a larger limit."
                )
        self._begun = True

    def require(self, seconds: float, megabytes: float) -> None:
        """Raise ``LimitReached`` where a call would pass a limit; see ``time_left.require``."""
        if seconds > max(SHORT, self.left):
            self._stop(Status.TIME_LIMIT)
        if megabytes > SMALL and np.isfinite(self.megabytes) and resident() + megabytes > self.megabytes:
            self._stop(Status.MEMORY_LIMIT)

    def noted(self, solution: Solution) -> Solution:
        """Return a plan's solution with the limit that was reached; a proved motion is solved nevertheless."""
        if self.reached is None:
            return solution
        proved = solution.proof is not None and solution.proof.motion_holds
        status = Status.SOLVED if proved else self.reached
        return replace(solution, status=status, message=f"{solution.message}; {self.message}")

    def _read(self) -> None:
        if self.reached is not None:
            self._stop(self.reached)
        if used_time() > self._end:
            self._stop(Status.TIME_LIMIT)
        if np.isfinite(self.megabytes) and resident() > self.megabytes:
            self._stop(Status.MEMORY_LIMIT)

    def _stop(self, status: Status) -> None:
        self.reached = status
        raise LimitReached(self.message[0].upper() + self.message[1:] + ".")
