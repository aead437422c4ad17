"""The callback that IPOPT calls once an iteration."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import casadi as ca
import numpy as np

from robotraj._util.system.interrupts import note
from robotraj.solvers.base import Iteration, Origin, Progress


class IterationCallback(ca.Callback):
    """A callback of IPOPT that keeps the iterate, reports progress and stops on Ctrl-C.

    Parameters
    ----------
    n_w : int
        Number of variables.
    lower, upper : ndarray (n_g,)
        Bounds of the scaled rows.
    progress : callable or None
        Called once an iteration.
    origin : callable
        Turns a scaled iterate into the data of the solve.

    Attributes
    ----------
    last : ndarray (n_w,) or None
        Last finite iterate, scaled.
    stop : bool
        Whether IPOPT is to stop.
    error : Exception or None
        Error of ``progress``, to be raised after the solve.
    """

    def __init__(
        self,
        n_w: int,
        lower: np.ndarray,
        upper: np.ndarray,
        progress: Progress | None,
        origin: Callable[[np.ndarray], Origin],
    ) -> None:
        ca.Callback.__init__(self)
        n_g = len(lower)
        self._lower, self._upper = lower, upper
        self._sizes = {"x": n_w, "f": 1, "g": n_g, "lam_x": n_w, "lam_g": n_g, "lam_p": 0}
        self._progress, self._origin = progress, origin
        self._count = 0
        self.last: np.ndarray | None = None
        self.stop = False
        self.error: Exception | None = None
        self.construct("watch", {})

    def get_n_in(self) -> int:
        """Return the number of results of a solver."""
        return int(ca.nlpsol_n_out())

    def get_n_out(self) -> int:
        """Return 1: whether IPOPT is to stop."""
        return 1

    def get_name_in(self, i: int) -> str:
        """Return the name of a result."""
        return str(ca.nlpsol_out(i))

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        """Return the pattern of a result, dense."""
        size = self._sizes.get(str(ca.nlpsol_out(i)), 0)
        return ca.Sparsity.dense(size, 1) if size else ca.Sparsity(0, 0)

    def eval(self, arguments: Sequence[ca.DM]) -> list[int]:
        """Keep the iterate and report it."""
        if not self.stop:
            named = {str(ca.nlpsol_out(i)): value for i, value in enumerate(arguments)}
            point = np.array(named["x"]).ravel()
            if np.all(np.isfinite(point)):
                self.last = point
            if self._progress is not None:
                g = np.array(named["g"]).ravel()
                broken = np.maximum(self._lower - g, g - self._upper)
                violation = float(np.max(broken, initial=0.0))
                self._report(Iteration(self._count, float(named["f"]), violation, lambda: self._origin(point)))
            self._count += 1
        return [int(self.stop)]

    def _report(self, iteration: Iteration) -> None:
        """Call the progress callback. Its error is raised after the solve, since CasADi would only print it."""
        assert self._progress is not None
        try:
            self._progress(iteration)
        except KeyboardInterrupt:
            self.stop = True
        except Exception as error:
            self.stop, self.error = True, error

    @contextmanager
    def interruptible(self) -> Iterator[None]:
        """Turn Ctrl-C into a request to stop, where signals can be caught."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return

        def request(*_: object) -> None:
            note()
            self.stop = True

        previous = signal.signal(signal.SIGINT, request)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, previous)
