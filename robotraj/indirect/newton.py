"""Newton's method for an NLP with as many equality rows as unknowns."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.transcription.assembly.triplets import scaled
from robotraj.transcription.nlp import Nlp

MAX_STEPS = 60
MIN_STEP = 1e-6
"""Smallest fraction of a Newton step in the line search."""


@dataclass(frozen=True, eq=False)
class NewtonRoot(OneLine):
    """Result of Newton's method.

    Attributes
    ----------
    w : ndarray (n_w,)
        Unknowns in physical units.
    residual : float
        Largest scaled row.
    steps : int
    trouble : str
        Reason of the failure; empty if it converged.
    """

    w: Array
    residual: float
    steps: int
    trouble: str = ""


def find_root(nlp: Nlp, tolerance: float) -> NewtonRoot:
    """Solve g(w) = 0 from ``nlp.guess`` by damped Newton steps with the exact sparse Jacobian.

    It converges when the scaled rows are below ``tolerance`` and further steps do not reduce them.
    """
    if len(nlp.rows) != len(nlp.variables):
        return NewtonRoot(nlp.guess, np.inf, 0, f"{len(nlp.rows)} equations for {len(nlp.variables)} unknowns")
    blocks = [block.scaled(nlp.scale, nlp.row_scale) for block in nlp.blocks]
    chains = [block.jacobian_chain() for block in blocks]
    linear = scaled(nlp.linear, nlp.row_scale, nlp.scale).scipy()
    target = nlp.row_scale * nlp.rows.lower

    def values(w: Array) -> Array:
        total = linear @ w - target
        for block in blocks:
            total += block.scatter @ block.outputs(w).ravel(order="F")
        return np.asarray(total)

    def jacobian(w: Array) -> sparse.csc_array:
        parts = [linear.tocoo()]
        for block, chain in zip(blocks, chains, strict=True):
            small = np.array(block.stage.jacobian.map(block.count)(block.places(w), block.constants)).ravel(order="F")
            entries = chain.factors * small[chain.source]
            parts.append(sparse.coo_array((entries, (chain.rows, chain.columns)), shape=linear.shape))
        return sparse.csc_array(sum(parts[1:], parts[0]))

    w = nlp.guess / nlp.scale
    g = values(w)
    settled = 0
    for step in range(MAX_STEPS):
        size = float(np.max(np.abs(g)))
        if not np.isfinite(size):
            return NewtonRoot(w * nlp.scale, np.inf, step, "an expression is NaN or infinite")
        try:
            direction = -splu(jacobian(w)).solve(g)
        except RuntimeError:
            return NewtonRoot(
                w * nlp.scale, size, step, "the Jacobian is singular: the arcs do not determine the motion"
            )
        part = 1.0
        while True:
            trial = w + part * direction
            after = values(trial)
            if np.all(np.isfinite(after)) and np.linalg.norm(after) <= (1.0 - 0.1 * part) * np.linalg.norm(g):
                break
            if size < tolerance:
                return NewtonRoot(w * nlp.scale, size, step)
            part *= 0.5
            if part < MIN_STEP:
                return NewtonRoot(
                    w * nlp.scale, size, step, "the line search found no Newton step that reduces the residual"
                )
        w, g = trial, after
        settled = settled + 1 if float(np.max(np.abs(g))) < tolerance else 0
        if settled >= 3:
            break
    size = float(np.max(np.abs(g)))
    return NewtonRoot(w * nlp.scale, size, step + 1, "" if size < tolerance else f"no convergence in {MAX_STEPS} steps")
