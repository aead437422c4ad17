"""Whatever a user's expression returned on numbers, as floats."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj.witness.protocols import Array


def as_numbers(values: Any, what: str) -> Array:
    """Flatten a scalar, a list, a NumPy array or a CasADi value without symbols into floats (n,).

    Raises
    ------
    InputError
        The value is no number, or symbols are left in it; ``what`` names the expression.
    """
    if isinstance(values, list) and all(isinstance(value, float) for value in values):
        return np.array(values)
    try:
        return np.array(_flat(values), dtype=float)
    except (TypeError, ValueError, RuntimeError) as error:
        raise InputError(
            f"The {what} did not give numbers when evaluated on a numeric point, but {values!r}; "
            f"use only the point and constants in it."
        ) from error


def _flat(values: Any) -> list[float]:
    if isinstance(values, ca.SX | ca.MX):
        values = ca.evalf(values)
    if isinstance(values, ca.DM):
        # Columns first: the order in which CasADi itself flattens a matrix.
        return [float(entry) for entry in values.full().ravel(order="F")]
    if isinstance(values, np.ndarray):
        return [number for entry in values.ravel().tolist() for number in _flat(entry)]
    if isinstance(values, Sequence) and not isinstance(values, str):
        return [number for entry in values for number in _flat(entry)]
    return [float(values)]
