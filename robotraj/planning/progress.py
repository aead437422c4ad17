"""Callbacks of solvers: progress in one line of a terminal, and the time limit of a whole plan."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from robotraj.solvers.base import Iteration, Progress, Solver


@contextmanager
def watching(solver: Solver, show: bool | None) -> Iterator[Progress | None]:
    """Give a callback that shows iterations, or None where nobody watches."""
    if show is False or (show is None and not sys.stderr.isatty()):
        yield None
        return
    from rich.console import Console
    from rich.status import Status as Spinner

    console = Console(stderr=True)
    name = type(solver).__name__
    with Spinner(f"{name}: starting", console=console) as spinner:

        def update(iteration: Iteration) -> None:
            spinner.update(
                f"{name}: iteration {iteration.number}, objective {iteration.objective:.6g}, "
                f"largest violated row {iteration.infeasibility:.1e}"
            )

        yield update


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
