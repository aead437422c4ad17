"""Time limit of a whole plan: building, solves on all meshes, other beginnings and diagnosis together."""

from __future__ import annotations

import time

from robotraj.solvers.base import Iteration, Progress


class TimeLimitReached(KeyboardInterrupt):
    """Raised at the time limit. It ends a plan as Ctrl-C does: what was found so far is kept."""


class Deadline:
    """A progress callback that stops a plan at its time limit.

    The clock is read at every iteration of a solver and before every solve but the first one after ``begin``, so that
    there is always an iterate to return. Building one program is not interrupted.

    Parameters
    ----------
    seconds : float
        Processor time [s] from now on, of all threads of this process.
    show : callable or None
        A further callback.
    """

    def __init__(self, seconds: float, show: Progress | None) -> None:
        self._end, self._show = time.process_time() + seconds, show
        self._begun = False
        self.seconds = seconds
        self.reached = False

    def __call__(self, iteration: Iteration) -> None:
        """Show an iteration and read the clock.

        Raises
        ------
        TimeLimitReached
        """
        if self._show is not None:
            self._show(iteration)
        self._read()

    def begin(self) -> None:
        """Let the next solve begin in any case: without it there would be no iterate to return."""
        self._begun = False

    def before_solve(self) -> None:
        """Read the clock, unless it is the first solve.

        Raises
        ------
        TimeLimitReached
        """
        if self._begun:
            self._read()
        self._begun = True

    def _read(self) -> None:
        if time.process_time() > self._end:
            self.reached = True
            raise TimeLimitReached(f"The time limit of {self.seconds:g} s was reached.")
