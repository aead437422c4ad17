"""Limits in the forms that users may give: numbers, pairs, intervals, arrays of magnitudes, and mappings by joint."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol, TypeAlias, cast

import numpy as np
import numpy.typing as npt

from robotraj._util.errors import InputError


class Interval(Protocol):
    """An object with lower and upper bounds, such as ``rt.between`` returns."""

    @property
    def lower(self) -> float | None:
        """Lower bound."""

    @property
    def upper(self) -> float | None:
        """Upper bound."""


Ends: TypeAlias = "float | Sequence[float | None] | Interval"
"""Limits of one joint: x for [-x, x], a pair, or an object with ``lower`` and ``upper``."""
PositionLimits: TypeAlias = "Ends | Mapping[str, Ends]"
RateLimits: TypeAlias = "npt.ArrayLike | Interval | Mapping[str, Ends]"


def ends_for_all(quantity: str, value: object, joints: Sequence[str], free: int) -> Iterable[tuple[int, object]]:
    """Return the joints that a value without names limits, by number, each with its ``Ends``.

    Parameters
    ----------
    quantity : str
        Only ``"position"`` takes a pair (lower, upper); others take an array of magnitudes, one for each joint.
    value : number, pair, array or interval
    joints : sequence of str
    free : int
        Number of the root's entries, which one value for all leaves out.

    Raises
    ------
    InputError
        The value has another size, or is no number.
    """
    whole = range(free, len(joints))
    if quantity == "position" or _is_interval(value):
        return [(i, value) for i in whole]
    try:
        sizes = np.asarray(value, dtype=float).reshape(-1)
    except (TypeError, ValueError) as error:
        raise InputError(f"The {quantity} limit is no number: {value!r}.") from error
    if sizes.size not in (1, len(joints)):
        each = f" or {len(joints)}, in the order {', '.join(joints)}" if len(joints) > 1 else ""
        raise InputError(
            f"The {quantity} limit has {sizes.size} values; give 1{each}, or rt.between(lower, upper) for two sides."
        )
    chosen = whole if sizes.size == 1 else range(len(joints))
    return list(zip(chosen, np.broadcast_to(sizes, len(chosen)).tolist(), strict=True))


def pair_of(quantity: str, joint: object, value: object) -> tuple[float, float]:
    """Read ``Ends``: 2.0, (lower, upper) or an object with ``lower`` and ``upper``, such as ``rt.between`` makes."""
    what = f"{quantity} limit of {joint!r}"
    ends: Sequence[object]
    if _is_interval(value):
        ends = (value.lower, value.upper)  # type: ignore[attr-defined]  # an interval
    elif np.ndim(cast("npt.ArrayLike", value)) == 0:
        size = as_number(what, value)
        if not size >= 0.0:
            raise InputError(
                f"The {what} is {size:g}; a number x stands for [-x, x] and must be positive. Give (lower, upper) for "
                "two sides."
            )
        ends = (-size, size)
    else:
        ends = cast("Sequence[object]", value)
    if len(ends) != 2:
        raise InputError(f"The {quantity} limits of {joint!r} are a pair (lower, upper); got {value!r}.")
    low = -np.inf if ends[0] is None else as_number(f"lower {what}", ends[0])
    high = np.inf if ends[1] is None else as_number(f"upper {what}", ends[1])
    if not low <= high:
        raise InputError(
            f"The {quantity} limits of {joint!r} are [{low:g}, {high:g}]: the lower must be below the upper."
        )
    return low, high


def _is_interval(value: object) -> bool:
    return not isinstance(value, str) and hasattr(value, "lower") and hasattr(value, "upper")


def as_number(what: str, value: object) -> float:
    """Return a number; raise an InputError that names it otherwise."""
    try:
        return float(value)  # type: ignore[arg-type]  # a TypeError becomes an InputError
    except (TypeError, ValueError) as error:
        raise InputError(f"The {what} is no number: {value!r}.") from error
