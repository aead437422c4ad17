"""The chain rule of a stage function with a robot's inverse dynamics in it.

    y = psi(v, c, r) + sum_k S_k s_k,    r = RNEA(x),    x = (q, w, a) = chi(v, c)

    dy/dv = psi_v + psi_r R chi_v,    R = dr/dx
    d^2(m' y)/dv^2 = psi_vv + psi_vr D + (psi_vr D)' + D' psi_rr D + chi_v' H chi_v + sum_i g_i d^2 x_i/dv^2
    D = R chi_v,    H = d^2(l' r)/dx^2,    l = psi_r' m,    g = R' l

psi's derivatives are those of m' psi; the derivatives of the addends s_k (``shared_terms``) are added. psi and chi are
small CasADi graphs; R and H are analytical (``src/rigid_body/rigid_kernel.hpp``), so the graph of the inverse dynamics
is never built. Where every entry of x is an entry of v, the usual case, chi only renumbers columns.
"""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.lazy_values import cached_property
from robotraj._util.values import dataclass
from robotraj.native.build import load_native
from robotraj.native.shared_terms import Calls
from robotraj.native.sparse_products import (
    Entries,
    Indices,
    Sums,
    Terms,
    copied,
    entries,
    flipped,
    joined,
    lower,
    matched,
)
from robotraj.native.stage_tapes import Pattern, Tapes, plain

if TYPE_CHECKING:
    from collections.abc import Sequence

    from robotraj.native._native import Recipe, RigidTree, StageGraph, Tape, Torques
    from robotraj.native.shared_terms import Added


