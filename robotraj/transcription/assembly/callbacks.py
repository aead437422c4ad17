"""Functions of the NLP that CasADi calls and NumPy evaluates."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from threading import Lock

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class NlpFunction(ca.Callback):
    """A function of dense vectors whose results have fixed patterns; only those that are wanted are evaluated.

    Parameters
    ----------
    name : str
    arguments : mapping of str to int
        Their lengths.
    results : mapping of str to (Sparsity, callable)
        The pattern, and what gives the nonzeros for the arguments; a RuntimeError of it is "no such value here".
    lock : Lock
        Held during an evaluation: functions with the same one share memory.
    """

    def __init__(
        self,
        name: str,
        arguments: Mapping[str, int],
        results: Mapping[str, tuple[ca.Sparsity, Callable[..., Array]]],
        lock: Lock,
    ) -> None:
        ca.Callback.__init__(self)
        self._arguments, self._lock = list(arguments.items()), lock
        self._names, self._results = list(results), list(results.values())
        self.construct(name, {})

    def get_n_in(self) -> int:
        """Count the arguments."""
        return len(self._arguments)

    def get_n_out(self) -> int:
        """Count the results."""
        return len(self._results)

    def get_name_in(self, i: int) -> str:
        """Name an argument."""
        return self._arguments[i][0]

    def get_name_out(self, i: int) -> str:
        """Name a result."""
        return self._names[i]

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        """Say that arguments are dense."""
        return ca.Sparsity.dense(self._arguments[i][1], 1)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        """Give a result's pattern."""
        return self._results[i][0]

    def has_eval_buffer(self) -> bool:
        """Say that memory is handed over, not copied."""
        return True

    def eval_buffer(self, arguments: Sequence[memoryview | None], results: Sequence[memoryview | None]) -> int:
        """Evaluate what is wanted; 1 where that cannot be done."""
        # What is not given is zero.
        given = [
            np.frombuffer(argument) if argument is not None and len(argument) else np.zeros(length)
            for argument, (_, length) in zip(arguments, self._arguments, strict=True)
        ]
        try:
            with self._lock:
                for result, (_, evaluate) in zip(results, self._results, strict=True):
                    if result is not None and len(result):
                        np.frombuffer(result)[:] = evaluate(*given)
        except RuntimeError:
            return 1
        return 0
