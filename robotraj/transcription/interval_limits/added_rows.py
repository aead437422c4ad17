"""An NLP with further rows between collocation points, made from the one without them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.collocation.ends import widen
from robotraj.transcription.extract import extract
from robotraj.transcription.interval_limits.constraint_generation import Guard, add_guards
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scaling import row_scale
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.table import ScalarTable

Array = NDArray[np.float64]


def guarded(nlp: Nlp, guards: Sequence[Guard], w: Array) -> Nlp:
    """Add guards to an NLP: their rows and states come last, everything else keeps its place, scale and functions.

    Parameters
    ----------
    nlp : Nlp
    guards : sequence of Guard
        Of which ``nlp`` has none yet.
    w : ndarray (n_w,)
        Where the solver starts, in physical units; states at guards are read off its polynomials.
    """
    phases, layouts = nlp.problem.phases, nlp.layouts
    columns, rows, linear = ScalarTable.after(nlp.variables), ScalarTable.after(nlp.rows), Triplets()
    points, others = nlp.blocks[: len(phases)], nlp.blocks[len(phases) :]
    scatters = [Triplets() for _ in phases]
    widths = [block.stage.outputs for block in points]
    more = add_guards(guards, phases, layouts, columns, rows, linear, scatters, widths)
    variables, constraints = nlp.variables.joined(columns.finish()), nlp.rows.joined(rows.finish())
    shape = (len(constraints), len(variables))

    kept = [widen(block, *shape) for block in points]
    extra = [scatter.matrix(block.scatter.shape) for scatter, block in zip(scatters, kept, strict=True)]
    added = [widen(block, *shape) for block in more]
    for block in added:
        block.stage.as_tapes = nlp.engine.torques_apart
    matrix = linear.matrix(shape)
    scales = dict(zip(nlp.variables.meaning.tolist(), nlp.scale.tolist(), strict=True))
    scale = np.append(nlp.scale, [scales[m] for m in variables.meaning[len(nlp.variables) :].tolist()])
    start = np.append(w, _states(nlp, guards, w))
    alone = [replace(block, scatter=own) for block, own in zip(kept, extra, strict=True) if own.nnz]
    rows_alone = row_scale([*alone, *added], matrix, constraints, scale, start)

    before = nlp.linear.copy()
    before.resize(shape)
    points = tuple(replace(block, scatter=block.scatter + own) for block, own in zip(kept, extra, strict=True))
    return replace(
        nlp,
        variables=variables,
        rows=constraints,
        blocks=(*points, *(widen(block, *shape) for block in others), *added),
        linear=before + matrix,
        scale=scale,
        row_scale=np.append(nlp.row_scale, rows_alone[len(nlp.rows) :]),
        guess=start,
    )


def _states(nlp: Nlp, guards: Sequence[Guard], w: Array) -> Array:
    """States that the guards of path rows add, one after the other."""
    found = [np.empty(0)]
    trajectories = None
    for guard in guards:
        row = nlp.problem.phases[guard.phase].bound_constraints[guard.constraint].rows[guard.row]
        if row.variable is None and not isinstance(nlp.layouts[guard.phase].scheme, OneStep):
            trajectories = trajectories or extract(nlp, w)
            x = trajectories[guard.phase].x
            first, last = x.breaks[guard.interval : guard.interval + 2]
            found.append(x(first + guard.tau * (last - first), guard.interval))
    return np.concatenate(found)
