"""The chain rule of a stage function with a robot's inverse dynamics in it.

    y = psi(v, c, r),    r = RNEA(x),    x = (q, w, a) = chi(v, c)

    dy/dv = psi_v + psi_r R chi_v,    R = dr/dx
    d^2(m' y)/dv^2 = psi_vv + psi_vr D + (psi_vr D)' + D' psi_rr D + chi_v' H chi_v + sum_i g_i d^2 x_i/dv^2
    D = R chi_v,    H = d^2(l' r)/dx^2,    l = psi_r' m,    g = R' l

with psi's derivatives those of m' psi. psi and chi are small graphs of CasADi's; R and H are analytical
(``src/rigid_kernel.hpp``). Neither the graph of the inverse dynamics nor its derivatives are ever built. Where every
entry of x is one of v, the common case, chi only renames columns.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj.native.build import load_native
from robotraj.native.terms import Entries, Indices, Sums, Terms, copied, entries, flipped, joined, lower, matched

if TYPE_CHECKING:
    from robotraj.native._native import Recipe, RigidTree, TapeBlock, Torques

Pattern = tuple[NDArray[np.int_], NDArray[np.int_]]


def read_tree(model: str) -> RigidTree:
    """Read Pinocchio's text of a model.

    Raises
    ------
    ValueError
        A joint neither turns about an axis nor slides along one, and is no free-flyer at the root.
    """
    tree: RigidTree = load_native().RigidTree(model.encode())
    return tree


class TorqueChain:
    """Recipes of a stage function and the patterns of their results.

    Parameters
    ----------
    v, c, r : casadi.SX
        Symbols of the unknowns, the constants and the torques.
    y : casadi.SX
        psi(v, c, r), (n_y,) dense.
    costed : int or None
        The output that carries cost.
    tree : RigidTree
    x : casadi.SX
        chi(v, c), (nq + 2 nv,).
    """

    def __init__(self, v: ca.SX, c: ca.SX, r: ca.SX, y: ca.SX, costed: int | None, tree: RigidTree, x: ca.SX) -> None:
        self._v, self._c, self._r, self._y, self._costed = v, c, r, y, costed
        self._tree = tree
        self._x = x
        self._evaluators: dict[int, TapeBlock] = {}

    @property
    def runs(self) -> bool:
        """Whether psi and chi are scalar graphs that call no other functions."""
        try:
            return bool(self._values and self._torques)
        except load_native().NotATape:
            return False

    def block(self, count: int, costs: bool) -> TapeBlock:
        """Give the block of C++ at ``count`` points."""
        block: TapeBlock = load_native().TapeBlock(
            count,
            self._v.numel(),
            self._c.numel(),
            self._values,
            self._jacobian[0],
            self._hessian[0],
            self._cost if costs else None,
            self._gradient if costs else None,
            self._costed if costs and self._costed is not None else -1,
            self._torques,
        )
        return block

    def evaluate(self, name: str, v: NDArray[np.float64], c: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate ``"values"`` or ``"jacobian"`` at E places, (n_v, E), (n_c, E) -> (m, E); no Hessian is made."""
        count = v.shape[1]
        if count not in self._evaluators:
            nothing = self._plain(ca.SX(0, 1), ca.SX.sym("m", self._y.numel()))
            self._evaluators[count] = load_native().TapeBlock(
                count,
                self._v.numel(),
                self._c.numel(),
                self._values,
                self._jacobian[0],
                nothing,
                torques=self._torques,
            )
        evaluate = getattr(self._evaluators[count], name)
        found: NDArray[np.float64] = evaluate(*(np.ascontiguousarray(each.T).ravel() for each in (v, c)))
        return found.reshape(count, -1).T

    @property
    def jacobian_pattern(self) -> Pattern:
        """Rows and columns of the Jacobian's nonzeros."""
        return self._jacobian[1]

    @property
    def hessian_pattern(self) -> Pattern:
        """Rows and columns of the nonzeros of the Hessian's lower triangle."""
        return self._hessian[1]

    def _recipe(
        self,
        tape: ca.SX,
        more: list[ca.SX],
        fixed: int,
        terms: Terms,
        made: Entries,
        jacobian: bool = False,
        hessian: bool = False,
    ) -> Recipe:
        """Put a tape's text and the products of its results together; ``made`` is the result."""
        out, left, right = (np.ascontiguousarray(side) for side in terms.terms)
        recipe: Recipe = load_native().Recipe(
            tape=text_of([self._v, self._c, self._r, *more], tape),
            jacobian=jacobian,
            hessian=hessian,
            made=terms.size - fixed,
            result=made.places[0] if len(made) else 1,
            results=len(made),
            out=out,
            left=left,
            right=right,
        )
        return recipe

    def _plain(self, y: ca.SX, *more: ca.SX) -> Recipe:
        """Give y itself."""
        size = 1 + int(y.numel())
        return self._recipe(
            y, list(more), size, Terms(size), entries(np.arange(size - 1), np.zeros(size - 1, dtype=np.int64), 1)
        )

    @cached_property
    def _values(self) -> Recipe:
        return self._plain(self._y)

    @cached_property
    def _cost(self) -> Recipe:
        return self._plain(self._y[self._costed])

    @cached_property
    def _gradient(self) -> Recipe:
        return self._first(self._y[self._costed], dense=True)[0]

    @cached_property
    def _jacobian(self) -> tuple[Recipe, Pattern]:
        return self._first(self._y, dense=False)

    def _first(self, y: ca.SX, dense: bool) -> tuple[Recipe, Pattern]:
        """Give dy/dv, or where ``dense`` the gradient of one output as a column."""
        by_v, by_r = ca.jacobian(y, self._v), ca.jacobian(y, self._r)
        tape = ca.vertcat(nonzeros(by_v), nonzeros(by_r))
        through = by_r.nnz() > 0
        parts = _Parts.after(tape, len(self._torque_pattern[0]) if through else 0, 0, self._argument_numbers, 0)
        terms = Terms(parts.made)
        sums = [copied(_at(by_v, 1))]
        if through:
            sums.append(matched(_at(by_r, 1 + by_v.nnz()), self._rates(terms, parts)))
        made = terms.collect([flipped(each) for each in sums], full=self._v.numel()) if dense else terms.collect(sums)
        recipe = self._recipe(tape, [], parts.made, terms, made, jacobian=through)
        return recipe, (made.rows, made.columns)

    @cached_property
    def _hessian(self) -> tuple[Recipe, Pattern]:
        m = ca.SX.sym("m", self._y.numel())
        first = ca.densify(ca.gradient(ca.dot(m, self._y), ca.vertcat(self._v, self._r)))
        n = self._v.numel()
        by_v, by_r = first[:n], first[n:]
        vv, rv, rr = ca.tril(ca.jacobian(by_v, self._v)), ca.jacobian(by_r, self._v), ca.jacobian(by_r, self._r)
        tape = ca.vertcat(by_r, *(nonzeros(part) for part in (vv, rv, rr)))
        at = 1 + by_r.numel()
        own, mixed, curved = _at(vv, at), _at(rv, at + vv.nnz()), _at(rr, at + vv.nnz() + rv.nnz())
        through = bool(len(mixed) or len(curved) or self._curvature.nnz())
        rows, columns = self._tree.hessian_pattern()
        parts = _Parts.after(
            tape,
            len(self._torque_pattern[0]) if through else 0,
            len(rows),
            self._argument_numbers,
            self._curvature.nnz(),
        )
        terms = Terms(parts.made)
        sums = [copied(own), self._moved(terms, entries(rows, columns, parts.hessian), parts)]
        sums.append(copied(_at(self._curvature, parts.curvature)))
        if len(mixed) or len(curved):
            rates = self._rates(terms, parts)
            both = matched(rates.T, mixed)
            sums += [lower(both), lower(flipped(both))]
            if len(curved):
                sums.append(lower(matched(rates.T, terms.product(curved, rates))))
        made = terms.collect(sums)
        recipe = self._recipe(tape, [m], parts.made, terms, made, jacobian=through, hessian=True)
        return recipe, (made.rows, made.columns)

    @cached_property
    def _torque_pattern(self) -> tuple[Indices, Indices]:
        rows, columns = self._tree.jacobian_pattern()
        return rows, columns

    def _rates(self, terms: Terms, parts: _Parts) -> Entries:
        """D = R chi_v."""
        every = entries(*self._torque_pattern, parts.jacobian)
        if self._places is None:
            return terms.product(every, self._inner(parts))
        moved = Entries(every.rows, self._places[every.columns], every.places)
        return moved.where(moved.columns >= 0)

    def _moved(self, terms: Terms, h: Entries, parts: _Parts) -> Sums:
        """Terms of the lower triangle of chi_v' H chi_v, H given by one of its triangles."""
        if self._places is None:
            both = joined(h, h.where(h.rows != h.columns).T)
            inner = self._inner(parts)
            return lower(matched(inner.T, terms.product(both, inner)))
        rows, columns = self._places[h.rows], self._places[h.columns]
        moved = Entries(np.maximum(rows, columns), np.minimum(rows, columns), h.places)
        return copied(moved.where(moved.columns >= 0))

    @cached_property
    def _places(self) -> Indices | None:
        """Where in v every entry of x stands, -1 for zeros; None where one is something else."""
        known = {each.element_hash(): i for i, each in enumerate(self._v.elements())}
        entries_of_x = ca.densify(self._x).elements()
        found = [-1 if each.is_zero() else known.get(each.element_hash(), -2) for each in entries_of_x]
        return None if -2 in found else np.array(found, dtype=np.int64)

    @cached_property
    def _inner_jacobian(self) -> ca.SX:
        return ca.jacobian(self._x, self._v)

    @property
    def _argument_numbers(self) -> int:
        return 0 if self._places is not None else int(self._x.numel()) + int(self._inner_jacobian.nnz())

    def _inner(self, parts: _Parts) -> Entries:
        """chi_v."""
        return _at(self._inner_jacobian, parts.arguments + self._x.numel())

    @cached_property
    def _weights(self) -> ca.SX:
        return ca.SX.sym("g", self._x.numel())

    @cached_property
    def _curvature(self) -> ca.SX:
        """Lower triangle of sum_i g_i d^2 x_i/dv^2."""
        if self._places is not None:
            return ca.SX(self._v.numel(), self._v.numel())
        return ca.tril(ca.hessian(ca.dot(self._weights, self._x), self._v)[0])

    @cached_property
    def _torques(self) -> Torques:
        torques: Torques
        if self._places is not None:
            torques = load_native().Torques(self._tree, self._places)
            return torques
        torques = load_native().Torques(
            self._tree,
            text_of([self._v, self._c], ca.vertcat(ca.densify(self._x), nonzeros(self._inner_jacobian))),
            text_of([self._v, self._c, self._weights], nonzeros(self._curvature)),
        )
        return torques


@dataclass(frozen=True)
class _Parts:
    """Where the parts of a recipe's buffer begin."""

    jacobian: int
    hessian: int
    arguments: int
    curvature: int
    made: int

    @classmethod
    def after(cls, tape: ca.SX, *sizes: int) -> _Parts:
        return cls(*accumulate(sizes, initial=1 + int(tape.numel())))


def nonzeros(matrix: ca.SX) -> ca.SX:
    """Nonzeros of a matrix as a dense column."""
    found = matrix.nz[:]
    # Those of a row are a row.
    return found if found.is_column() else found.T


def text_of(inputs: list[ca.SX], result: ca.SX) -> bytes:
    """Serialise a function of one result, which must be dense."""
    text: str = ca.Function("tape", inputs, [result]).serialize()
    return text.encode("latin-1")


def _at(matrix: ca.SX, first: int) -> Entries:
    rows, columns = matrix.sparsity().get_triplet()
    return entries(np.array(rows, dtype=np.int64), np.array(columns, dtype=np.int64), first)
