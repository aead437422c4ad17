"""From blocks to the functions a solver calls: objective, rows, gradient, Jacobian and Hessian of the Lagrangian.

The nonzeros of the big matrices are fixed sparse combinations of the nonzeros of the stages' small ones,

    vec(J) = j0 + sum_b M_b vec(J_b),    vec(H) = sum_b N_b vec(H_b),

computed once here. What a solver evaluates is the stage functions, mapped over their places, and a few sparse
products; the whole graph is never coloured or differentiated.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from robotraj.engines import Engine, StageMapped
from robotraj.sparse import csc_array, csr_array, diags_array
from robotraj.transcription.block import Block, Chain, Indices


@dataclass(frozen=True)
class Functions:
    """The NLP as CasADi functions of the scaled decision vector w, with the signatures ``casadi.nlpsol`` takes.

    Attributes
    ----------
    objective : (w, p) -> f
    rows : (w, p) -> g
    gradient : (w, p) -> f, grad f
    jacobian : (w, p) -> g, dg/dw
    hessian : (w, p, lam_f, lam_g) -> upper triangle of the Hessian of lam_f f + lam_g' g
    preparing : float
        Seconds that the engine took to prepare the point functions.
    prepared : tuple of casadi.Function
        What the functions call, kept as long as they are.
    """

    objective: ca.Function
    rows: ca.Function
    gradient: ca.Function
    jacobian: ca.Function
    hessian: ca.Function
    preparing: float = 0.0
    prepared: tuple[ca.Function, ...] = ()


@dataclass(frozen=True)
class _Places:
    """A block with its mapped arguments."""

    block: Block
    v: ca.MX
    c: ca.DM
    functions: Mapping[str, ca.Function]

    def map(self, name: str, *more: ca.MX) -> ca.MX:
        return self.functions[name](self.v, self.c, *more)


def assemble(blocks: Sequence[Block], linear: csr_array, engine: Engine) -> Functions:
    """Build the functions of g = linear w + sum_b S_b vec(Y_b) and f = sum_b s_b' Y_b[costed].

    Parameters
    ----------
    blocks : sequence of Block
    linear : sparse (n_g, n_w)
    engine : Engine
        Evaluates the stage functions.
    """
    n_g, n_w = linear.shape
    w, p = ca.MX.sym("w", n_w), ca.MX.sym("p", 0)
    lam_f, lam_g = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", n_g)
    wanted = [_wanted(block) for block in blocks]
    began = time.perf_counter()
    prepared = engine.prepare(point_functions(blocks))
    preparing = time.perf_counter() - began
    following = iter(prepared)
    places = [
        _place(block, w, {name: next(following) for name in own}) for block, own in zip(blocks, wanted, strict=True)
    ]

    objective, gradient = ca.MX(ca.DM.zeros(1)), ca.MX(ca.DM.zeros(n_w))
    rows = ca.mtimes(to_dm(linear), w)
    for place in places:
        block = place.block
        if block.scatter.nnz:
            rows += ca.mtimes(to_dm(block.scatter), ca.vec(place.map("function")))
        if block.costs:
            weights = ca.DM(block.weights)
            objective += ca.mtimes(place.map("cost"), weights)
            weighed = diags_array(np.repeat(block.weights, block.stage.inputs)) @ block.gather
            gradient += ca.mtimes(to_dm(weighed.T), ca.vec(place.map("gradient")))
    rows, objective, gradient = (ca.densify(part) for part in (rows, objective, gradient))
    jacobian = _jacobian(places, linear)
    hessian = _hessian(places, lam_f, lam_g, n_w)
    return Functions(
        ca.Function("nlp_f", [w, p], [objective], ["x", "p"], ["f"]),
        ca.Function("nlp_g", [w, p], [rows], ["x", "p"], ["g"]),
        ca.Function("nlp_grad_f", [w, p], [objective, gradient], ["x", "p"], ["f", "grad_f_x"]),
        ca.Function("nlp_jac_g", [w, p], [rows, jacobian], ["x", "p"], ["g", "jac_g_x"]),
        ca.Function(
            "nlp_hess_l", [w, p, lam_f, lam_g], [hessian], ["x", "p", "lam_f", "lam_g"], ["triu_hess_gamma_x_x"]
        ),
        preparing,
        tuple(prepared),
    )


def point_functions(blocks: Sequence[Block]) -> list[StageMapped]:
    """Give every stage function that the NLP calls, and at how many places."""
    return [StageMapped(block.stage, name, block.count) for block in blocks for name in _wanted(block)]


def to_dm(matrix: csr_array | csc_array) -> ca.DM:
    """Copy a sparse matrix into CasADi."""
    csc = matrix.tocsc() if isinstance(matrix, csr_array) else matrix
    pattern = ca.Sparsity(csc.shape[0], csc.shape[1], csc.indptr.tolist(), csc.indices.tolist())
    return ca.DM(pattern, csc.data)


def _wanted(block: Block) -> list[str]:
    """Names of the functions of the block's stage that the NLP calls."""
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


