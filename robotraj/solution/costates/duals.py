"""Duals of a phase as functions of time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, overload

from robotraj._util.printing import OneLine
from robotraj._util.trajectory import PiecewisePolynomial
from robotraj._util.values import dataclass


@dataclass(frozen=True, eq=False)
class PhaseDuals(OneLine):
    """Duals of one phase, in global time, for the Hamiltonian H = l + lambda' f + nu' g + eta' h.

    Attributes
    ----------
    costate : PiecewisePolynomial
        lambda, one per state; it may jump at its breaks.
    residual : PiecewisePolynomial
        nu, one per algebraic row.
    path : PiecewisePolynomial
        Densities eta of the rows held throughout that are not single variables; positive at an upper bound.
    states, algebraic, controls : PiecewisePolynomial
        Densities of the bounds of the variables at the nodes; positive at an upper bound.
    """

    costate: PiecewisePolynomial
    residual: PiecewisePolynomial
    path: PiecewisePolynomial
    states: PiecewisePolynomial
    algebraic: PiecewisePolynomial
    controls: PiecewisePolynomial


class LateDuals(Sequence[PhaseDuals]):
    """Duals of all phases, computed when they are first read: most plans need none.

    Parameters
    ----------
    find : callable
        Gives them.
    count : int
        How many there will be.
    """

    def __init__(self, find: Callable[[], tuple[PhaseDuals, ...]], count: int) -> None:
        self._find: Callable[[], tuple[PhaseDuals, ...]] | None = find
        self._found: tuple[PhaseDuals, ...] = ()
        self._count = count

    def _all(self) -> tuple[PhaseDuals, ...]:
        if self._find is not None:
            # The callable holds the whole NLP; release it.
            self._found, self._find = self._find(), None
        return self._found

    @overload
    def __getitem__(self, index: int) -> PhaseDuals: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[PhaseDuals, ...]: ...
    def __getitem__(self, index: int | slice) -> PhaseDuals | tuple[PhaseDuals, ...]:
        return self._all()[index]

    def __len__(self) -> int:
        return self._count

    def __reduce__(self) -> tuple[Any, ...]:
        # A copy, or a solution that comes back from another process, holds the duals themselves.
        return tuple, (self._all(),)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self)} phases>"
