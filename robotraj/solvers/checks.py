"""Checks of the options of solvers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from robotraj._util.checks import is_number
from robotraj._util.errors import InputError

LARGEST = np.iinfo(np.intc).max
"""Largest count: solvers count with C's int."""


LOOSEST = 0.1
"""Largest optimality tolerance: above it nothing is optimal."""


def no_mapping(solver: str, value: object) -> None:
    """Raise an InputError where a mapping of options is given in place of a solver's first argument."""
    if isinstance(value, Mapping):
        own = " Options by the solver's own names stand in options={...}." if solver == "Ipopt" else ""
        raise InputError(
            f"{solver} takes its options as keywords, such as rt.{solver}(max_iterations=200); got {value!r}.{own}"
        )


def above_zero(name: str, value: object, unit: str = "", most: float = np.inf) -> None:
    """Raise an InputError unless ``value`` is a real number above 0 and at most ``most``.

    The name is as in ``"Ipopt(tolerance)"``.
    """
    if not is_number(value) or not 0 < value <= most:
        below = f" and at most {most:g}" if most < np.inf else ""
        raise InputError(f"{name} must be a number above 0{below}{unit and ' '}{unit}, got {value!r}.")


def counted(name: str, value: object) -> None:
    """Raise an InputError unless ``value`` is a whole number from 1 to ``LARGEST``."""
    if not isinstance(value, int | np.integer) or isinstance(value, bool) or not 1 <= value <= LARGEST:
        raise InputError(f"{name} must be a whole number of at least 1 and at most {LARGEST}, got {value!r}.")


def named_options(name: str, value: object) -> None:
    """Raise an InputError unless ``value`` maps names to options; ``name`` as in ``"Ipopt(options)"``."""
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise InputError(f'{name} is a mapping of names, such as {{"mu_init": 0.1}}; got {value!r}.')
