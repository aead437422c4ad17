"""What solvers ask of their numbers, before they start."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from robotraj._util.errors import InputError

LARGEST = 2**31 - 1
"""Solvers count in C's int."""


def above_zero(name: str, value: Any, unit: str = "") -> None:
    """Refuse what is no real number above 0; ``name`` as in ``"Ipopt(tolerance)"``."""
    if not isinstance(value, float | int | np.floating | np.integer) or isinstance(value, bool) or not value > 0:
        raise InputError(f"{name} must be above 0{unit and ' '}{unit}, got {value!r}.")


def counted(name: str, value: Any) -> None:
    """Refuse what is no whole number from 1 to the largest that solvers count to."""
    if not isinstance(value, int | np.integer) or isinstance(value, bool) or not 1 <= value <= LARGEST:
        raise InputError(f"{name} must be a whole number of at least 1 and at most {LARGEST}, got {value!r}.")


def named_options(name: str, value: Any) -> None:
    """Refuse what does not say options by their names; ``name`` as in ``"Ipopt(options)"``."""
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise InputError(f'{name} is a mapping of names, such as {{"mu_init": 0.1}}; got {value!r}.')
