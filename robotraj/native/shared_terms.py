"""Functions that several stages add to some of their rows; their tapes are written once.

    y = psi(v, c, r) + sum_k S_k s_k(u_k),    u_k some entries of (v, c),    S_k one row of y for every entry of s_k

Example: the forces of a contact in a robot's equations, where a foot is in contact in several phases. The tapes of s_k,
of its Jacobian and of the Hessian of l' s_k are shared. A stage has its own indices of u_k and of rows.
"""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.native.build import load_native
from robotraj.native.sparse_products import Entries, Indices, Sums, copied

if TYPE_CHECKING:
    from collections.abc import Sequence

    from robotraj.native._native import Call, StageGraph, Tape

Pattern = tuple[Indices, Indices]
NO_POSITIONS: Indices = np.zeros(0, dtype=np.int64)


class Addend:
    """A function s(u) and its derivatives as tapes, each written when it is first used.

    Parameters
    ----------
    u : casadi.SX
        Symbols, (n_u,).
    s : casadi.SX
        (n_s,), a scalar graph.
    """

    def __init__(self, u: ca.SX, s: ca.SX) -> None:
        self.u, self.s = u, ca.densify(s)

    @cached_property
    def function(self) -> ca.Function:
        """The function u -> s."""
        return ca.Function("addend", [self.u], [self.s])

    @cached_property
    def graph(self) -> StageGraph:
        """The graph of the compiled module, which differentiates it: a stage without constants and torques."""
        none = ca.SX(0, 1)
        stage = ca.Function("addend", [self.u, none, none], [self.s, none])
        made: StageGraph = load_native().StageGraph(stage.serialize())
        return made

    @cached_property
    def values(self) -> tuple[Tape, int]:
        """The tape of s and the number of its results."""
        return self.graph.values(), self.graph.outputs

    @cached_property
    def jacobian(self) -> tuple[Tape, Pattern]:
        """The tape of the nonzeros of ds/du, and their rows and columns."""
        made, by_u, _ = self.graph.slopes()
        return made, by_u

    @cached_property
    def hessian(self) -> tuple[Tape, Pattern]:
        """The tape (u, l) of the nonzeros of the lower triangle of d^2(l' s)/du^2, and their rows and columns."""
        made, _, by_u, _, _ = self.graph.curvature()
        return made, by_u


@dataclass(frozen=True, eq=False)
class Added:
    """An addend in a stage.

    Attributes
    ----------
    addend : Addend
    inputs : ndarray of int (n_u,)
        The index in (v, c) of every entry of u.
    rows : ndarray of int (n_s,)
        The row of y to which every entry of s is added.
    """

    addend: Addend
    inputs: Indices
    rows: Indices

    def call(self, name: str) -> tuple[Call, int]:
        """Return the call of ``"values"``, ``"jacobian"`` or ``"hessian"``, and the number of its results."""
        if name == "values":
            made, numbers = self.addend.values
        else:
            made, (rows, _) = getattr(self.addend, name)
            numbers = len(rows)
        multipliers = self.rows if name == "hessian" else NO_POSITIONS
        return load_native().Call(made, self.inputs, multipliers), numbers

    def terms(self, name: str, first: int, unknowns: int) -> Sums:
        """Return the terms of y, of dy/dv or of the Hessian's lower triangle; the call's results begin at ``first``.

        Columns of constants, which follow the ``unknowns``, are dropped.
        """
        if name == "values":
            places = np.arange(first, first + len(self.rows), dtype=np.int64)
            return copied(Entries(self.rows, np.zeros(len(self.rows), dtype=np.int64), places))
        rows, columns = getattr(self.addend, name)[1]
        places = np.arange(first, first + len(rows), dtype=np.int64)
        columns = self.inputs[columns]
        if name == "jacobian":
            moved = Entries(self.rows[rows], columns, places)
        else:
            rows = self.inputs[rows]
            moved = Entries(np.maximum(rows, columns), np.minimum(rows, columns), places)
        last = moved.columns if name == "jacobian" else moved.rows
        return copied(moved.where(last < unknowns))


class Calls:
    """All calls of the addends of a stage.

    Parameters
    ----------
    added : sequence of Added
    name : str
        ``"values"``, ``"jacobian"`` or ``"hessian"``.

    Attributes
    ----------
    calls : list of Call
    numbers : int
        The number of their results, one call after the other.
    """

    def __init__(self, added: Sequence[Added], name: str) -> None:
        self._added, self._name = added, name
        called = [each.call(name) for each in added]
        self.calls = [call for call, _ in called]
        self._begin = list(accumulate((numbers for _, numbers in called), initial=0))
        self.numbers = self._begin[-1]

    def terms(self, first: int, unknowns: int) -> list[Sums]:
        """Return the terms of the results, which begin at ``first``; see ``Added.terms``."""
        begin = zip(self._added, self._begin, strict=False)
        return [each.terms(self._name, first + at, unknowns) for each, at in begin]


def positions_in(symbols: ca.SX, entries: ca.SX) -> NDArray[np.int64]:
    """Return the index of every entry in a column of symbols; -1 for zeros, -2 for other expressions."""
    known = {each.element_hash(): i for i, each in enumerate(symbols.elements())}
    found = [-1 if each.is_zero() else known.get(each.element_hash(), -2) for each in entries.elements()]
    return np.array(found, dtype=np.int64)
