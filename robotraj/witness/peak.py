"""The largest value of a named quantity and its time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass


@dataclass(frozen=True)
class Peak(OneLine):
    """The largest magnitude of one quantity.

    Attributes
    ----------
    name, unit : str
    value : float
        Largest magnitude.
    time : float
        Time of it [s].
    phase : str
    """

    name: str
    unit: str
    value: float
    time: float
    phase: str


def peaks(names: Sequence[str], units: Sequence[str], times: Array, values: Array, phase: str) -> dict[str, Peak]:
    """Return the largest magnitude of each column of values (m, n) at times (m,); NaN counts as infinite."""
    sizes = np.nan_to_num(np.abs(values), nan=np.inf)
    found = {}
    for i, (name, unit) in enumerate(zip(names, units, strict=True)):
        worst = int(np.argmax(sizes[:, i]))
        found[name] = Peak(name, unit, float(sizes[worst, i]), float(times[worst]), phase)
    return found


def largest(parts: Iterable[Mapping[str, Peak]]) -> dict[str, Peak]:
    """Merge peaks of several phases by name: the largest of each name."""
    merged: dict[str, Peak] = {}
    for part in parts:
        for name, peak in part.items():
            if name not in merged or peak.value > merged[name].value:
                merged[name] = peak
    return merged
