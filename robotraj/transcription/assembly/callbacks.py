"""Functions of the NLP with CasADi's interface, evaluated by NumPy."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from threading import Lock

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array


class NlpFunction(ca.Callback):
    """A function of dense vectors whose results have fixed patterns; only requested results are evaluated.

    Parameters
    ----------
    name : str
    arguments : mapping of str to int
        Lengths of the arguments.
    results : mapping of str to (Sparsity, callable)
        Patterns, and functions from the arguments to the nonzeros. They raise RuntimeError where they are not defined.
    lock : Lock
        Lock during an evaluation; functions that share memory share a lock.
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
        """Return the number of arguments."""
        return len(self._arguments)

    def get_n_out(self) -> int:
        """Return the number of results."""
        return len(self._results)

    def get_name_in(self, i: int) -> str:
        """Return the name of an argument."""
        return self._arguments[i][0]

    def get_name_out(self, i: int) -> str:
        """Return the name of a result."""
        return self._names[i]

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        """Return the pattern of an argument, which is dense."""
        return ca.Sparsity.dense(self._arguments[i][1], 1)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        """Return the pattern of a result."""
        return self._results[i][0]

    def has_eval_buffer(self) -> bool:
        """Return True: CasADi passes its memory, without copies."""
        return True

    def eval_buffer(self, arguments: Sequence[memoryview | None], results: Sequence[memoryview | None]) -> int:
        """Evaluate the requested results; return 1 if one is not defined, else 0."""
        # CasADi passes None for arguments that are zero.
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
