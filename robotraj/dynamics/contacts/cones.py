"""Friction cones as values: bounds on the tangential force for a given normal force."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Scalar


class FrictionCone(OneLine, ABC):
    """Rows that are not negative while |f_t| <= mu f_n (or a cone inside it). A new cone is one new class."""

    @property
    @abstractmethod
    def units(self) -> tuple[str, ...]:
        """Unit of each row."""

    @abstractmethod
    def rows(self, friction: float, normal: Scalar, first: Scalar, second: Scalar) -> list[Scalar]:
        """Evaluate the rows, len(units) of them.

        Parameters
        ----------
        friction : float
            Coefficient mu.
        normal, first, second : scalar
            Force along the normal and along two tangents at right angles [N].
        """


@dataclass(frozen=True)
class SecondOrder(FrictionCone):
    """The round cone itself: mu^2 f_n^2 - f_1^2 - f_2^2 >= 0 [N^2], which with f_n >= 0 is |f_t| <= mu f_n."""

    @property
    def units(self) -> tuple[str, ...]:
        """One row."""
        return ("N^2",)

    def rows(self, friction: float, normal: Scalar, first: Scalar, second: Scalar) -> list[Scalar]:
        """Evaluate the row."""
        return [friction * friction * normal * normal - first * first - second * second]


@dataclass(frozen=True)
class Linearised(FrictionCone):
    """A pyramid with its edges on the cone: mu cos(pi / n) f_n - f_1 cos(phi_k) - f_2 sin(phi_k) >= 0 [N].

    phi_k = (2 k + 1) pi / n, k = 0 ... n - 1. The pyramid lies inside the cone.
    Source: Stewart and Trinkle, International Journal for Numerical Methods in Engineering 39 (1996).

    Parameters
    ----------
    faces : int
        n, 3 or more. In the worst direction four faces allow 71 % of the friction, eight 92 %.

    Raises
    ------
    InputError
        Fewer than three faces.
    """

    faces: int = 4

    def __post_init__(self) -> None:
        if not isinstance(self.faces, int) or self.faces < 3:
            raise InputError(f"Linearised has {self.faces!r} faces; give a whole number, 3 or more.")

    @property
    def units(self) -> tuple[str, ...]:
        """One row a face."""
        return ("N",) * self.faces

    def rows(self, friction: float, normal: Scalar, first: Scalar, second: Scalar) -> list[Scalar]:
        """Evaluate the rows."""
        reach = friction * float(np.cos(np.pi / self.faces)) * normal
        angles = [(2 * k + 1) * np.pi / self.faces for k in range(self.faces)]
        return [reach - float(np.cos(angle)) * first - float(np.sin(angle)) * second for angle in angles]


def checked_cone(cone: object, what: str) -> None:
    """Check that the cone of ``what`` is one.

    Raises
    ------
    InputError
        It is no ``FrictionCone``.
    """
    if not isinstance(cone, FrictionCone):
        raise InputError(
            f"The cone of {what} is {cone!r}; give rt.contacts.SecondOrder() or rt.contacts.Linearised(faces)."
        )
