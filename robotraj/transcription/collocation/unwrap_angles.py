"""Removal of whole turns from controls that are angles.

Some controls enter through their sine and cosine alone, such as a direction of thrust or a heading. Values that differ
by 2 pi are then equivalent, at every collocation point separately. After long first steps a solver may find the right
direction at every point, but polynomials that rotate by whole turns in between.
"""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj.transcription.nlp import Nlp

TURN = 2.0 * np.pi
SAME = 1e-9
"""Change of a scaled row, or of the objective relative to 1 + |objective|, that counts as round-off."""


def unwrapped(nlp: Nlp, w: Array) -> Array:
    """Bring controls of systems within pi of the point before, where rows and objective do not change.

    Parameters
    ----------
    nlp : Nlp
    w : ndarray (n_w,)
        A solution, in physical units.

    Returns
    -------
    ndarray (n_w,)
        An equivalent solution.
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
    """Return values within pi of the one before, around zero and within bounds; None if unchanged or impossible."""
    if np.all(np.abs(np.diff(values)) <= np.pi):
        return None
    near = np.unwrap(values)
    least, most = np.ceil(np.max(lower - near) / TURN), np.floor(np.min(upper - near) / TURN)
    if least > most:
        return None
    return np.asarray(near + TURN * np.clip(-np.round(np.mean(near) / TURN), least, most))


def _alike(nlp: Nlp, w: Array, other: Array) -> bool:
    """Whether two decision vectors have the same rows and the same objective."""
    outputs, others = nlp.outputs(w), nlp.outputs(other)
    rows = (nlp.values(other, others) - nlp.values(w, outputs)) * nlp.row_scale
    objective = nlp.objective(w, outputs)
    change = abs(nlp.objective(other, others) - objective)
    return bool(np.max(np.abs(rows), initial=0.0) <= SAME and change <= SAME * (1 + abs(objective)))
