"""Any smooth ground, and what else may stand for one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca

from robotraj.errors import InputError
from robotraj.terrain.base import Ground
from robotraj.values import dataclass


@dataclass(frozen=True)
class HeightFunction(Ground):
    """Any smooth height function h(x, y) [m], such as ``lambda x, y: 0.1 * ca.sin(3 * x)``.

    Parameters
    ----------
    function : callable
        Takes CasADi symbols, scalars [m].

    Raises
    ------
    InputError
        When first used: the function fails on symbols or returns no single height.
    """

    function: Callable[[Any, Any], Any]

    def surface(self, x: ca.SX, y: ca.SX) -> Any:
        """Height [m]."""
        advice = "Write it with CasADi's functions, without `if` on x or y."
        try:
            height = ca.SX(self.function(x, y))
        except Exception as error:  # whatever the user's function raises on symbols
            raise InputError(f"The ground's height function failed on CasADi symbols: {error} {advice}") from error
        if height.numel() != 1:
            raise InputError(f"The ground's height function gave {height.numel()} values for one place. {advice}")
        return height


def as_ground(value: Any) -> Ground:
    """Accept a Ground or a plain function of (x, y).

    Raises
    ------
    InputError
        It is neither.
    """
    if isinstance(value, Ground):
        return value
    if callable(value):
        return HeightFunction(value)
    raise InputError(
        f"ground must be rt.Flat, rt.Slope, rt.Steps, rt.HeightMap or a function of (x, y) [m]; got {value!r}."
    )
