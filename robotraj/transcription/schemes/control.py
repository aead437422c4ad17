"""Shapes of the control inside an interval: the scheme's own polynomial, a line between knots, or a constant."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass


class Control(OneLine, ABC):
    """A control is a polynomial through its sites in [0, 1]; sites at 0 and 1 are shared with the neighbours."""

    @abstractmethod
    def sites(self, nodes: Array) -> Array:
        """Return the sites of the control's values for a scheme with these nodes."""


@dataclass(frozen=True)
class PolynomialControl(Control):
    """The scheme's own polynomial: one free value per collocation point (a free mid-point in Hermite-Simpson)."""

    def sites(self, nodes: Array) -> Array:
        """Return one site per collocation point."""
        return nodes


@dataclass(frozen=True)
class LinearControl(Control):
    """Piecewise linear: values at knots, u = (1 - tau) u_k + tau u_{k+1} (the mean at a mid-point)."""

    def sites(self, nodes: Array) -> Array:
        """Return both ends of the interval."""
        return np.array([0.0, 1.0])


@dataclass(frozen=True)
class ConstantControl(Control):
    """Piecewise constant: one value per interval, free to jump at knots."""

    def sites(self, nodes: Array) -> Array:
        """Return the middle of the interval."""
        return np.array([0.5])
