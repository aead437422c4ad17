"""Models of a rectangular sole, as values: bounds on the friction, centre of pressure and torsion of one wrench."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import field
from itertools import product

import numpy as np

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import positive
from robotraj.dynamics.contacts.cones import FrictionCone, SecondOrder, checked_cone
from robotraj.dynamics.variable import Scalar


@dataclass(frozen=True)
class Rectangle:
    """A sole, measured from the point at which the wrench acts.

    Attributes
    ----------
    back, front : float
        Extent backwards and forwards [m].
    half : float
        Half its width [m].
    """

    back: float
    front: float
    half: float

    def scaled(self, factor: float) -> Rectangle:
        """Return the rectangle with all sides multiplied, about its middle."""
        middle, length = 0.5 * (self.front - self.back), 0.5 * (self.front + self.back)
        return Rectangle(factor * length - middle, factor * length + middle, factor * self.half)

    def share(self, normal: float, moment: Sequence[float]) -> float:
        """Return the way of the centre of pressure from the middle towards an edge, 1 at the edge.

        Parameters
        ----------
        normal : float
            Normal force [N].
        moment : sequence of 3 float
            About the axes forward, left and up, at the point at which the wrench acts [N m].
        """
        if normal <= 0.0:
            return np.inf if np.any(moment[:2]) else 0.0
        middle, length = 0.5 * (self.front - self.back), 0.5 * (self.front + self.back)
        ahead, left = -moment[1] / normal - middle, moment[0] / normal
        return max(abs(ahead) / length, abs(left) / self.half if self.half else 0.0)


class Sole(OneLine, ABC):
    """Rows that are not negative for wrenches that the sole can transmit. A new model is one new class."""

    @abstractmethod
    def labels(self) -> tuple[tuple[str, str], ...]:
        """Name and unit of each row."""

    @abstractmethod
    def rows(
        self, friction: float, shape: Rectangle, force: Sequence[Scalar], moment: Sequence[Scalar]
    ) -> list[Scalar]:
        """Evaluate the rows, len(labels) of them.

        Parameters
        ----------
        friction : float
        shape : Rectangle
        force, moment : sequence of 3
            In the foot's axes: forward, left, up [N, N m].
        """


@dataclass(frozen=True)
class PressureAndTorsion(Sole):
    """Friction of the whole force, centre of pressure inside the rectangle, torsion |m_n| <= mu r f_n.

    The centre of pressure is (-m_left, m_forward) / f_n. The three are bounded separately; ``FourCorners`` bounds
    them jointly.

    Parameters
    ----------
    cone : FrictionCone
        ``SecondOrder()`` or ``Linearised(faces)``.
    radius : float, optional
        r [m]. Default: two thirds of the radius of the largest circle about the middle of the sole that fits in it.
        A uniform pressure on that circle transmits this torsion.
    """

    cone: FrictionCone = field(default_factory=SecondOrder)
    radius: float | None = None

    def __post_init__(self) -> None:
        checked_cone(self.cone, "a sole")
        if self.radius is not None:
            positive(self.radius, "radius of a sole's torsion", "m")

    def labels(self) -> tuple[tuple[str, str], ...]:
        """Friction, then centre of pressure (front, back, left, right), then torsion."""
        pressure = [("centre of pressure", "N m")] * 4
        return (*(("friction cone", unit) for unit in self.cone.units), *pressure, *[("torsional friction", "N m")] * 2)

    def rows(
        self, friction: float, shape: Rectangle, force: Sequence[Scalar], moment: Sequence[Scalar]
    ) -> list[Scalar]:
        """Evaluate the rows."""
        radius = 2.0 / 3.0 * min((shape.front + shape.back) / 2.0, shape.half) if self.radius is None else self.radius
        reach = friction * float(radius) * force[2]
        return [
            *self.cone.rows(friction, force[2], force[0], force[1]),
            *pressure_rows(shape, force[2], moment),
            reach - moment[2],
            reach + moment[2],
        ]


@dataclass(frozen=True)
class FourCorners(Sole):
    """A sole that touches at its four corners, each with a force in a pyramid inside the friction cone.

    Linear rows of the wrench are equivalent to the existence of four such forces, which therefore are no unknowns.
    With X, Y half the length and width, m about the middle and mu' = mu / sqrt(2),

        |f_x| <= mu' f_n,  |f_y| <= mu' f_n,  |m_x| <= Y f_n,  |m_y| <= X f_n,
        |m_n| <= mu' (X + Y) f_n - |Y f_x -+ mu' m_x| - |X f_y -+ mu' m_y|   (upper signs for m_n < 0).

    Source: Caron, Pham and Nakamura, Stability of surface contacts for humanoid robots: closed-form formulae of the
    contact wrench cone for rectangular support areas, ICRA 2015.
    """

    def labels(self) -> tuple[tuple[str, str], ...]:
        """Friction (4), centre of pressure (4), then the eight rows of the torsion."""
        return (
            *[("friction cone", "N")] * 4,
            *[("centre of pressure", "N m")] * 4,
            *[("torsional friction", "N m")] * 8,
        )

    def rows(
        self, friction: float, shape: Rectangle, force: Sequence[Scalar], moment: Sequence[Scalar]
    ) -> list[Scalar]:
        """Evaluate the rows."""
        mu, half_length = friction / float(np.sqrt(2.0)), (shape.front + shape.back) / 2.0
        reach = mu * force[2]
        middle = (shape.front - shape.back) / 2.0  # m about the middle c forward of the point: m - c e_x x f
        about = [moment[0], moment[1] + middle * force[2], moment[2] - middle * force[1]]
        torsion = [
            mu * (half_length + shape.half) * force[2]
            + sign * about[2]
            - (
                side * (shape.half * force[0] - sign * mu * about[0])
                + end * (half_length * force[1] - sign * mu * about[1])
            )
            for sign, side, end in product((1.0, -1.0), (1.0, -1.0), (1.0, -1.0))
        ]
        friction_rows = [reach - force[0], reach + force[0], reach - force[1], reach + force[1]]
        return [*friction_rows, *pressure_rows(shape, force[2], moment), *torsion]


def pressure_rows(shape: Rectangle, normal: Scalar, moment: Sequence[Scalar]) -> list[Scalar]:
    """Distances of the centre of pressure from the front, back, left and right edge times the normal force [N m]."""
    return [
        shape.front * normal + moment[1],
        shape.back * normal - moment[1],
        shape.half * normal - moment[0],
        shape.half * normal + moment[0],
    ]
