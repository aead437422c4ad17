"""Conversion of the values of user expressions to rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import cast

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError, called

TRIAL_VALUE = 0.7
"""Value of all symbols in a trial evaluation; roots, logarithms and divisions are defined there."""


def rows_of(what: str, function: Callable[..., object], *arguments: object) -> list[ca.SX]:
    """Call a user's function on symbols and flatten its result.

    Parameters
    ----------
    what : str
        Label of the function for messages: ``"expression of constraint 'effort'"``.
    function : callable
    *arguments
        Points or symbols, the function's arguments.

    Raises
    ------
    FailedExpression
        The function raised an error that is not robotraj's.
    InputError
        It returned values that are neither numbers nor SX, or NaN for a symbol, as ``math.sin`` does.
    """
    rows = as_rows(called(what, function, *arguments), what)
    for i in _nan_rows(rows):
        if _holds_nan(rows[i]):
            which = "" if len(rows) == 1 else f" in row {i}"
            raise InputError(
                f"The {what} is NaN{which} at every point: functions of Python's math return NaN for CasADi symbols. "
                "Write casadi.sin for math.sin, and so on."
            )
    return rows


def as_rows(values: object, what: str) -> list[ca.SX]:
    """Flatten a scalar, a list or a CasADi/NumPy column that a user expression returned into a list of SX.

    Raises
    ------
    InputError
        A value is neither a number nor SX.
    """
    try:
        if isinstance(values, ca.SX | ca.DM | ca.MX):
            column = ca.SX(values)
            return [column[i] for i in range(column.numel())]
        # The ravel of a NumPy scalar returns an array of that scalar: the recursion would not end.
        if isinstance(values, Sequence) or (hasattr(values, "ravel") and not isinstance(values, np.generic)):
            parts = cast("Iterable[object]", values.ravel() if hasattr(values, "ravel") else values)
            return [row for part in parts for row in as_rows(part, what)]
        # float() discards the imaginary part of a complex number; CasADi converts a generator to an empty matrix.
        row = ca.SX(float(values) if isinstance(values, np.number | np.bool_) and np.isrealobj(values) else values)
        if not row.is_scalar():
            raise TypeError("no scalar")
        return [row]
    except (TypeError, RuntimeError) as error:
        raise InputError(
            f"The {what} must return numbers or CasADi SX expressions of the point, got {type(values).__name__}."
        ) from error


def _nan_rows(rows: Sequence[ca.SX]) -> list[int]:
    """Return the indices of expressions that are NaN at one trial point, from a single function of all of them."""
    if not rows:
        return []
    column = ca.vertcat(*rows)
    symbols = ca.symvar(column)
    function = ca.Function("rows", [ca.vertcat(ca.SX(0, 1), *symbols)], [ca.densify(column)])
    values = np.array(function(ca.DM.ones(len(symbols)) * TRIAL_VALUE)).ravel()
    return [int(i) for i in np.flatnonzero(np.isnan(values))]


def _holds_nan(row: ca.SX) -> bool:
    """Whether NaN is a constant of an expression; roots and logarithms may be NaN only at the trial point."""
    symbols = ca.symvar(row)
    function = ca.Function("row", [ca.vertcat(ca.SX(0, 1), *symbols)], [row])
    numbers = [k for k in range(function.n_instructions()) if function.instruction_id(k) == ca.OP_CONST]
    return any(math.isnan(function.instruction_constant(k)) for k in numbers)
