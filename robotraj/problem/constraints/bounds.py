"""Bounds in the forms that users may give: numbers, ``rt.between``, None for a free value, and mappings by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any, NamedTuple, TypeAlias, TypeGuard, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import OneLine, short
from robotraj._util.values import dataclass, own

UNBOUNDED = 1e20
"""Numbers above this count as infinite: URDF readers write 1.8e308 for a joint without limits."""

SideLike: TypeAlias = float | Sequence[float] | NDArray[np.float64] | None
"""Lower or upper bounds of one value or several; None leaves the side open."""


@dataclass(frozen=True)
class Between(OneLine):
    """An interval [lower, upper]; make one with ``rt.between``."""

    lower: SideLike
    upper: SideLike


@dataclass(frozen=True)
class NearTurn(OneLine):
    """An angle [rad] up to whole turns; make one with ``rt.turns``."""

    angle: float


Interval = float | Between | NearTurn | None
"""Bounds of one scalar: a number fixes it, ``rt.between`` bounds it, None leaves it free; ends may be ``rt.turns``."""

BoundsLike: TypeAlias = Interval | Sequence[Interval] | NDArray[np.float64] | Mapping[str, Interval]
"""Bounds of n scalars: one value for all, one for each, or some by name."""


def between(lower: SideLike, upper: SideLike) -> Between:
    """Bound a value: ``lower <= value <= upper``.

    Parameters
    ----------
    lower, upper : float or array_like or None
        Bounds in the value's own SI unit; None or an infinity leaves that side open.

    Raises
    ------
    InputError
        A bound is NaN, or a lower bound lies above its upper bound.
    """
    try:
        low, high = _numbers(-np.inf if lower is None else lower), _numbers(np.inf if upper is None else upper)
    except (TypeError, ValueError) as error:
        raise InputError(f"between({lower!r}, {upper!r}): bounds are numbers, or None for an open side.") from error
    if np.isnan(low).any() or np.isnan(high).any():
        raise InputError(f"between({lower}, {upper}) contains NaN; use None for an open side.")
    try:
        crossed = np.any(low > high)
    except ValueError as error:
        raise InputError(f"between(): lower has shape {low.shape} and upper {high.shape}; they must agree.") from error
    if crossed:
        raise InputError(f"between({lower}, {upper}): the lower bound lies above the upper bound; swap them.")
    return Between(own(lower), own(upper))


def turns(angle: float) -> NearTurn:
    """Ask for an angle up to whole turns, as an end of a joint's motion: ``rt.State(q={"wrist": rt.turns(-3.0)})``.

    The phase takes angle + 2 pi k with the whole number k that is nearest to the joint's other end, or to the neutral
    configuration where that is free, within the joint's position limits.

    Parameters
    ----------
    angle : float
        [rad].

    Raises
    ------
    InputError
        The angle is no finite number.
    """
    try:
        found = _numbers(angle)
    except (TypeError, ValueError) as error:
        raise InputError(f"turns({angle!r}): the angle is a finite number [rad].") from error
    if found.size != 1 or not np.isfinite(found).all():
        raise InputError(f"turns({angle!r}): the angle is a finite number [rad].")
    return NearTurn(found.item())


class Bounds(NamedTuple):
    """Lower and upper bounds, each (n,), infinite where open."""

    lower: NDArray[np.float64]
    upper: NDArray[np.float64]

    def alike(self, other: Bounds) -> bool:
        """Whether the same entries are fixed, and the bounds of the others are equal."""
        free, known = self.lower < self.upper, other.lower < other.upper
        pairs = zip(self, other, strict=True)
        return np.array_equal(free, known) and all(np.array_equal(mine[free], its[free]) for mine, its in pairs)


def as_bounds(value: object, names: Sequence[str], what: str, kind: str = "joint") -> Bounds:
    """Return the bounds of n named scalars.

    Parameters
    ----------
    value : None, number, Between, sequence of these, or mapping by name
        One value for all, one for each, or some by name (the others stay free).
    names : sequence of str
        The n names, in order.
    what : str
        Label of the value for messages: ``"start position"``.
    kind : str
        Kind of the names for messages: ``"joint"``, ``"state"`` ...

    Raises
    ------
    InputError
        A value is NaN, the length is wrong, or a name is unknown. The message names the entry.
    """
    n = len(names)
    if _is_mapping(value):
        lower, upper = np.full(n, -np.inf), np.full(n, np.inf)
        places = {name: i for i, name in enumerate(names)}
        for name, entry in value.items():
            if name not in places:
                raise unknown_name(kind, name, names, f"It was used in the {what}.")
            i = places[name]
            low, high = _pair(entry, f"{what} of {kind} {name!r}")
            if np.size(low) != 1 or np.size(high) != 1:
                raise InputError(
                    f"The {what} of {kind} {name!r} must be one number, None or rt.between; got {entry!r}."
                )
            lower[i], upper[i] = np.asarray(low).item(), np.asarray(high).item()
        return Bounds(lower, upper)
    if value is None or isinstance(value, Between) or _is_number(value) or _is_plain_array(value):
        low, high = _pair(value, what)
        lower = _filled(low, names, what)
        upper = lower.copy() if high is low else _filled(high, names, what)
        # Only bounds may be infinite; a value that fixes may not.
        fixes = value is not None and not isinstance(value, Between)
        for side in (lower,) if fixes else (lower, upper):
            bad = ~np.isfinite(side) if fixes else np.isnan(side)
            if bad.any():
                i = int(np.flatnonzero(bad)[0])
                wrong = "NaN" if np.isnan(side[i]) else "infinite"
                raise InputError(
                    f"The {what} of {kind} {names[i]!r} is {wrong}; give a number, or None to leave it free."
                )
        return Bounds(lower, upper)
    if isinstance(value, Sequence) and not isinstance(value, str):
        if len(value) != n:
            raise InputError(f"The {what} has {len(value)} values; it needs {n}: {', '.join(names)}.")
        return as_bounds(dict(zip(names, value, strict=True)), names, what, kind)
    raise InputError(
        f"The {what} must be None, a number, rt.between(lower, upper), a list of these or a dict by {kind}; "
        f"got {type(value).__name__}."
    )


def as_limits(value: BoundsLike) -> BoundsLike:
    """Return bounds in which every number x is replaced by the interval [-x, x], as in ``robot.limits.with_``.

    Raises
    ------
    InputError
        A number is negative or NaN.
    """
    if _is_mapping(value):
        return {name: _of_both_signs(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_of_both_signs(entry) for entry in value]
    return cast("BoundsLike", _of_both_signs(value))


def _of_both_signs(value: Any) -> Any:  # a number or an array becomes an interval, other values stay
    if value is None or isinstance(value, Between) or not _is_plain_array(value):
        return value
    size = _numbers(value)
    if not np.all(size >= 0.0):
        raise InputError(
            f"The limit {value!r} is no magnitude: a number x stands for [-x, x]. Give rt.between(lower, upper) for "
            "two sides."
        )
    return Between(-size, size)


def as_duration(value: float | Sequence[float] | Between, phase: str) -> tuple[float, float]:
    """Read the duration of a phase into its least and its greatest value [s].

    Parameters
    ----------
    value : float, (float, float) or Between
    phase : str
        Name of the phase, for messages.

    Raises
    ------
    InputError
        Another kind of value, a negative duration, NaN, or crossed bounds.
    """
    given, advice = value, "give seconds above 0, or (least, greatest)."
    single = isinstance(value, float | int | Between | Real) and not isinstance(value, bool)
    if not single:
        several = isinstance(value, tuple | list) or (isinstance(value, np.ndarray) and value.ndim == 1)
        if not several or len(value) != 2:  # type: ignore[arg-type]
            raise InputError(f"The duration of phase {phase!r} is {given!r}; {advice}")
        try:
            value = between(*value)  # type: ignore[misc]
        except InputError as error:
            raise InputError(f"The duration of phase {phase!r} is {given!r}: {error}") from error
    bounds = as_bounds(value, ["duration"], f"duration of phase {phase!r}", "value")
    low, high = float(bounds.lower[0]), float(bounds.upper[0])
    if high <= 0 or -np.inf < low < 0:
        raise InputError(f"The duration of phase {phase!r} is {given!r}; {advice}")
    return max(low, 0.0), high


def _is_mapping(value: object) -> TypeGuard[Mapping[str, object]]:
    """Whether a value is a mapping; usual types are tested first, since the abstract class is slow for new types."""
    plain = isinstance(value, int | float | tuple | list | np.ndarray | Between | None)
    return not plain and isinstance(value, Mapping)


def _is_number(value: object) -> bool:
    """Whether the value is a scalar of any kind, including a string."""
    return isinstance(value, int | float) or (not isinstance(value, tuple | list) and np.isscalar(value))


def _is_plain_array(value: object) -> bool:
    """Whether the value is an array or list that contains only numbers."""
    if isinstance(value, str) or _is_mapping(value):
        return False
    try:
        return np.asarray(value).dtype.kind in "fiub"
    except ValueError:
        return False


def _filled(side: ArrayLike, names: Sequence[str], what: str) -> NDArray[np.float64]:
    """Return a new array of one side's n values, which one number gives to all."""
    given = np.asarray(side, dtype=float)
    if given.ndim > 0 and given.size != len(names):
        raise InputError(f"The {what} has {given.size} values; it needs {len(names)}: {', '.join(names)}.")
    filled = np.empty(len(names))
    filled[:] = given.ravel()
    return filled


