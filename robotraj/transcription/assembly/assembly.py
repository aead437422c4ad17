"""Functions of the NLP, assembled from blocks: objective, rows, gradient, Jacobian and Hessian of the Lagrangian.

The nonzeros of the NLP's matrices are fixed linear combinations of the nonzeros of the point functions' matrices,

    vec(J) = j0 + sum_b M_b vec(J_b),    vec(H) = sum_b N_b vec(H_b),

which are computed once here. A solver evaluates the point functions at all places, and one sparse product. The graph of
the whole NLP is never built.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from threading import Lock

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.sparse import csr_array
from robotraj._util.time_left import used_time
from robotraj._util.values import dataclass
from robotraj.native.engines.base import Engine, StageMapped
from robotraj.transcription.assembly.block import Block, Chain
from robotraj.transcription.assembly.callbacks import NlpFunction
from robotraj.transcription.assembly.evaluation import Places, stacked


@dataclass(frozen=True)
class Functions:
    """The NLP as CasADi functions of the scaled decision vector w, with the signatures of ``casadi.nlpsol``.

    Attributes
    ----------
    objective : (w, p) -> f
    rows : (w, p) -> g
    gradient : (w, p) -> f, grad f
    jacobian : (w, p) -> g, dg/dw
    hessian : (w, p, lam_f, lam_g) -> upper triangle of the Hessian of lam_f f + lam_g' g
    preparing : float
        Time in which the engine prepared the point functions [s].
    """

    objective: ca.Function
    rows: ca.Function
    gradient: ca.Function
    jacobian: ca.Function
    hessian: ca.Function
    preparing: float = 0.0


def assemble(blocks: Sequence[Block], linear: csr_array, engine: Engine) -> Functions:
    """Build the functions of g = linear w + sum_b S_b vec(Y_b) and f = sum_b s_b' Y_b[costed].

    Parameters
    ----------
    blocks : sequence of Block
    linear : sparse (n_g, n_w)
    engine : Engine
        Engine that evaluates the point functions.
    """
    began = used_time()
    prepared = iter(engine.prepare(point_functions(blocks)))
    preparing = used_time() - began
    values = _Values(blocks, [{name: next(prepared) for name in _wanted(block)} for block in blocks], linear)
    n_g, n_w = linear.shape
    number, rows = ca.Sparsity.dense(1, 1), ca.Sparsity.dense(n_g, 1)
    objective, lock, at = (number, values.objective), Lock(), {"x": n_w, "p": 0}
    return Functions(
        NlpFunction("nlp_f", at, {"f": objective}, lock),
        NlpFunction("nlp_g", at, {"g": (rows, values.rows)}, lock),
        NlpFunction("nlp_grad_f", at, {"f": objective, "grad_f_x": (ca.Sparsity.dense(n_w, 1), values.gradient)}, lock),
        NlpFunction(
            "nlp_jac_g", at, {"g": (rows, values.rows), "jac_g_x": (values.jacobian_pattern, values.jacobian)}, lock
        ),
        NlpFunction(
            "nlp_hess_l",
            at | {"lam_f": 1, "lam_g": n_g},
            {"triu_hess_gamma_x_x": (values.hessian_pattern, values.hessian)},
            lock,
        ),
        preparing,
    )


class _Values:
    """Nonzeros of the functions at a scaled w. The second argument of each method is the empty p."""

    def __init__(
        self, blocks: Sequence[Block], functions: Sequence[Mapping[str, ca.Function]], linear: csr_array
    ) -> None:
        n_g, n_w = linear.shape
        self._places = places = Places(blocks, functions, n_w)
        self._linear = stacked(linear.shape, [(linear.row, linear.col, linear.data)])
        scatters = [Chain(b.scatter.row, b.scatter.row, b.scatter.data, b.scatter.col) for b in blocks]
        self._scatter = places.combination("function", scatters, [chain.rows for chain in scatters], n_g)
        turned = [
            (chain.source + start, chain.rows, chain.factors)
            for chain, start in zip(scatters, places.first_output, strict=True)
        ]
        self._multipliers = stacked((len(places.multipliers), n_g), turned)
        costing = [block for block in blocks if block.costs]
        self._weights = np.concatenate([np.zeros(0), *(block.weights for block in costing)])
        self._costed = np.concatenate([np.zeros(0), *(_costed(block) for block in blocks)])
        slopes = [_slopes(block) for block in blocks]
        self._slopes = places.combination("gradient", slopes, [chain.columns for chain in slopes], n_w)

        chains = [block.jacobian_chain() for block in blocks]
        given = [(linear.row, linear.col), *((chain.rows, chain.columns) for chain in chains)]
        self.jacobian_pattern, slots = _merge(given, linear.shape)
        self._constant = np.bincount(slots[0], weights=linear.data, minlength=self.jacobian_pattern.nnz())
        self._jacobian = places.combination("jacobian", chains, slots[1:], self.jacobian_pattern.nnz())
        chains = [block.hessian_chain() for block in blocks]
        self.hessian_pattern, slots = _merge([(chain.rows, chain.columns) for chain in chains], (n_w, n_w))
        self._hessian = places.combination("hessian", chains, slots, self.hessian_pattern.nnz())

    def objective(self, w: Array, _: Array) -> Array:
        self._places.at(w)
        return np.array([self._weights @ self._places.evaluate("cost")])

    def gradient(self, w: Array, _: Array) -> Array:
        self._places.at(w)
        return self._slopes @ self._places.evaluate("gradient")

    def rows(self, w: Array, _: Array) -> Array:
        self._places.at(w)
        return self._linear @ w + self._scatter @ self._places.evaluate("function")

    def jacobian(self, w: Array, _: Array) -> Array:
        self._places.at(w)
        return self._constant + self._jacobian @ self._places.evaluate("jacobian")

    def hessian(self, w: Array, _: Array, lam_f: Array, lam_g: Array) -> Array:
        self._places.at(w)
        self._places.multipliers[:] = self._multipliers @ lam_g + lam_f * self._costed
        return self._hessian @ self._places.evaluate("hessian")


def point_functions(blocks: Sequence[Block]) -> list[StageMapped]:
    """Return every stage function that the NLP calls, with its number of places."""
    return [StageMapped(block.stage, name, block.count) for block in blocks for name in _wanted(block)]


def _wanted(block: Block) -> list[str]:
    """Return the names of the functions of the block's stage that the NLP calls."""
    stage = block.stage
    wanted = []
    if block.scatter.nnz:
        wanted.append("function")
        if stage.jacobian_pattern[0].size:
            wanted.append("jacobian")
    if block.costs:
        wanted += ["cost", "gradient"]
    if (block.scatter.nnz or block.costs) and stage.hessian_pattern[0].size:
        wanted.append("hessian")
    return wanted


