"""How the control runs inside an interval: the scheme's own polynomial, a line between knots, or a constant."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass

Array = NDArray[np.float64]


class Control(OneLine, ABC):
    """A control is a polynomial through its sites in [0, 1]; sites at 0 and 1 are shared with the neighbours."""

    @abstractmethod
    def sites(self, nodes: Array) -> Array:
        """Sites of the control's values in an interval whose scheme collocates at ``nodes``."""


@dataclass(frozen=True)
class PolynomialControl(Control):
    """The scheme's own polynomial: one free value per collocation point (a free mid-point in Hermite-Simpson)."""

    def sites(self, nodes: Array) -> Array:
        """One site per collocation point."""
        return nodes


@dataclass(frozen=True)
class LinearControl(Control):
    """Piecewise linear: values at knots, u = (1 - tau) u_k + tau u_{k+1} (the mean at a mid-point)."""

    def sites(self, nodes: Array) -> Array:
        """Both ends of the interval."""
        return np.array([0.0, 1.0])


@dataclass(frozen=True)
class ConstantControl(Control):
    """Piecewise constant: one value per interval, free to jump at knots."""

    def sites(self, nodes: Array) -> Array:
        """Give the middle of the interval."""
        return np.array([0.5])