class TorqueChain(Tapes):
    """Recipes of a stage function and the patterns of their results.

    Parameters
    ----------
    graph : StageGraph
        psi(v, c, r) and chi(v, c), (n_y,) and (nq + 2 nv,).
    costed : int or None
        The output that is part of the objective.
    tree : RigidTree
    added : sequence of Added
        The addends, none of them in the costed output.
    """

    def __init__(self, graph: StageGraph, costed: int | None, tree: RigidTree, added: Sequence[Added] = ()) -> None:
        super().__init__(graph, costed)
        self._tree, self._added = tree, added

    def _recipe(
        self,
        tape: Tape,
        fixed: int,
        terms: Terms,
        made: Entries,
        jacobian: bool = False,
        hessian: bool = False,
        calls: Calls | None = None,
    ) -> Recipe:
        """Combine a tape and the products of its results; ``made`` is the result."""
        out, left, right = (np.ascontiguousarray(side) for side in terms.terms)
        recipe: Recipe = load_native().Recipe(
            tape=tape,
            jacobian=jacobian,
            hessian=hessian,
            made=terms.size - fixed,
            result=made.places[0] if len(made) else 1,
            results=len(made),
            out=out,
            left=left,
            right=right,
            calls=calls.calls if calls is not None else [],
        )
        return recipe

    @cached_property
    def _values(self) -> Recipe:
        tape = self._graph.values()
        if not self._added:
            return plain(tape)
        calls = Calls(self._added, "values")
        parts = _ChainParts.after(tape, 0, 0, self._argument_numbers, 0, calls.numbers)
        terms, outputs = Terms(parts.made), self._graph.outputs
        own = entries(np.arange(outputs), np.zeros(outputs, dtype=np.int64), 1)
        made = terms.collect([copied(own), *calls.terms(parts.calls, self._graph.inputs)], full=outputs)
        return self._recipe(tape, parts.made, terms, made, calls=calls)

    @cached_property
    def _gradient(self) -> Recipe:
        # Addends are not part of the objective.
        return self._first(self._costed_graph, (), dense=True)[0]

    @cached_property
    def _jacobian(self) -> tuple[Recipe, Pattern]:
        return self._first(self._graph, self._added)

    def _first(self, graph: StageGraph, added: Sequence[Added], dense: bool = False) -> tuple[Recipe, Pattern]:
        """Return dy/dv with the addends' derivatives, or the gradient of one output as a dense column."""
        tape, by_v, by_r = graph.slopes()
        through = len(by_r[0]) > 0
        calls, torques = Calls(added, "jacobian"), len(self._torque_pattern[0]) if through else 0
        parts = _ChainParts.after(tape, torques, 0, self._argument_numbers, 0, calls.numbers)
        terms = Terms(parts.made)
        sums = [copied(entries(*by_v, 1)), *calls.terms(parts.calls, self._graph.inputs)]
        if through:
            sums.append(matched(entries(*by_r, 1 + len(by_v[0])), self._rates(terms, parts)))
        if dense:
            made = terms.collect([flipped(each) for each in sums], full=self._graph.inputs)
        else:
            made = terms.collect(sums)
        recipe = self._recipe(tape, parts.made, terms, made, jacobian=through, calls=calls)
        return recipe, (made.rows, made.columns)

    @cached_property
    def _hessian(self) -> tuple[Recipe, Pattern, Recipe | None]:
        tape, convex, *patterns = self._graph.curvature()
        first = [1 + self._graph.torques]
        for pattern in patterns:
            first.append(first[-1] + len(pattern[0]))
        own, mixed, curved = (entries(*pattern, at) for pattern, at in zip(patterns, first, strict=False))
        through = bool(len(mixed) or len(curved) or len(self._curvature[0]))
        rows, columns = self._tree.hessian_pattern()
        calls, torques = Calls(self._added, "hessian"), len(self._torque_pattern[0]) if through else 0
        bent = len(self._curvature[0])
        parts = _ChainParts.after(tape, torques, len(rows), self._argument_numbers, bent, calls.numbers)
        terms = Terms(parts.made)
        sums = [copied(own), self._moved(terms, entries(rows, columns, parts.hessian), parts)]
        sums += [copied(entries(*self._curvature, parts.curvature)), *calls.terms(parts.calls, self._graph.inputs)]
        if len(mixed) or len(curved):
            rates = self._rates(terms, parts)
            both = matched(rates.T, mixed)
            sums += [lower(both), lower(flipped(both))]
            if len(curved):
                sums.append(lower(matched(rates.T, terms.product(curved, rates))))
        made = terms.collect(sums)
        recipe, without = (
            None if each is None else self._recipe(each, parts.made, terms, made, through, True, calls)
            for each in (tape, convex)
        )
        assert recipe is not None
        return recipe, (made.rows, made.columns), without

    @cached_property
    def _torque_pattern(self) -> Pattern:
        return self._tree.jacobian_pattern()

    def _rates(self, terms: Terms, parts: _ChainParts) -> Entries:
        """D = R chi_v."""
        every = entries(*self._torque_pattern, parts.jacobian)
        if self._places is None:
            return terms.product(every, self._inner(parts))
        moved = Entries(every.rows, self._places[every.columns], every.places)
        return moved.where(moved.columns >= 0)

    def _moved(self, terms: Terms, h: Entries, parts: _ChainParts) -> Sums:
        """Return the terms of the lower triangle of chi_v' H chi_v; H is given by one of its triangles."""
        if self._places is None:
            both = joined(h, h.where(h.rows != h.columns).T)
            inner = self._inner(parts)
            return lower(matched(inner.T, terms.product(both, inner)))
        rows, columns = self._places[h.rows], self._places[h.columns]
        moved = Entries(np.maximum(rows, columns), np.minimum(rows, columns), h.places)
        return copied(moved.where(moved.columns >= 0))

    @cached_property
    def _places(self) -> Indices | None:
        """The index in v of every entry of x, -1 for zeros; None if an entry is another expression."""
        return self._graph.places()

    @cached_property
    def _arguments(self) -> tuple[Tape, Tape, Pattern, Pattern]:
        """The tapes of x with chi_v, and of the lower triangle of sum_i g_i d^2 x_i/dv^2; then their patterns."""
        return self._graph.chain()

    @property
    def _argument_numbers(self) -> int:
        return 0 if self._places is not None else self._graph.arguments + len(self._arguments[2][0])

    def _inner(self, parts: _ChainParts) -> Entries:
        """chi_v."""
        return entries(*self._arguments[2], parts.arguments + self._graph.arguments)

    @property
    def _curvature(self) -> Pattern:
        """Pattern of the lower triangle of sum_i g_i d^2 x_i/dv^2."""
        nothing = np.zeros(0, dtype=np.int64)
        return (nothing, nothing) if self._places is not None else self._arguments[3]

    @cached_property
    def _torques(self) -> Torques:
        torques: Torques = load_native().Torques(
            self._tree, *((self._places,) if self._places is not None else self._arguments[:2])
        )
        return torques


@dataclass(frozen=True)
class _ChainParts:
    """Where the parts of a recipe's buffer begin."""

    jacobian: int
    hessian: int
    arguments: int
    curvature: int
    calls: int
    made: int

    @classmethod
    def after(cls, tape: Tape, *sizes: int) -> _ChainParts:
        return cls(*accumulate(sizes, initial=1 + tape.outputs))
