"""Checks of an argument: one real number or integer within bounds, or a list of names."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable
from typing import TypeGuard

import numpy as np

from robotraj._util.errors import InputError

_DIGITS = 30
"""Integers of more digits are not written out in messages."""


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is one real number; ``True`` and ``False`` are not."""
    return isinstance(value, float | int | np.floating | np.integer) and not isinstance(value, bool)


def is_whole(value: object) -> TypeGuard[int]:
    """Whether a value is one integer; ``True`` and ``False`` are not."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


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
        raise InputError(f"{what} must be a number {wanted}{unit}, got {_short(value)}.")
    return float(value)


def whole(what: str, value: object, least: int, most: int) -> int:
    """Return one integer within bounds; the parameters are those of ``number``.

    Raises
    ------
    InputError
        The value is no integer, or outside the bounds.
    """
    if not is_whole(value) or not least <= value <= most:
        raise InputError(f"{what} must be a whole number from {least} to {most}, got {_short(value)}.")
    return int(value)


def _short(value: object) -> str:
    """Print a value; integers of thousands of digits are not written out."""
    if is_whole(value) and abs(value) >= 10**_DIGITS:
        return f"an integer of more than {_DIGITS} digits"
    return repr(value)


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