def _pair(value: object, what: str) -> tuple[ArrayLike, ArrayLike]:
    if value is None:
        return -np.inf, np.inf
    if isinstance(value, Between):
        low = np.asarray(-np.inf if value.lower is None else value.lower, dtype=float)
        high = np.asarray(np.inf if value.upper is None else value.upper, dtype=float)
        return np.where(low < -UNBOUNDED, -np.inf, low), np.where(high > UNBOUNDED, np.inf, high)
    try:
        number = _numbers(value)
    except (TypeError, ValueError, OverflowError) as error:
        advice = " Angles are in radians: np.radians(90)." if isinstance(value, str) and "deg" in value else ""
        raise InputError(
            f"The {what} must be a number, None or rt.between(lower, upper); got {short(value)}.{advice}"
        ) from error
    if number.size == 1 and not np.isfinite(number).all():
        wrong = "NaN" if np.isnan(number).any() else "infinite"
        raise InputError(f"The {what} is {wrong}; give a number, or None to leave it free.")
    return number, number


def _numbers(value: object) -> NDArray[np.float64]:
    """Convert to an array of numbers; NumPy would also convert text such as "1"."""
    array = np.asarray(value)
    if array.dtype.kind in "SUc":
        raise TypeError(f"{value!r} is {'complex' if array.dtype.kind == 'c' else 'text'}")
    return np.asarray(array, dtype=float)
