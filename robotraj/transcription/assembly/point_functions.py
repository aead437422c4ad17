"""A point function y = fn(v, c), also called a stage, and its exact derivatives, built on first use.

Only these small graphs are differentiated. The derivatives of the NLP follow by the chain rule (``block``,
``assembly``).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.time_left import LimitReached, is_limited
from robotraj.dynamics.contact_terms import SymbolicAddend, extract_addends, insert_graphs
from robotraj.dynamics.torque_symbols import Torques
from robotraj.native.build import load_native
from robotraj.native.stage_tapes import Tapes
from robotraj.native.torque_chain import TorqueChain
from robotraj.transcription.assembly.differentiation_cost import (
    HESSIAN,
    HESSIAN_OF_CALLS,
    JACOBIAN,
    JACOBIAN_OF_CALLS,
    Cost,
    operations,
)

if TYPE_CHECKING:
    from robotraj.native._native import RigidTree, StageGraph

Pattern = tuple[NDArray[np.int_], NDArray[np.int_]]
Symbols: TypeAlias = ca.SX | ca.MX


class PointFunctions:
    """A function of unknowns v and constants c.

    Parameters
    ----------
    v, c, y : casadi.SX or casadi.MX
        Symbols of the unknowns (n_v,) and of the constants (n_c,), and the outputs (n_y,). A graph of MX may call
        functions that have no scalar graph, such as integrators.
    costed : int or None
        Index of the output that is part of the objective, if there is one.
    torques : Torques, optional
        The robot's inverse dynamics, for which y contains symbols. Engines that evaluate it natively do not build or
        differentiate its graph. The functions below are the same with and without.
    addends : sequence of SymbolicAddend
        Terms of contacts, for which y contains symbols too; other point functions share them.
    as_tapes : bool
        Whether the engine of the NLP runs tapes, so that functions are built as tapes only. Functions with torques
        always are.
    places : int, optional
        Number of places, for a graph whose outputs depend on all unknowns by long expressions, such as integrated
        forward dynamics. The cost of its derivatives is then announced to the limits of the plan.
    """

    def __init__(
        self,
        v: Symbols,
        c: Symbols,
        y: Symbols,
        costed: int | None = None,
        torques: Torques | None = None,
        addends: Sequence[SymbolicAddend] = (),
        as_tapes: bool = False,
        places: int | None = None,
    ) -> None:
        self.v, self.c, self._y = v, c, y if y.is_dense() else ca.densify(y)
        self.costed = costed
        self.torques = torques if torques is None or torques.are_in(self._y) else None
        self._addends, self.as_tapes, self._places = addends, as_tapes, places

    @cached_property
    def y(self) -> Symbols:
        """The outputs with the terms of contacts substituted; the symbols of torques remain."""
        return insert_graphs(self._y, self._addends)

    @cached_property
    def graph(self) -> StageGraph:
        """The function as a graph of the compiled module, which differentiates it; only for SX."""
        return self._graph_of(self.y)

    @cached_property
    def tapes(self) -> Tapes | None:
        """Tapes of the function and its derivatives, torques included; None if it has no scalar graph."""
        if not isinstance(self.v, ca.SX):
            return None
        tapes = Tapes(self.graph, self.costed) if self.torques is None else self._chain(self.torques.tree)
        return tapes if tapes.runs else None

    def _chain(self, tree: RigidTree) -> TorqueChain:
        rest, added = (
            extract_addends(self._y, ca.vertcat(self.v, self.c), self._addends) if self._addends else (self.y, [])
        )
        return TorqueChain(self._graph_of(rest) if added else self.graph, self.costed, tree, added)

    def _graph_of(self, y: ca.SX) -> StageGraph:
        made: StageGraph = load_native().StageGraph(self._with_torques_as_symbols(y).serialize())
        return made

    def _with_torques_as_symbols(self, y: ca.SX) -> ca.Function:
        nothing = ca.SX(0, 1)
        r, x = (nothing, nothing) if self.torques is None else (self.torques.symbols, self.torques.arguments)
        return ca.Function("stage", [self.v, self.c, r], [y, x])

    @property
    def _wanted(self) -> Tapes | None:
        return self.tapes if self.torques is not None or self.as_tapes else None

    @cached_property
    def constant_slopes(self) -> Array:
        """dy/dv (n_y, n_v): constants, and NaN for entries that are expressions."""
        slopes: Array = self.graph.constant_slopes().reshape(self.inputs, self.outputs).T
        return slopes

    @cached_property
    def _whole(self) -> Symbols:
        """The outputs as functions of v and c alone."""
        return self.y if self.torques is None else self.torques.with_graph(self.y)

    @cached_property
    def function(self) -> ca.Function:
        """(v, c) -> y."""
        return ca.Function("stage", [self.v, self.c], [self._whole], ["v", "c"], ["y"])

    def evaluate(self, name: str, v: Array, c: Array) -> Array:
        """Evaluate ``"function"`` or ``"jacobian"`` at E places: (n_v, E), (n_c, E) -> (m, E)."""
        if self._wanted is None:
            return evaluated(getattr(self, name), v, c)
        if name == "function":
            try:
                _ = self._jacobian_fits
            except LimitReached:
                # Tapes are evaluated together with their Jacobian, for which no time is left.
                return evaluated(self.function, v, c)
        return self._wanted.evaluate("values" if name == "function" else name, v, c)

    @property
    def inputs(self) -> int:
        """n_v."""
        return int(self.v.numel())

    @property
    def outputs(self) -> int:
        """n_y."""
        return int(self._y.numel())

    @cached_property
    def cost(self) -> ca.Function:
        """(v, c) -> the costed output."""
        return ca.Function("cost", [self.v, self.c], [self._whole[self.costed]])

    @cached_property
    def gradient(self) -> ca.Function:
        """(v, c) -> gradient of the costed output, (n_v,)."""
        return ca.Function("gradient", [self.v, self.c], [ca.densify(ca.gradient(self._whole[self.costed], self.v))])

    @cached_property
    def _operations(self) -> int:
        """Operations of the graph that CasADi differentiates; those of torques are not part of tapes."""
        return operations(self.function if self._wanted is None else self._with_torques_as_symbols(self.y))

    @cached_property
    def _jacobian_fits(self) -> bool:
        """True; raises LimitReached where the plan has no time or memory for the Jacobian."""
        return self._fits(JACOBIAN, JACOBIAN_OF_CALLS)

    @cached_property
    def _hessian_fits(self) -> bool:
        """True; raises LimitReached where the plan has no time or memory for the Hessian."""
        return self._fits(HESSIAN, HESSIAN_OF_CALLS)

    def _fits(self, scalar: Cost, calls: Cost) -> bool:
        if self._places is not None and is_limited():
            if isinstance(self.v, ca.SX):
                scalar.announce(self._operations, self.inputs)
            else:
                calls.announce(self._operations * self._places, self.inputs)
        return True

    @cached_property
    def _jacobian(self) -> tuple[ca.Function, Pattern]:
        matrix = ca.jacobian(self._whole, self.v)
        if self._wanted is not None:
            matrix = _spread(matrix, self._wanted.jacobian_pattern)
        return ca.Function("jacobian", [self.v, self.c], [_nonzeros(matrix)]), _pattern(matrix.sparsity())

    @property
    def jacobian(self) -> ca.Function:
        """(v, c) -> nonzeros of dy/dv, a dense column."""
        return self._jacobian[0]

    @property
    def jacobian_pattern(self) -> Pattern:
        """Rows and columns of the nonzeros of ``jacobian``."""
        _ = self._jacobian_fits
        return self._jacobian[1] if self._wanted is None else self._wanted.jacobian_pattern

    @cached_property
    def _hessian(self) -> tuple[ca.Function, Pattern]:
        m = type(self.v).sym("m", self.outputs)
        matrix = ca.tril(ca.hessian(ca.dot(m, self._whole), self.v)[0])
        if self._wanted is not None:
            matrix = _spread(matrix, self._wanted.hessian_pattern)
        return ca.Function("hessian", [self.v, self.c, m], [_nonzeros(matrix)]), _pattern(matrix.sparsity())

    @property
    def hessian(self) -> ca.Function:
        """(v, c, m) -> nonzeros of the lower triangle of d^2(m' y)/dv^2, a dense column."""
        return self._hessian[0]

    @property
    def hessian_pattern(self) -> Pattern:
        """Rows and columns of the nonzeros of ``hessian``."""
        _ = self._hessian_fits
        return self._hessian[1] if self._wanted is None else self._wanted.hessian_pattern


def evaluated(function: ca.Function, *arguments: Array) -> Array:
    """Evaluate a function of dense columns at E places: arguments (n_i, E), result (m, E).

    CasADi reads and writes the arrays in place. A conversion to its matrices would take longer than a small function.
    """
    count = arguments[0].shape[1]
    result = np.empty((count, int(function.numel_out(0))))
    if not result.size:
        return result.T
    buffer, run = function.map(count).buffer()
    given = [np.ascontiguousarray(argument.T, dtype=float) for argument in arguments]
    for i, argument in enumerate(given):
        if argument.size:
            buffer.set_arg(i, argument.data)
    buffer.set_res(0, result.data)
    run()
    return result.T


def _spread(matrix: Symbols, pattern: Pattern) -> Symbols:
    """Return a matrix with the pattern of its tape: zeros are added, and entries that are always zero are dropped."""
    rows, columns = pattern
    return ca.project(matrix, ca.Sparsity.triplet(*matrix.shape, rows.tolist(), columns.tolist()))


def _pattern(sparsity: ca.Sparsity) -> Pattern:
    rows, columns = sparsity.get_triplet()
    return np.array(rows, dtype=int), np.array(columns, dtype=int)


def _nonzeros(matrix: Symbols) -> Symbols:
    """Return the nonzeros of a matrix as a dense column."""
    found = matrix.nz[:]
    # CasADi returns the nonzeros of a row vector as a row.
    return found if found.is_column() else found.T
