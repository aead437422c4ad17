"""A stage function y = fn(v, c) and its exact derivatives, built when first asked for.

Only these small SX graphs are ever differentiated; the NLP's derivatives follow by the chain rule (``block``,
``assembly``).
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, TypeAlias

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Pattern = tuple[NDArray[np.int_], NDArray[np.int_]]
Symbols: TypeAlias = Any


class Stage:
    """A function of unknowns v and constants c.

    Parameters
    ----------
    v, c, y : casadi.SX or casadi.MX
        Symbols of the unknowns (n_v,) and of the constants (n_c,), and the outputs (n_y,). SX is one scalar graph; MX
        may call functions that are none, such as integrators.
    costed : int or None
        The output that carries cost, if one does.
    """

    def __init__(self, v: Symbols, c: Symbols, y: Symbols, costed: int | None = None) -> None:
        self._v, self._c, self._y = v, c, ca.densify(y)
        self.costed = costed
        self.function = ca.Function("stage", [v, c], [self._y], ["v", "c"], ["y"])

    @property
    def inputs(self) -> int:
        """n_v."""
        return int(self._v.numel())

    @property
    def outputs(self) -> int:
        """n_y."""
        return int(self._y.numel())

    @cached_property
    def cost(self) -> ca.Function:
        """(v, c) -> the costed output."""
        return ca.Function("cost", [self._v, self._c], [self._y[self.costed]])

    @cached_property
    def gradient(self) -> ca.Function:
        """(v, c) -> gradient of the costed output, (n_v,)."""
        return ca.Function("gradient", [self._v, self._c], [ca.densify(ca.gradient(self._y[self.costed], self._v))])

    @cached_property
    def _jacobian(self) -> tuple[ca.Function, Pattern]:
        matrix = ca.jacobian(self._y, self._v)
        return ca.Function("jacobian", [self._v, self._c], [_nonzeros(matrix)]), _pattern(matrix.sparsity())

    @property
    def jacobian(self) -> ca.Function:
        """(v, c) -> nonzeros of dy/dv, a dense column."""
        return self._jacobian[0]

    @property
    def jacobian_pattern(self) -> Pattern:
        """Rows and columns of ``jacobian``'s output."""
        return self._jacobian[1]

    @cached_property
    def _hessian(self) -> tuple[ca.Function, Pattern]:
        m = type(self._v).sym("m", self.outputs)
        matrix = ca.tril(ca.hessian(ca.dot(m, self._y), self._v)[0])
        return ca.Function("hessian", [self._v, self._c, m], [_nonzeros(matrix)]), _pattern(matrix.sparsity())

    @property
    def hessian(self) -> ca.Function:
        """(v, c, m) -> nonzeros of the lower triangle of d^2(m' y)/dv^2, a dense column."""
        return self._hessian[0]

    @property
    def hessian_pattern(self) -> Pattern:
        """Rows and columns of ``hessian``'s output."""
        return self._hessian[1]


def _nonzeros(matrix: Symbols) -> Symbols:
    return ca.densify(matrix.nz[:]) if matrix.nnz() else type(matrix)(0, 1)


def _pattern(sparsity: ca.Sparsity) -> Pattern:
    rows, columns = sparsity.get_triplet()
    return np.array(rows, dtype=int), np.array(columns, dtype=int)
