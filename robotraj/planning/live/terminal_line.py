"""``rt.plan(..., progress=True)``: the iterations of a solver in one line of a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from robotraj.solvers.base import Iteration, Progress, Solver


@contextmanager
def watching(solver: Solver, show: bool | None) -> Iterator[Progress | None]:
    """Yield a callback that shows iterations, or None if they are not shown."""
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
