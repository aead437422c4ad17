"""Bounds of functions of time over intervals, by interval arithmetic on their graph.

Source: Moore, Kearfott and Cloud, Introduction to Interval Analysis, SIAM 2009, chapters 2 and 5. Rounding is not
directed: bounds are exact to a few units in the last place.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError

Range = tuple[Array, Array]


def ranges_of(function: ca.Function, lower: Array, upper: Array, what: str) -> Range:
    """Return bounds (n, K) of the outputs (n,) of a function of t over intervals [lower, upper] (K,).

    Parameters
    ----------
    function : casadi.Function
        A graph of SX with one input t and one dense column as result.
    lower, upper : ndarray (K,)
        [s].
    what : str
        Name of the function, for messages.

    Raises
    ------
    InputError
        The graph has an operation without interval arithmetic here.
    """
    work: dict[int, Range] = {}
    kinds: dict[int, str] = {}
    outputs = np.zeros((2, int(function.numel_out(0)), len(lower)))
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        read, written = function.instruction_input(k), function.instruction_output(k)
        kind = ""
        if operation == ca.OP_INPUT:
            work[written[0]] = lower, upper
        elif operation == ca.OP_OUTPUT:
            outputs[0, written[1]], outputs[1, written[1]] = work[read[0]]
        elif operation == ca.OP_CONST:
            value = np.full(len(lower), function.instruction_constant(k))
            work[written[0]] = value, value
        elif operation in _UNARY:
            work[written[0]] = _UNARY[operation](*work[read[0]])
        elif operation in _BINARY:
            found = _BINARY[operation](work[read[0]], work[read[1]])
            inputs = tuple(kinds.get(place, "") for place in read)
            if operation == ca.OP_DIV and inputs == ("comparison", "sum of comparisons"):
                # CasADi's slopes of fmin and fmax are (a <= b) / ((a <= b) + (b <= a)), which lie in [0, 1].
                found = np.clip(found[0], 0.0, 1.0), np.clip(found[1], 0.0, 1.0)
            work[written[0]] = found
            is_sum = operation == ca.OP_ADD and inputs == ("comparison", "comparison")
            kind = "comparison" if operation in (ca.OP_LT, ca.OP_LE) else "sum of comparisons" if is_sum else ""
        else:
            raise InputError(
                f"{what}: its speed cannot be bounded, since the function uses an unsupported operation. Write it with "
                "+ - * /, sin, cos, tan, exp, log, sqrt, tanh, fabs, fmin and fmax."
            )
        if operation != ca.OP_OUTPUT:
            kinds[written[0]] = kind
    return outputs[0], outputs[1]


def _of_corners(*corners: Array) -> Range:
    return np.minimum.reduce(corners), np.maximum.reduce(corners)


def _multiplied(a: Range, b: Range) -> Range:
    """Multiply two ranges; zero times an infinite bound is zero, since all values are finite."""
    with np.errstate(invalid="ignore"):
        corners = (a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1])
    return _of_corners(*(np.nan_to_num(corner, nan=0.0, posinf=np.inf, neginf=-np.inf) for corner in corners))


def _compared(always: NDArray[np.bool_], never: NDArray[np.bool_]) -> Range:
    """Return the bounds of a comparison, 1 where it holds."""
    return np.where(always, 1.0, 0.0), np.where(never, 0.0, 1.0)


def _inverse(low: Array, high: Array) -> Range:
    crosses = (low <= 0.0) & (high >= 0.0)
    with np.errstate(divide="ignore"):
        return np.where(crosses, -np.inf, 1.0 / high), np.where(crosses, np.inf, 1.0 / low)


def _square(low: Array, high: Array) -> Range:
    crosses = (low <= 0.0) & (high >= 0.0)
    ends = _of_corners(low * low, high * high)
    return np.where(crosses, 0.0, ends[0]), ends[1]


def _sine(low: Array, high: Array) -> Range:
    least, most = _of_corners(np.sin(low), np.sin(high))
    has_top = np.floor((high - 0.5 * np.pi) / (2 * np.pi)) >= np.ceil((low - 0.5 * np.pi) / (2 * np.pi))
    has_bottom = np.floor((high + 0.5 * np.pi) / (2 * np.pi)) >= np.ceil((low + 0.5 * np.pi) / (2 * np.pi))
    return np.where(has_bottom, -1.0, least), np.where(has_top, 1.0, most)


def _cosine(low: Array, high: Array) -> Range:
    return _sine(low + 0.5 * np.pi, high + 0.5 * np.pi)


def _tangent(low: Array, high: Array) -> Range:
    return _multiplied(_sine(low, high), _inverse(*_cosine(low, high)))


def _root(low: Array, high: Array) -> Range:
    return np.sqrt(np.maximum(low, 0.0)), np.sqrt(np.maximum(high, 0.0))


def _logarithm(low: Array, high: Array) -> Range:
    with np.errstate(divide="ignore"):
        return np.log(np.maximum(low, 0.0)), np.log(np.maximum(high, 0.0))


def _magnitude(low: Array, high: Array) -> Range:
    crosses = (low <= 0.0) & (high >= 0.0)
    ends = _of_corners(np.abs(low), np.abs(high))
    return np.where(crosses, 0.0, ends[0]), ends[1]


_UNARY: dict[int, Callable[[Array, Array], Range]] = {
    ca.OP_ASSIGN: lambda low, high: (low, high),
    ca.OP_NEG: lambda low, high: (-high, -low),
    ca.OP_INV: _inverse,
    ca.OP_SQ: _square,
    ca.OP_TWICE: lambda low, high: (2.0 * low, 2.0 * high),
    ca.OP_SIN: _sine,
    ca.OP_COS: _cosine,
    ca.OP_TAN: _tangent,
    ca.OP_SQRT: _root,
    ca.OP_FABS: _magnitude,
    ca.OP_EXP: lambda low, high: (np.exp(low), np.exp(high)),
    ca.OP_LOG: _logarithm,
    ca.OP_TANH: lambda low, high: (np.tanh(low), np.tanh(high)),
    ca.OP_SIGN: lambda low, high: (np.sign(low), np.sign(high)),
    ca.OP_NOT: lambda low, high: (np.zeros_like(low), np.ones_like(low)),
}
_BINARY: dict[int, Callable[[Range, Range], Range]] = {
    ca.OP_ADD: lambda a, b: (a[0] + b[0], a[1] + b[1]),
    ca.OP_SUB: lambda a, b: (a[0] - b[1], a[1] - b[0]),
    ca.OP_MUL: _multiplied,
    ca.OP_DIV: lambda a, b: _multiplied(a, _inverse(*b)),
    ca.OP_FMIN: lambda a, b: (np.minimum(a[0], b[0]), np.minimum(a[1], b[1])),
    ca.OP_FMAX: lambda a, b: (np.maximum(a[0], b[0]), np.maximum(a[1], b[1])),
    ca.OP_LT: lambda a, b: _compared(a[1] < b[0], a[0] >= b[1]),
    ca.OP_LE: lambda a, b: _compared(a[1] <= b[0], a[0] > b[1]),
}
