"""Checks of an argument: one real number or integer within bounds, or a list of names."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from fractions import Fraction
from typing import TypeGuard

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.printing import short

LONGEST = 10**8
"""Largest number of entries of an argument, which would take 800 MB as doubles."""


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is one real number; ``True`` and ``False`` are not."""
    return isinstance(value, float | int | np.floating | np.integer) and not isinstance(value, bool)


def is_whole(value: object) -> TypeGuard[int]:
    """Whether a value is one integer; ``True`` and ``False`` are not."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def is_finite(value: object) -> TypeGuard[float]:
    """Whether a value is one real number that a double can hold."""
    return is_number(value) and abs(value) <= sys.float_info.max


def unusable(value: object) -> str:
    """Describe what no double, file or memory can hold: a huge or complex number, half a character, too many entries.

    Entries of tuples, lists, mappings and arrays of objects, and fields of values, are looked at. The answer is ""
    where nothing is found.
    """
    if isinstance(value, str):
        return "" if _is_text(value) else f"{value!r}, which is no valid text: a surrogate stands alone."
    if isinstance(value, int | Fraction) and not -sys.float_info.max <= value <= sys.float_info.max:
        return "a number that is too large; numbers are of at most 1.8e308."
    if isinstance(value, complex | np.complexfloating):
        return f"the complex number {value}; give a real one."
    entries = value.size if isinstance(value, np.ndarray) else len(value) if isinstance(value, range) else 0
    if entries > LONGEST:
        return f"{entries} entries; at most {LONGEST} are taken."
    if isinstance(value, np.ndarray):
        value = value.tolist() if value.dtype.kind in "OcSU" else ()
    if isinstance(value, Mapping):
        value = [*value, *value.values()]
    elif is_dataclass(value) and not isinstance(value, type):
        value = [getattr(value, field.name, None) for field in fields(value)]
    return next(filter(None, map(unusable, value)), "") if isinstance(value, tuple | list) else ""


def _is_text(value: str) -> bool:
    try:
        value.encode()
    except UnicodeEncodeError:
        return False
    return True


def number(what: str, value: object, least: float, most: float = math.inf, unit: str = "") -> float:
    """Return one real number within bounds.

    Parameters
    ----------
    what : str
        Label of the argument for messages.
    value : object
        What the caller passed.
    least, most : float
        The bounds, both allowed.
    unit : str
        For messages.

    Raises
    ------
    InputError
        The value is no real number, NaN, or outside the bounds.
    """
    if not is_number(value) or not least <= value <= min(most, sys.float_info.max if is_whole(value) else most):
        unit = unit and f" {unit}"
        wanted = f"from {least:g} to {most:g}" if most < math.inf else f"of at least {least:g}"
        raise InputError(f"{what} must be a number {wanted}{unit}, got {short(value)}.")
    return float(value)


def whole(what: str, value: object, least: int, most: int) -> int:
    """Return one integer within bounds; the parameters are those of ``number``.

    Raises
    ------
    InputError
        The value is no integer, or outside the bounds.
    """
    if not is_whole(value) or not least <= value <= most:
        raise InputError(f"{what} must be a whole number from {least} to {most}, got {short(value)}.")
    return int(value)


def names(what: str, given: object) -> list[str]:
    """Return a list of names.

    Parameters
    ----------
    what : str
        Label of the argument for messages.
    given : object
        What the caller passed.

    Raises
    ------
    InputError
        The value is one string, or no iterable of strings.
    """
    listed = list(given) if isinstance(given, Iterable) and not isinstance(given, str | bytes) else [None]
    strings = [name for name in listed if isinstance(name, str)]
    if len(strings) < len(listed):
        raise InputError(f"{what} must be a list of names, got {given!r}.")
    return strings
