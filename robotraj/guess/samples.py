"""Checks of arrays over time: shapes, finite numbers and names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, unknown_name

Samples = ArrayLike | Mapping[str, ArrayLike]
"""Values at m times: (m, n), (m,) for one variable, a number for constant values, or these by name."""


def ascending_times(values: ArrayLike, what: str) -> Array:
    """Return times (m,) [s].

    Raises
    ------
    InputError
        Fewer than two times, a number that is not finite, or times that do not ascend.
    """
    times = _numbers(values, f"times of {what}")
    if times.ndim != 1 or len(times) < 2:
        raise InputError(f"times of {what} has shape {times.shape}; give a vector of at least two times [s].")
    steps = np.diff(times)
    if not np.all(steps > 0):
        i = int(np.flatnonzero(steps <= 0)[0])
        raise InputError(
            f"times of {what} must ascend, but entry {i + 1} is {times[i + 1]:g} s after {times[i]:g} s; "
            "sort the samples and remove repeated times."
        )
    return times


def check_samples(given: Samples, count: int, what: str) -> Array | dict[str, Array]:
    """Return arrays whose first axis has ``count`` entries; numbers become constant.

    Raises
    ------
    InputError
        Another length, more than two axes, or a number that is not finite.
    """
    if isinstance(given, Mapping):
        return {name: _column(value, count, f"{what} of {name!r}") for name, value in given.items()}
    values = _numbers(given, what)
    if values.ndim == 0:
        return values
    if values.ndim > 2 or len(values) != count:
        turned = " Transpose it." if values.ndim == 2 and values.shape[1] == count else ""
        raise InputError(
            f"{what} has shape {values.shape}; its first axis must have one entry a time, {count}.{turned}"
        )
    return values


def named_samples(
    values: Array | Mapping[str, Array], names: Sequence[str], count: int, what: str, kind: str
) -> dict[str, Array]:
    """Return the columns (m,) of checked samples by name; names that a mapping leaves out are absent.

    Raises
    ------
    InputError
        An unknown name, or an array with another number of columns.
    """
    if isinstance(values, Mapping):
        for name in values:
            if name not in names:
                raise unknown_name(kind, name, names, f"Correct the name in {what}.")
        return dict(values)
    if values.ndim == 0:
        return {name: np.full(count, float(values)) for name in names}
    table = values.reshape(count, -1)
    if table.shape[1] != len(names):
        raise InputError(f"{what} has {table.shape[1]} columns; it needs {len(names)}: {', '.join(names) or 'none'}.")
    return {name: table[:, i] for i, name in enumerate(names)}


def _column(given: ArrayLike, count: int, what: str) -> Array:
    values = _numbers(given, what)
    if values.ndim == 0:
        return np.full(count, float(values))
    if values.size != count or max(values.shape) != count:
        raise InputError(f"{what} has shape {values.shape}; give one number a time, {count}, or one for all times.")
    return values.reshape(count)


def _numbers(given: ArrayLike, what: str) -> Array:
    """Return a read-only copy with finite entries."""
    try:
        values = np.array(given, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{what} must be an array of numbers; got {given!r}.") from error
    if not np.all(np.isfinite(values)):
        i = [int(k) for k in np.argwhere(~np.isfinite(values))[0]]
        raise InputError(f"{what} is {values[tuple(i)]} at index {i}; give finite numbers.")
    values.setflags(write=False)
    return values
