"""Automatic scaling: unknowns of order one, rows with gradients of order one.

A variable is scaled by its bounds where both are finite, else by the guess; all its instances share the scale.
Durations are scaled by the guess alone: bounds such as 0 to 200 s say little about a motion of 6 s, and a unit that
large lets the first steps shrink the duration to nothing. A row is scaled by the largest gradient, in scaled
variables, of its kind at the guess. Source: Betts, Practical Methods for Optimal Control (2010), section 1.16.5.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from robotraj.transcription.assembly import row_magnitudes
from robotraj.transcription.block import Block
from robotraj.transcription.table import Scalars

Array = NDArray[np.float64]

LEAST, GREATEST = 1e-3, 1e4


def variable_scale(variables: Scalars, guess: Array) -> Array:
    """Scale of every column, (n_w,)."""
    scales = np.ones(len(variables.entries))
    for number in np.unique(variables.meaning):
        chosen = variables.meaning == number
        low, high = variables.lower[chosen], variables.upper[chosen]
        both = np.isfinite(low) & np.isfinite(high) & (high > low)
        size = np.max(np.maximum(np.abs(low[both]), np.abs(high[both]))) if both.any() else 0.0
        if not both.any() or size > 1e3 or variables.entries[number].name == "duration":
            fixed = np.abs(low[np.isfinite(low) & (low == high)])
            size = max(float(np.max(np.abs(guess[chosen]))), float(np.max(fixed, initial=0.0)))
        scales[number] = np.clip(size, LEAST, GREATEST) if size > 0 else 1.0
    return scales[variables.meaning]


def row_scale(blocks: Sequence[Block], linear: sparse.csr_array, rows: Scalars, scale: Array, guess: Array) -> Array:
    """Scale of every row, (n_g,)."""
    plain = [block.scaled(scale, np.ones(len(rows))) for block in blocks]
    scaled_linear = sparse.csr_array(linear @ sparse.diags_array(scale))
    magnitudes = row_magnitudes(plain, scaled_linear, guess / scale)
    largest = np.zeros(len(rows.entries))
    np.maximum.at(largest, rows.meaning, np.where(np.isfinite(magnitudes), magnitudes, 0.0))
    return 1.0 / np.clip(np.where(largest > 0, largest, 1.0), LEAST, GREATEST)[rows.meaning]
