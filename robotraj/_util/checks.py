"""Checks of the kind of an argument: one real number, one integer, or a list of names."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from robotraj._util.errors import InputError


def is_number(value: object) -> bool:
    """Whether a value is one real number; ``True`` and ``False`` are not."""
    return isinstance(value, float | int | np.floating | np.integer) and not isinstance(value, bool)


def is_whole(value: object) -> bool:
    """Whether a value is one integer; ``True`` and ``False`` are not."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


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
