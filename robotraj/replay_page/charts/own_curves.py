"""Curves that the caller adds to a page: expressions of a point in charts of their own, and measured values."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.arrays import Array
from robotraj._util.errors import FailedExpression, InputError, unknown_name
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.solution.cycles.gait_cycles import CyclePhase

Expressions: TypeAlias = Mapping[str, Callable[[Any], object]]
"""Functions of a ``Point`` by the title of their chart; a unit may stand in brackets at the end of the title."""
Measured: TypeAlias = Mapping[str, tuple[ArrayLike, ArrayLike]]
"""Times (m,) [s] and values (m,) by the name of the variable that was measured: ``"q.elbow_joint"``."""

COMPONENTS = ("x", "y", "z")
_UNIT = re.compile(r"^(?P<title>.*?)\s*(?:\[(?P<unit>[^\]]*)\])?$")


@dataclass(frozen=True)
class OwnCurves(OneLine):
    """What the caller adds to the curves of one solution.

    Attributes
    ----------
    expressions : mapping
    measured : dict
        Checked times and values (m,) by variable.
    """

    expressions: Expressions
    measured: dict[str, tuple[Array, Array]]

    @staticmethod
    def of(expressions: Expressions | None, measured: Measured | None) -> OwnCurves:
        """Check what ``rt.replay`` was given.

        Raises
        ------
        InputError
            No mapping, no function, times that do not increase, or values of another number.
        """
        for name, given in (("curves", expressions), ("measured", measured)):
            if given is not None and not isinstance(given, Mapping):
                raise InputError(f"replay: {name}= is a dict with one entry for each curve; got {given!r}.")
        for title, expression in (expressions or {}).items():
            if not callable(expression):
                raise InputError(
                    f"replay: curves={{{title!r}: ...}} takes a function of a point, such as "
                    f"lambda point: point.q[0]; got {expression!r}."
                )
        return OwnCurves(expressions or {}, {name: _checked(name, given) for name, given in (measured or {}).items()})

    def values(self, title: str, cycle_phase: CyclePhase, grids: list[Array]) -> Array:
        """Evaluate an expression on one grid of times for each interval; later periods repeat the planned one."""
        planned = cycle_phase.planned
        ago = cycle_phase.t0 - planned.t0
        expression = self.expressions[title]
        try:
            return np.concatenate([planned.values(expression, grid - ago, k) for k, grid in enumerate(grids)])
        except FailedExpression as error:
            raise FailedExpression(f"replay: curves={{{title!r}: ...}} takes a function of a point. {error}") from error

    def measured_at(self, variable: str, times: Array) -> Array:
        """Interpolate measured values; NaN before the first and after the last of them."""
        known, values = self.measured[variable]
        return np.interp(times, known, values, left=np.nan, right=np.nan)

    def check_variables(self, known: list[str]) -> None:
        """Refuse a measured variable that no chart shows."""
        for variable in self.measured:
            if variable not in known:
                raise unknown_name("curve", variable, known, "It was used in replay(measured=...).")


NO_CURVES = OwnCurves({}, {})


def heading(title: str, count: int) -> tuple[str, str, list[str]]:
    """Return the title of a chart, its unit and the labels of its curves: x, y and z for three values."""
    found = _UNIT.match(title)
    assert found is not None
    name = found["title"] or title
    parts = COMPONENTS if count == len(COMPONENTS) else range(1, count + 1)
    return name, found["unit"] or "", [name] if count == 1 else [f"{name} {part}" for part in parts]


def _checked(name: str, given: tuple[ArrayLike, ArrayLike]) -> tuple[Array, Array]:
    try:
        times, values = (np.asarray(part, dtype=float) for part in given)
    except (TypeError, ValueError) as error:
        raise InputError(f"replay: measured={{{name!r}: ...}} takes (times, values), two arrays of numbers.") from error
    if times.ndim != 1 or times.shape != values.shape or len(times) < 2 or not np.all(np.diff(times) > 0):
        raise InputError(
            f"replay: measured={{{name!r}: ...}} takes increasing times and as many values, (m,) each; got shapes "
            f"{times.shape} and {values.shape}."
        )
    return times, values
