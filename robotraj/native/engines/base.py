"""The engine's interface: a value that evaluates point functions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import casadi as ca

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.native.engines.blocks import StageFunctions, casadi_block
from robotraj.native.engines.blocks import wanted as wanted_of

if TYPE_CHECKING:
    from robotraj.native import PointBlock


@dataclass(frozen=True, eq=False)
class Mapped(OneLine):
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


@dataclass(frozen=True, eq=False)
class StageMapped(OneLine):
    """A function of a stage and the number of points it is evaluated at; its graph is built on first access.

    Attributes
    ----------
    stage : PointFunctions
    name : str
        ``"function"``, ``"jacobian"``, ``"hessian"``, ``"cost"`` or ``"gradient"``.
    count : int
        Points, E.
    """

    stage: StageFunctions
    name: str
    count: int

    @property
    def function(self) -> ca.Function:
        """Dense columns (n_i,) -> (n_y,), one result."""
        function: ca.Function = getattr(self.stage, self.name)
        return function


class Engine(OneLine, ABC):
    """An evaluator of point functions; all engines return the same numbers up to rounding.

    Attributes
    ----------
    separate_torques : bool
        Whether stages represent inverse dynamics by symbols, so that their graph is not built.
    made_for_ipopt : bool
        Whether the engine caches the functions that IPOPT calls; IPOPT is then the default solver.
    """

    separate_torques: ClassVar[bool] = False
    made_for_ipopt: ClassVar[bool] = False

    @abstractmethod
    def prepare(self, wanted: Sequence[Mapped | StageMapped]) -> list[ca.Function]:
        """Return, for each entry, a function of E columns: (n_i, E) -> (n_y, E)."""

    @abstractmethod
    def block(self, stage: StageFunctions, count: int, costs: bool) -> PointBlock:
        """Return the point functions of a stage at ``count`` points for the compiled solver.

        Parameters
        ----------
        stage : PointFunctions
        count : int
        costs : bool
            Whether its costed output is part of the objective.
        """


@dataclass(frozen=True)
class VirtualMachine(Engine):
    """CasADi's virtual machine, which needs no compiler."""

    def prepare(self, wanted: Sequence[Mapped | StageMapped]) -> list[ca.Function]:
        """Map each function over its columns."""
        return [each.function.map(each.count) for each in wanted]

    def block(self, stage: StageFunctions, count: int, costs: bool) -> PointBlock:
        """Evaluate one point at a time."""
        functions = wanted_of(stage, costs)
        return casadi_block(stage, count, costs, {name: (f, 1) for name, f in functions.items()})
