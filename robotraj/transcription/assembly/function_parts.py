"""Parts of point functions: a selection of the outputs, or the functions with some unknowns eliminated."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from robotraj.transcription.assembly.point_functions import PointFunctions


def restricted(stage: PointFunctions, kept: Sequence[int]) -> PointFunctions:
    """Return point functions with the outputs ``kept``; without the costed output they have no cost."""
    costed = kept.index(stage.costed) if stage.costed in kept else None
    made = PointFunctions(stage.v, stage.c, stage.y[list(kept)], costed, stage.torques, as_tapes=stage.as_tapes)
    if made.torques is stage.torques:
        made.__dict__["graph"] = stage.graph.selected(np.array(kept, dtype=np.int64))
    return made


def solved_for(stage: PointFunctions, outputs: Sequence[int], inputs: Sequence[int]) -> PointFunctions:
    """Solve outputs = 0 for inputs, pair by pair, where d output / d input is a number.

    The new point functions have neither. Their outputs are the others, then the solved inputs as expressions.
    """
    v, y = stage.v, stage.y
    diagonal = stage.constant_slopes[list(outputs), list(inputs)]
    gone = v[list(inputs)]
    at_zero = ca.substitute(y[list(outputs)], gone, ca.SX.zeros(len(inputs)))
    solved = -at_zero / ca.DM(diagonal)
    kept_in = [i for i in range(stage.inputs) if i not in set(inputs)]
    kept_out = [i for i in range(stage.outputs) if i not in set(outputs)]
    # CasADi's substitution in an empty matrix returns one with a row.
    others = ca.substitute(y[kept_out], gone, solved) if kept_out else ca.SX(0, 1)
    costed = None if stage.costed is None else kept_out.index(stage.costed)
    torques = None if stage.torques is None else stage.torques.substituted(gone, solved)
    return PointFunctions(v[kept_in], stage.c, ca.vertcat(others, solved), costed, torques, as_tapes=stage.as_tapes)
