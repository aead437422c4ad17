"""Times of exported samples."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.checks import number, whole
from robotraj._util.errors import InputError
from robotraj._util.printing import brief

MOST = 2_000_000
"""Largest number of samples of a file: half an hour of a controller at 1 kHz."""
SHORTEST = 1e-3
"""Length relative to the other periods below which a last period is joined to the one before it."""
FORMULAS = ("=", "+", "-", "@", "\t", "\r")
"""First letters at which a spreadsheet takes a cell for a formula, which may start programs."""


def sample_times(start: float, end: float, samples: int | Sequence[float], rate: float | None = None) -> Array:
    """Return strictly ascending times of samples [s].

    Parameters
    ----------
    start, end : float
        Start and end of the motion [s].
    samples : int or sequence of float
        Number of equally spaced times, or the times [s]; ignored with ``rate``.
    rate : float, optional
        Samples per second [Hz]: start, start + 1 / rate, ..., end. The last period is shorter where the duration is no
        multiple of the others.

    Raises
    ------
    InputError
        Fewer than 2 samples, more than ``MOST``, a rate that is not above 0, or an empty list.
    """
    if rate is not None:
        if not number("rate", rate, 0.0, MOST / (end - start) if end > start else MOST, "samples per second") > 0.0:
            raise InputError(f"rate={rate}: give samples per second above 0, such as 1000.")
        count = int(np.floor((end - start) * rate - SHORTEST)) + 1
        return np.append(start + np.arange(count) / rate, end)
    if not isinstance(samples, int | np.integer):
        times = np.asarray(samples, dtype=float)
        if times.ndim != 1 or not 0 < times.size <= MOST or not np.isfinite(times).all():
            raise InputError(f"samples= is a number of samples or a list of times [s]; got {brief(samples)}.")
        return times
    return np.linspace(start, end, whole("samples", samples, 2, MOST))


def cell(text: str) -> str:
    """Return the text of a cell of a CSV file; an apostrophe keeps a spreadsheet from computing it."""
    safe = text.encode("utf-8", "backslashreplace").decode("utf-8")
    return f"'{safe}" if safe.lstrip(" ").startswith(FORMULAS) else safe


def yaml_text(text: str) -> str:
    """Return a double-quoted text of YAML that reads back as the same text.

    JSON's own escapes write letters beyond U+FFFF as two, which YAML does not join.
    """
    letters = (
        f"\\{letter}" if letter in '"\\' else letter if letter.isprintable() else f"\\U{ord(letter):08x}"
        for letter in text
    )
    return f'"{"".join(letters)}"'