def _place(block: Block, w: ca.MX, functions: Mapping[str, ca.Function]) -> _Places:
    flat = ca.mtimes(to_dm(block.gather), w)
    return _Places(
        block, ca.reshape(ca.densify(flat), block.stage.inputs, block.count), ca.DM(block.constants), functions
    )


def _jacobian(places: Sequence[_Places], linear: csr_array) -> ca.MX:
    """Sparse dg/dw: the linear part plus every block's chain."""
    chains = [place.block.jacobian_chain() for place in places]
    coo = linear
    pattern, slots = _merge([(coo.row, coo.col), *((c.rows, c.columns) for c in chains)], linear.shape)
    values = ca.MX(ca.DM(np.bincount(slots[0], weights=coo.data, minlength=pattern.nnz())))
    for place, chain, slot in zip(places, chains, slots[1:], strict=True):
        if chain.source.size:
            nonzeros = ca.vec(place.map("jacobian"))
            values += ca.mtimes(_combination(chain, slot, pattern.nnz(), nonzeros.numel()), nonzeros)
    return ca.MX(pattern, ca.densify(values))


def _hessian(places: Sequence[_Places], lam_f: ca.MX, lam_g: ca.MX, n_w: int) -> ca.MX:
    """Upper triangle of the Lagrangian's Hessian."""
    chains = [place.block.hessian_chain() for place in places]
    pattern, slots = _merge([(c.rows, c.columns) for c in chains], (n_w, n_w))
    values = ca.MX(ca.DM.zeros(pattern.nnz()))
    for place, chain, slot in zip(places, chains, slots, strict=True):
        block = place.block
        if "hessian" not in place.functions or not chain.source.size:
            continue
        multipliers = ca.mtimes(to_dm(block.scatter.T), lam_g)
        if block.costs:
            costed = np.zeros((block.count, block.stage.outputs))
            costed[:, block.stage.costed] = block.weights
            multipliers += lam_f * ca.DM(costed.ravel())
        m = ca.reshape(ca.densify(multipliers), block.stage.outputs, block.count)
        nonzeros = ca.vec(place.map("hessian", m))
        values += ca.mtimes(_combination(chain, slot, pattern.nnz(), nonzeros.numel()), nonzeros)
    return ca.MX(pattern, ca.densify(values))


def _combination(chain: Chain, slot: Indices, rows: int, columns: int) -> ca.DM:
    return to_dm(csr_array((chain.factors, (slot, chain.source)), shape=(rows, columns)))


def _merge(lists: Sequence[tuple[Indices, Indices]], shape: tuple[int, int]) -> tuple[ca.Sparsity, list[Indices]]:
    """Union of triplet patterns in CasADi's column-major order, and the slot of every triplet in it."""
    keys = [np.asarray(columns, dtype=np.int64) * shape[0] + rows for rows, columns in lists]
    unique, inverse = np.unique(np.concatenate(keys), return_inverse=True)
    columns, rows = unique // shape[0], unique % shape[0]
    pointers = np.concatenate([[0], np.cumsum(np.bincount(columns, minlength=shape[1]))])
    pattern = ca.Sparsity(shape[0], shape[1], pointers.astype(int).tolist(), rows.astype(int).tolist())
    return pattern, np.split(inverse.ravel(), np.cumsum([len(key) for key in keys])[:-1])