def _costed(block: Block) -> Array:
    """Return the weights in the objective of all outputs of a block, place after place."""
    costed = np.zeros((block.count, block.stage.outputs))
    if block.costs:
        costed[:, block.stage.costed] = block.weights
    return costed.ravel()


def _slopes(block: Block) -> Chain:
    """Return the chain from the gradients of the places to that of the objective."""
    weights = np.repeat(block.weights, block.stage.inputs)[block.gather.row]
    return Chain(block.gather.row, block.gather.col, weights * block.gather.data, block.gather.row)


def _merge(lists: Sequence[tuple[Indices, Indices]], shape: tuple[int, int]) -> tuple[ca.Sparsity, list[Indices]]:
    """Return the union of patterns in CasADi's column-major order, and the index of every triplet in it."""
    keys = [np.asarray(columns, dtype=np.int64) * shape[0] + rows for rows, columns in lists]
    unique, inverse = np.unique(np.concatenate(keys), return_inverse=True)
    columns, rows = unique // shape[0], unique % shape[0]
    pointers = np.concatenate([[0], np.cumsum(np.bincount(columns, minlength=shape[1]))])
    pattern = ca.Sparsity(shape[0], shape[1], pointers.astype(int).tolist(), rows.astype(int).tolist())
    return pattern, np.split(inverse.ravel(), np.cumsum([len(key) for key in keys])[:-1])
