"""Whole turns taken out of controls that are angles.

Where a control enters through its sine and cosine alone, a thrust's direction or a heading, every collocation point has
its own choice of turn: values that differ by 2 pi say the same to every row. A solver whose first steps are long ends
at a right direction at every point, and at polynomials between them that turn over and over.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from robotraj.transcription.nlp import Nlp

Array = NDArray[np.float64]

TURN = 2.0 * np.pi
SAME = 1e-9
"""Change of a scaled row, or of the objective relative to 1 + |objective|, that is round-off."""


def unwound(nlp: Nlp, w: Array) -> Array:
    """Put controls of systems on the turn of the point before, where no row and no cost sees the difference.

    Parameters
    ----------
    nlp : Nlp
    w : ndarray (n_w,)
        A solution, in physical units; what is given back is one as well.
    """
    for layout, phase in zip(nlp.layouts, nlp.problem.phases, strict=True):
        if phase.robot is not None or not np.all(np.isfinite(w)):
            continue
        for number in range(len(phase.dae.controls)):
            columns = np.unique(np.concatenate([run.controls[..., number].ravel() for run in layout.runs]))
            columns = columns[np.argsort(nlp.variables.fraction[columns], kind="stable")]
            values = _on_one_turn(w[columns], nlp.variables.lower[columns], nlp.variables.upper[columns])
            if values is None:
                continue
            other = w.copy()
            other[columns] = values
            if _alike(nlp, w, other):
                w = other
    return w


def _on_one_turn(values: Array, lower: Array, upper: Array) -> Array | None:
    """Bring values within pi of the one before, around zero, within bounds; None where they are, or cannot be."""
    if np.all(np.abs(np.diff(values)) <= np.pi):
        return None
    near = np.unwrap(values)
    least, most = np.ceil(np.max(lower - near) / TURN), np.floor(np.min(upper - near) / TURN)
    if least > most:
        return None
    return np.asarray(near + TURN * np.clip(-np.round(np.mean(near) / TURN), least, most))


def _alike(nlp: Nlp, w: Array, other: Array) -> bool:
    """Whether two decision vectors give the same rows and the same objective."""
    mine, its = nlp.outputs(w), nlp.outputs(other)
    rows = (nlp.values(other, its) - nlp.values(w, mine)) * nlp.row_scale
    objective = nlp.objective(w, mine)
    change = abs(nlp.objective(other, its) - objective)
    return bool(np.max(np.abs(rows), initial=0.0) <= SAME and change <= SAME * (1 + abs(objective)))
