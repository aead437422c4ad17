"""The path of the centre of mass: a linear inverted pendulum on standing feet, and free fall in flight.

On the ground, x'' = w^2 (x - p) with the mean p of the feet and w^2 = g / h, so that

    x(t) = p + (x_0 - p) cosh(w t) + (v_0 / w) sinh(w t);

in flight x'' = 0 and z'' = -g. The condition on the last state is a linear equation for the first.
Source: Kajita, Kanehiro, Kaneko, Yokoi and Hirukawa, The 3D linear inverted pendulum mode, IROS 2001.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotraj._util.splines import Spline, hermite
from robotraj._util.values import dataclass

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pendulum:
    """Motion of the centre of mass along one horizontal axis.

    Attributes
    ----------
    times : sequence of float
        Ends of the phases [s].
    feet : sequence of float
        Mean position of the standing feet in every phase [m]; NaN in flight.
    rate : float
        w [1/s].
    """

    times: Sequence[float]
    feet: Sequence[float]
    rate: float

    def _advance(self, phase: int, duration: float) -> tuple[Array, Array]:
        """Return A and b of (x, v) -> A (x, v) + b, over a part of a phase."""
        w, p = self.rate, self.feet[phase]
        if np.isnan(p):
            return np.array([[1.0, duration], [0.0, 1.0]]), np.zeros(2)
        c, s = np.cosh(w * duration), np.sinh(w * duration)
        return np.array([[c, s / w], [w * s, c]]), np.array([p * (1.0 - c), -p * w * s])

    def _whole(self) -> tuple[Array, Array]:
        matrix, vector = np.eye(2), np.zeros(2)
        for i, duration in enumerate(np.diff(self.times)):
            a, b = self._advance(i, float(duration))
            matrix, vector = a @ matrix, a @ vector + b
        return matrix, vector

    def repeating(self, sign: float, gain: float) -> Array:
        """Return the first state (x, v) of the motion whose last is sign (x, v) + (gain, 0)."""
        matrix, vector = self._whole()
        return np.asarray(np.linalg.lstsq(matrix - sign * np.eye(2), np.array([gain, 0.0]) - vector, rcond=1e-9)[0])

    def joining(self, first: float, last: float) -> Array:
        """Return the first state (x, v) of the motion from one position to another."""
        matrix, vector = self._whole()
        return np.array([first, (last - vector[0] - matrix[0, 0] * first) / matrix[0, 1]])

    def at(self, start: Array, t: float) -> Array:
        """Return the state (x, v) at a time [s]."""
        state = np.asarray(start, dtype=float)
        for i, (begin, end) in enumerate(zip(self.times[:-1], self.times[1:], strict=True)):
            last = i == len(self.times) - 2
            a, b = self._advance(i, min(t, end) - begin if not last else t - begin)
            state = a @ state + b
            if t <= end or last:
                break
        return state


def heights(
    times: Sequence[float], levels: Sequence[float], flying: Sequence[bool], gravity: float, repeats: bool
) -> Spline:
    """Return the height of the centre of mass [m]: parabolas in flight, cubics on the ground, ``levels`` between them.

    The slopes of the cubics are the velocities of takeoff and landing. The first and the last slope of a repeating
    motion are equal.
    """
    t, z = np.asarray(times, dtype=float), np.asarray(levels, dtype=float)
    leave, arrive = np.zeros(len(t)), np.zeros(len(t))
    spans, climbs = np.diff(t), np.diff(z)
    for i, flies in enumerate(flying):
        if flies:
            leave[i] = climbs[i] / spans[i] + 0.5 * gravity * spans[i]
            arrive[i + 1] = climbs[i] / spans[i] - 0.5 * gravity * spans[i]
    slopes = leave + arrive
    if repeats:
        slopes[0] = slopes[-1] = slopes[0] + slopes[-1]
    return hermite(t, z, slopes)
