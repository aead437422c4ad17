"""A stage function and its derivatives as tapes, which list the operations of CasADi's graphs in order."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.lazy_values import cached_property
from robotraj.native.build import load_native

if TYPE_CHECKING:
    from robotraj.native._native import Recipe, StageGraph, Tape, TapeBlock, Torques

Pattern = tuple[NDArray[np.int64], NDArray[np.int64]]
NONE: NDArray[np.int64] = np.zeros(0, dtype=np.int64)


class Tapes:
    """Recipes of a stage function without torques, and the patterns of their results.

    Parameters
    ----------
    graph : StageGraph
    costed : int or None
        The output that is part of the objective.
    """

    def __init__(self, graph: StageGraph, costed: int | None) -> None:
        self._graph, self._costed = graph, costed
        self._evaluators: dict[int, TapeBlock] = {}

    @property
    def runs(self) -> bool:
        """Whether the graph is scalar and calls no other functions, so that tapes exist."""
        try:
            _ = self._values, self._torques
        except load_native().NotATape:
            return False
        return True

    def block(self, count: int, costs: bool) -> TapeBlock:
        """Return the block of ``count`` points; ``costs``: whether the costed output is part of the objective."""
        costs = costs and self._costed is not None
        block: TapeBlock = load_native().TapeBlock(
            count,
            self._graph.inputs,
            self._graph.constants,
            self._values,
            self._jacobian[0],
            self._hessian[0],
            self._hessian[2],
            self._cost if costs else None,
            self._gradient if costs else None,
            self._costed if costs else -1,
            self._torques,
        )
        return block

    def evaluate(self, name: str, v: NDArray[np.float64], c: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate ``"values"`` or ``"jacobian"`` at E points: (n_v, E), (n_c, E) -> (m, E)."""
        count = v.shape[1]
        if count not in self._evaluators:
            self._evaluators[count] = load_native().TapeBlock(
                count,
                self._graph.inputs,
                self._graph.constants,
                self._values,
                self._jacobian[0],
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

    @cached_property
    def _costed_graph(self) -> StageGraph:
        return self._graph.selected(np.array([self._costed]))

    @property
    def _torques(self) -> Torques | None:
        return None

    @cached_property
    def _values(self) -> Recipe:
        return plain(self._graph.values())

    @cached_property
    def _cost(self) -> Recipe:
        return plain(self._costed_graph.values())

    @cached_property
    def _gradient(self) -> Recipe:
        return plain(self._costed_graph.gradient())

    @cached_property
    def _jacobian(self) -> tuple[Recipe, Pattern]:
        tape, by_v, _ = self._graph.slopes()
        return plain(tape), by_v

    @cached_property
    def _hessian(self) -> tuple[Recipe, Pattern, Recipe | None]:
        tape, convex, pattern, _, _ = self._graph.curvature()
        return plain(tape), pattern, None if convex is None else plain(convex)


def plain(tape: Tape) -> Recipe:
    """Return a recipe whose results are those of the tape."""
    recipe: Recipe = load_native().Recipe(
        tape, jacobian=False, hessian=False, made=0, result=1, results=tape.outputs, out=NONE, left=NONE, right=NONE
    )
    return recipe
