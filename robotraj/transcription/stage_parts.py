"""Smaller stages made from a stage: some of its outputs, or some of its unknowns solved for."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj.transcription.stage import Stage

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def curved(stage: Stage) -> Mask:
    """Which outputs are not affine in the unknowns, (n_y,)."""
    bent = np.array(ca.which_depends(stage.y, stage.v, 2, True), dtype=bool)
    return bent if stage.torques is None else bent | _turned(stage)


def restricted(stage: Stage, kept: Sequence[int]) -> Stage:
    """Keep the outputs ``kept``, which must have the costed one among them if there is cost left."""
    costed = kept.index(stage.costed) if stage.costed in kept else None
    return Stage(stage.v, stage.c, stage.y[list(kept)], costed, stage.torques)


def constant_jacobian(stage: Stage, outputs: Sequence[int], inputs: Sequence[int]) -> Array:
    """Give d outputs / d inputs where that is a number, NaN where it is an expression."""
    matrix = ca.jacobian(stage.y[list(outputs)], stage.v[list(inputs)])
    values = np.zeros(matrix.shape)
    for row, column, entry in zip(*matrix.sparsity().get_triplet(), matrix.nonzeros(), strict=True):
        values[row, column] = float(entry) if entry.is_constant() else np.nan
    if stage.torques is not None:
        moving = np.array(ca.which_depends(stage.torques.arguments, stage.v[list(inputs)], 1, False), dtype=bool)
        values[np.ix_(_turned(stage)[list(outputs)], moving)] = np.nan
    return values


def solved_for(stage: Stage, outputs: Sequence[int], inputs: Sequence[int]) -> Stage:
    """Solve outputs = 0 for inputs, pair by pair, where d output / d input is a number.

    The new stage has neither; it gives the other outputs, then the solved inputs as expressions of those left.
    """
    v, y = stage.v, stage.y
    diagonal = np.diag(constant_jacobian(stage, outputs, inputs))
    gone = v[list(inputs)]
    at_zero = ca.substitute(y[list(outputs)], gone, ca.SX.zeros(len(inputs)))
    solved = -at_zero / ca.DM(diagonal)
    kept_in = [i for i in range(stage.inputs) if i not in set(inputs)]
    kept_out = [i for i in range(stage.outputs) if i not in set(outputs)]
    # An empty matrix comes back from a substitution with a row.
    others = ca.substitute(y[kept_out], gone, solved) if kept_out else ca.SX(0, 1)
    costed = None if stage.costed is None else kept_out.index(stage.costed)
    torques = None if stage.torques is None else stage.torques.substituted(gone, solved)
    return Stage(v[kept_in], stage.c, ca.vertcat(others, solved), costed, torques)


def _turned(stage: Stage) -> Mask:
    """Which outputs depend on the inverse dynamics, (n_y,)."""
    assert stage.torques is not None
    return np.array(ca.which_depends(stage.y, stage.torques.symbols, 1, True), dtype=bool)
