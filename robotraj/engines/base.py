"""What an engine is: a value that says how point functions are evaluated."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True, eq=False)
class Mapped:
    """A point function and the number of points it is evaluated at.

    Attributes
    ----------
    function : casadi.Function
        Dense columns (n_i,) -> (n_y,), one result.
    count : int
        Points, E.
    """

    function: ca.Function
    count: int


class Engine(ABC):
    """How point functions are evaluated; every engine gives the same numbers."""

    @abstractmethod
    def prepare(self, wanted: Sequence[Mapped]) -> list[ca.Function]:
        """Give, for each entry, a function of E columns: (n_i, E) -> (n_y, E)."""


@dataclass(frozen=True)
class VirtualMachine(Engine):
    """CasADi's virtual machine: at once, on any machine, without a compiler. The default."""

    def prepare(self, wanted: Sequence[Mapped]) -> list[ca.Function]:
        """Map each function over its columns, one after the other."""
        return [each.function.map(each.count) for each in wanted]
