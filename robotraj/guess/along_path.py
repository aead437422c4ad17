"""The guess of a phase that follows a path: smooth timing from end to end, slow enough for the limits."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.precision import SAMPLES
from robotraj._util.values import dataclass
from robotraj.dynamics.path_body import ACCELERATION, PARAMETER, SPEED
from robotraj.dynamics.variable import Variable
from robotraj.guess.ends import default_parameters
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import Kind, PhaseRow

SHORTEST, LONGER, TRIES = 1e-3, 1.5, 36
"""Least duration of a phase [s], the factor by which it grows while rows are violated, and how often at most.

The last duration is half an hour.
"""


@dataclass(frozen=True)
class AlongPath(InitialGuess):
    """A cubic s(f) of the fraction f along the path of ``rt.constraints.FollowPath``.

    It has the path's ends and the given speeds there, and speed 0 where a speed is free. A start at speed whose end is
    free keeps its speed. A motion that may end anywhere slows down evenly, s'' = -s'_0 / T. The guessed duration T
    satisfies the path rows, such as limits of speed and torque, where possible.
    """

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Sample the path."""
        cubic = _Cubic.of(phase)
        duration = float(np.clip(_duration(phase, cubic), *phase.duration_bounds))
        dae = phase.dae
        states, algebraic, controls = (
            partial(cubic.columns, kind, duration) for kind in (dae.states, dae.algebraic, dae.controls)
        )
        return PhaseGuess(duration, states, algebraic, controls, default_parameters(phase))


def _duration(phase: Phase, cubic: _Cubic) -> float:
    """Return the first duration [s] with which the cubic meets the path rows; a stop may only be nearest to that."""
    dae, table = phase.dae, phase.rows
    rows = tuple(row for row in table.throughout if row.kind is Kind.PATH)
    tried = [float(each) for each in np.maximum(cubic.durations, phase.duration_bounds[0])]
    if not rows:
        return tried[0]
    p = np.array(list(default_parameters(phase).values()), dtype=float)
    least, nearest, places = np.inf, cubic.longest, np.linspace(0.0, 1.0, SAMPLES)
    for duration in tried:
        if cubic.ends_beyond(duration):
            break
        x, z, u = (cubic.columns(kind, duration, places) for kind in (dae.states, dae.algebraic, dae.controls))
        values = table.sample(rows, duration * places, x, z, u, p)
        excess = max(_excess(row, column) for row, column in zip(rows, values.T, strict=True))
        if excess <= 0.0:
            return duration
        if cubic.stops and excess < least:
            least, nearest = excess, duration
    return nearest


def _excess(row: PhaseRow, values: Array) -> float:
    """Return the largest excess over a bound, relative to the bound where that is not 0."""
    sides = [(row.lower, row.lower - values), (row.upper, values - row.upper)]
    return max(float(np.max(beyond)) / (abs(bound) or 1.0) for bound, beyond in sides if np.isfinite(bound))


@dataclass(frozen=True)
class _Cubic:
    """s = s_0 + c_1 f + c_2 f^2 + c_3 f^3; entry and leaving are s' at the ends, and stops is for an end anywhere."""

    first: float
    span: float
    entry: float
    leaving: float
    stops: bool

    @classmethod
    def of(cls, phase: Phase) -> _Cubic:
        path = phase.path
        assert path is not None
        first, last = (float(path.curve.breaks[end]) for end in (0, -1))
        (_, slow), (_, fast) = path.ends(last=True)
        entry = path.start_speed or 0.0
        leaving = float(slow) if slow == fast else entry
        return cls(first, last - first, entry, leaving, not path.whole and entry > 0.0)

    @property
    def durations(self) -> Array:
        """The durations that are tried, ascending [s]."""
        keeps = self.entry and self.leaving and not self.stops
        growing: Array = LONGER ** np.arange(TRIES + 1.0)
        return growing * (self.span / self.entry if keeps else SHORTEST)

    @property
    def longest(self) -> float:
        """The duration where none meets the rows [s]; at twice span / entry an even deceleration ends at rest."""
        return 2.0 * self.span / self.entry if self.entry else float(self.durations[-1])

    def ends_beyond(self, duration: float) -> bool:
        """Whether a stop ends beyond the path."""
        return self.stops and sum(self._coefficients(duration)) > self.span

    def _coefficients(self, duration: float) -> tuple[float, float, float]:
        start, end, span = self.entry * duration, self.leaving * duration, self.span
        if self.stops:
            return start, -0.5 * start, 0.0
        return start, 3.0 * span - 2.0 * start - end, start + end - 2.0 * span

    def columns(self, variables: Sequence[Variable], duration: float, f: Array) -> Array:
        """Return the values of variables at fractions f, (m, n)."""
        curve = np.polynomial.Polynomial((self.first, *self._coefficients(duration)))
        f = np.asarray(f, dtype=float)
        names = (PARAMETER, SPEED, ACCELERATION, f"rate.{ACCELERATION}")
        known = {name: (curve.deriv(k) if k else curve)(f) / duration**k for k, name in enumerate(names)}
        zero = np.zeros_like(f)
        return np.column_stack([known.get(v.name, zero) for v in variables] or [np.zeros((len(f), 0))])


def check_no_path(phase: Phase, guess: str) -> None:
    """Raise InputError where a guess gives positions of joints that the phase takes from its path."""
    if phase.path is not None:
        raise InputError(
            f"{guess} gives positions of joints, but phase {phase.name!r} takes them from the path of FollowPath; "
            "leave the guess out, or give rt.guess.StraightLine(duration)."
        )
