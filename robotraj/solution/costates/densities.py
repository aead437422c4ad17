"""Multipliers of rows along time as densities and impulses."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass

STANDS_OUT = 4.0
"""Ratio to the larger density beside it above which a multiplier is an impulse."""


@dataclass(frozen=True, eq=False)
class Density(OneLine):
    """Densities [per second] and impulses, (places, n) each; multiplier = weight * density + impulse."""

    density: Array
    impulse: Array


def split(multipliers: Array, weights: Array) -> Density:
    """Split multipliers into smooth densities and single impulses.

    Parameters
    ----------
    multipliers : ndarray (places, n)
        Multipliers in the order of time.
    weights : ndarray (places,)
        Quadrature weight of each place [s].
    """
    raw = multipliers / weights[:, None]
    padded = np.vstack([raw[1:2], raw, raw[-2:-1]]) if len(raw) > 1 else np.vstack([raw, raw, raw])
    before, after = padded[:-2], padded[2:]
    alone = np.abs(raw) > STANDS_OUT * np.maximum(np.abs(before), np.abs(after))
    density = np.where(alone, 0.5 * (before + after), raw)
    return Density(density, np.where(alone, multipliers - weights[:, None] * density, 0.0))


def run_out(beside: Array) -> Array:
    """Extrapolate densities by one place along a line through the two before it, (2, n), nearest first.

    They are zero where the two are no arc: if their signs differ, or the nearer one is an impulse.
    """
    if len(beside) < 2:
        return np.zeros(beside.shape[1])
    near, far = beside
    arc = (near * far > 0) & (np.abs(near) <= STANDS_OUT * np.abs(far))
    ahead = 2 * near - far
    return np.where(arc & (ahead * near > 0), ahead, 0.0)
