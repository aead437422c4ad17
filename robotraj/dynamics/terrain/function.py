"""Ground from any smooth height function, and conversion of user input to a Ground."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import casadi as ca

from robotraj._util.errors import InputError, called
from robotraj._util.values import dataclass
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.variable import Scalar

GroundFunction: TypeAlias = Callable[[ca.SX, ca.SX], Scalar]
"""Height of the ground [m] as a function of x and y [m], written with CasADi."""


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
        On first use: the function fails on symbols or does not return one height.
    """

    function: GroundFunction

    def surface(self, x: ca.SX, y: ca.SX) -> ca.SX:
        """Height [m]."""
        height = called("height function of the ground", lambda *place: ca.SX(self.function(*place)), x, y)
        if height.numel() != 1:
            raise InputError(f"The height function of the ground returned {height.numel()} values; return one.")
        return height


def as_ground(value: object) -> Ground:
    """Return a Ground, from a Ground or a function of (x, y).

    Raises
    ------
    InputError
        The value is neither.
    """
    if isinstance(value, Ground):
        return value
    if callable(value):
        return HeightFunction(value)
    raise InputError(
        f"ground must be rt.terrain.Flat, rt.terrain.Slope, rt.terrain.Steps, rt.terrain.HeightMap, rt.terrain.Plane "
        f"or a function of (x, y) [m]; got {value!r}."
    )
