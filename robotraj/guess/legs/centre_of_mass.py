"""The path of the centre of mass: a linear inverted pendulum on standing feet, and free fall in flight.

On the ground, x'' = w^2 (x - p) with the mean p of the feet and w^2 = g / h, so that

    x(t) = p + ((x_0 - p) sinh(w (T - t)) + (x_1 - p) sinh(w t)) / sinh(w T)

over a phase of duration T from x_0 to x_1; in flight x'' = 0 and z'' = -g. Equal speeds on both sides of every knot are
linear equations for the positions there. From its first state, the motion would grow with exp(w t), so that round-off
would decide the last steps of a long walk.
Source: Kajita, Kanehiro, Kaneko, Yokoi and Hirukawa, The 3D linear inverted pendulum mode, IROS 2001.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.splines import Spline, hermite
from robotraj._util.precision import SAME
from robotraj._util.values import dataclass


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

    def _span(self, phase: int) -> float:
        """Return w T of a phase, 0 in flight."""
        duration = float(self.times[phase + 1]) - float(self.times[phase])
        return 0.0 if np.isnan(self.feet[phase]) else self.rate * duration

    def _speeds(self, phase: int) -> tuple[Array, Array]:
        """Return A and b of the speeds A (x_0, x_1) + b at both ends of a phase [m/s]."""
        span = self._span(phase)
        if span == 0.0:
            per = 1.0 / (float(self.times[phase + 1]) - float(self.times[phase]))
            return np.array([[-per, per], [-per, per]]), np.zeros(2)
        near, far = self.rate / np.tanh(span), self.rate / np.sinh(span)
        p = float(self.feet[phase])
        return np.array([[-near, far], [-far, near]]), np.array([p * (near - far), p * (far - near)])

    def _knots(self, ends: Sequence[tuple[Sequence[float], Sequence[float], float]]) -> Array:
        """Return the positions at the knots [m]: the speed is continuous, and two equations hold at the ends.

        Each of ``ends`` has the factors of the first and of the last (x, v), and the sum.
        """
        count = len(self.feet)
        matrix, vector = np.zeros((count + 1, count + 1)), np.zeros(count + 1)
        speeds = [self._speeds(i) for i in range(count)]
        for i in range(count - 1):
            (before, rest), (after, other) = speeds[i], speeds[i + 1]
            matrix[i, i : i + 2] += before[1]
            matrix[i, i + 1 : i + 3] -= after[0]
            vector[i] = other[0] - rest[1]
        for row, (first, last, total) in enumerate(ends, start=count - 1):
            matrix[row, 0] += first[0]
            matrix[row, -1] += last[0]
            matrix[row, :2] += first[1] * speeds[0][0][0]
            matrix[row, -2:] += last[1] * speeds[-1][0][1]
            vector[row] = total - first[1] * speeds[0][1][0] - last[1] * speeds[-1][1][1]
        return np.asarray(np.linalg.lstsq(matrix, vector, rcond=SAME)[0])

    def repeating(self, sign: float, gain: float) -> Array:
        """Return the positions (n + 1,) at the knots of n phases [m]: last (x, v) = sign first (x, v) + (gain, 0)."""
        return self._knots([((-sign, 0.0), (1.0, 0.0), gain), ((0.0, -sign), (0.0, 1.0), 0.0)])

    def joining(self, first: float, last: float) -> Array:
        """Return the positions (n + 1,) at the knots of n phases [m] of the motion from one position to another."""
        return self._knots([((1.0, 0.0), (0.0, 0.0), first), ((0.0, 0.0), (1.0, 0.0), last)])

    def at(self, knots: Array, t: float) -> float:
        """Return the position at a time [s] of a motion with these positions at the knots [m]."""
        i = int(np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.feet) - 1))
        begin, end = float(self.times[i]), float(self.times[i + 1])
        span, share, p = self._span(i), (t - begin) / (end - begin), float(self.feet[i])
        if span == 0.0:
            return float(knots[i] + share * (knots[i + 1] - knots[i]))
        before, after = (np.sinh(span * part) / np.sinh(span) for part in (1.0 - share, share))
        return float(p + (knots[i] - p) * before + (knots[i + 1] - p) * after)


def heights(
    times: Sequence[float], levels: Sequence[float], flying: Sequence[bool], gravity: float, repeats: bool
) -> Spline:
    """Return the height of the centre of mass [m]: parabolas in flight, cubics on the ground, ``levels`` between them.

    The slopes of the cubics are the velocities of takeoff and landing. The first and the last slope of a repeating
    motion are equal. Phases on the ground that follow one another before or after a flight are one cubic: a robot that
    pushes off with fewer and fewer feet accelerates all the time.
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
    kept = _knots_of(flying)
    return hermite(t[kept], z[kept], slopes[kept])


def _knots_of(flying: Sequence[bool]) -> list[int]:
    """Return the knots of ``heights``: both sides of flights and the ends; all of them without a flight."""
    ends = (0, len(flying))
    return [i for i in range(len(flying) + 1) if i in ends or not any(flying) or flying[i - 1] or flying[i]]
