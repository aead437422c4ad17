"""Conversion of the values of a user's expression to floats."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError


def as_numbers(values: object, what: str) -> Array:
    """Flatten a scalar, a sequence, a NumPy array or a CasADi value without symbols into floats (n,).

    Raises
    ------
    InputError
        A value is not a number, or contains symbols; ``what`` names the expression.
    """
    if isinstance(values, list) and all(isinstance(value, float) for value in values):
        return np.array(values)
    try:
        return np.array(_flat(values), dtype=float)
    except (TypeError, ValueError, RuntimeError) as error:
        raise InputError(
            f"The {what} did not give numbers when evaluated on a numeric point, but {values!r}; "
            f"write it with the point and constants only."
        ) from error


def _flat(values: object) -> list[float]:
    if isinstance(values, ca.SX | ca.MX):
        values = ca.evalf(values)
    if isinstance(values, ca.DM):
        # Column after column, as CasADi flattens a matrix.
        return [float(entry) for entry in values.full().ravel(order="F")]
    if isinstance(values, np.ndarray):
        return [number for entry in values.ravel().tolist() for number in _flat(entry)]
    if isinstance(values, Sequence) and not isinstance(values, str):
        return [number for entry in values for number in _flat(entry)]
    return [float(cast("float", values))]
