"""Objectives: sums of weighted Lagrange terms (integrals) and Mayer terms (of the end points)."""

from __future__ import annotations

from abc import ABCMeta, abstractmethod
from collections.abc import Sequence
from typing import NoReturn

import numpy as np

from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine, short
from robotraj._util.values import dataclass, own_fields
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import AnyPoint
from robotraj.problem.constraints.base import BoundConstraint
from robotraj.problem.scalars import Scalar


class _Called(ABCMeta):
    """The type of classes of objectives: arithmetic with a class instead of a term is refused."""

    def _refuse(cls, other: object = None) -> NoReturn:
        raise InputError(
            f"{cls.__name__} is a class, not an objective: write {cls.__name__}(...), as in 0.1 * rt.Duration()."
        )

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __neg__ = _refuse


class Objective(OneLine, metaclass=_Called):
    """A function that a phase minimises. Objectives add up and scale: ``rt.Effort() + 0.1 * rt.Duration()``."""

    @property
    @abstractmethod
    def terms(self) -> tuple[tuple[float, Integral | EndCost], ...]:
        """Weights and the elementary terms they multiply."""

    def __add__(self, other: object) -> Objective:
        # sum([...]) starts from the integer 0.
        if isinstance(other, int | float) and other == 0:
            return self
        if isinstance(other, int | float | np.number):
            raise InputError(
                f"{other:g} is no objective that can be added to {self}. A number multiplies a term as its weight, "
                f"{other:g} * rt.Duration(); a constant changes no optimum, so leave it out."
            )
        if not isinstance(other, Objective):
            return NotImplemented
        return Sum((*self.terms, *other.terms))

    __radd__ = __add__

    def __sub__(self, other: object) -> Objective:
        if isinstance(other, Objective):
            return self + (-other)
        return self + (-other) if isinstance(other, int | float | np.number) else NotImplemented

    def __rsub__(self, other: object) -> Objective:
        return -self + other

    def __neg__(self) -> Objective:
        return self * -1.0

    def __truediv__(self, divisor: float) -> Objective:
        if not is_finite(divisor) or divisor == 0:
            raise InputError(f"An objective is divided by {short(divisor)}; give a number that is not 0.")
        return self * (1.0 / divisor)

    def __mul__(self, weight: float) -> Objective:
        if not is_finite(weight):
            raise InputError(f"An objective is multiplied by {short(weight)}; give a finite number.")
        return Sum(tuple((float(weight) * w, term) for w, term in self.terms))

    __rmul__ = __mul__


@dataclass(frozen=True)
class Sum(Objective):
    """A weighted sum of elementary terms."""

    parts: tuple[tuple[float, Integral | EndCost], ...] = ()

    @property
    def terms(self) -> tuple[tuple[float, Integral | EndCost], ...]:
        """Weights and terms."""
        return self.parts

    def __str__(self) -> str:
        return " + ".join(f"{weight:g} {term}" if weight != 1 else str(term) for weight, term in self.parts)


class Term(Objective):
    """Base class of both kinds of elementary terms."""

    def __post_init__(self) -> None:
        """Keep copies of the arrays, lists and mappings that were given."""
        own_fields(self)

    @abstractmethod
    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Raise an InputError if the term does not fit the dynamics, such as for an unknown name."""

    def augment(self, dynamics: Dynamics) -> Dynamics:
        """Add the variables of the term to the dynamics of the phase; most terms have none."""
        return dynamics

    def definitions(self, dynamics: Dynamics) -> tuple[BoundConstraint, ...]:
        """Rows at collocation points that define the variables of the term; most terms have none."""
        return ()


class Integral(Term):
    """An elementary Lagrange term: the integral of a rate over the phase."""

    @property
    def terms(self) -> tuple[tuple[float, Integral | EndCost], ...]:
        """Itself, once."""
        return ((1.0, self),)

    @abstractmethod
    def rate(self, point: AnyPoint) -> Scalar:
        """Integrand at a point, a scalar."""

    def rate_of_motion(self, point: AnyPoint) -> Scalar:
        """Integrand of the motion alone: variables that the term has added have their least values."""
        return self.rate(point)

    def softened(self, dynamics: Dynamics, error: float) -> Integral:
        """Return the term with rounded kinks, whose rate is below that of the motion by at most ``error``.

        A term without kinks is returned as it is.
        """
        return self


class EndCost(Term):
    """An elementary Mayer term: a function of the phase's two end points."""

    @property
    def terms(self) -> tuple[tuple[float, Integral | EndCost], ...]:
        """Itself, once."""
        return ((1.0, self),)

    @abstractmethod
    def value(self, start: AnyPoint, end: AnyPoint) -> Scalar:
        """Cost of the two end points, a scalar."""
