"""The guess of a phase that follows a path: smooth timing from end to end, slow enough for the limits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.dynamics.path_body import ACCELERATION, PARAMETER, SPEED
from robotraj.guess.ends import default_parameters
from robotraj.problem.initial_guess import Curve, InitialGuess, PhaseGuess
from robotraj.problem.phase_row import Kind

if TYPE_CHECKING:
    from robotraj.dynamics.variable import Variable
    from robotraj.problem.phase import Phase

Array = NDArray[np.float64]

PLACES = np.linspace(0.0, 1.0, 65)
"""Fractions of the motion at which rows are compared with their bounds."""
SHORTEST, LONGER, TRIES = 0.05, 1.5, 24
"""First duration [s], factor by which it grows while rows are violated, and largest number of times."""


@dataclass(frozen=True)
class AlongPath(InitialGuess):
    """The path of ``rt.constraints.FollowPath`` with s = s_0 + (s_1 - s_0) (3 f^2 - 2 f^3) at the fraction f.

    The guessed duration satisfies the path rows, such as limits of speed and torque, where possible.
    """

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Sample the path."""
        path, dae, table = phase.path, phase.dae, phase.rows
        assert path is not None
        breaks, parameters = path.curve.breaks, default_parameters(phase)
        first, span = float(breaks[0]), float(breaks[-1] - breaks[0])

        def columns(variables: tuple[Variable, ...], duration: float) -> Curve:
            def values(f: Array) -> Array:
                f = np.asarray(f, dtype=float)
                known = {
                    PARAMETER: first + span * f**2 * (3.0 - 2.0 * f),
                    SPEED: span * 6.0 * f * (1.0 - f) / duration,
                    ACCELERATION: span * (6.0 - 12.0 * f) / duration**2,
                    f"rate.{ACCELERATION}": np.full_like(f, -12.0 * span / duration**3),
                }
                zero = np.zeros_like(f)
                return np.column_stack([known.get(v.name, zero) for v in variables] or [np.zeros((len(f), 0))])

            return values

        rows = tuple(row for row in table.throughout if row.kind is Kind.PATH)
        known = np.array(list(parameters.values()), dtype=float)

        def holds(duration: float) -> bool:
            x, z, u = (columns(kind, duration)(PLACES) for kind in (dae.states, dae.algebraic, dae.controls))
            values = table.sample(rows, duration * PLACES, x, z, u, known)
            return all(
                bool(np.all((row.lower <= column) & (column <= row.upper)))
                for row, column in zip(rows, values.T, strict=True)
            )

        low, high = phase.duration_bounds
        duration = max(low, SHORTEST)
        for _ in range(TRIES if rows else 0):
            if holds(duration):
                break
            duration *= LONGER
        duration = float(np.clip(duration, low, high))
        states, algebraic, controls = (columns(kind, duration) for kind in (dae.states, dae.algebraic, dae.controls))
        return PhaseGuess(duration, states, algebraic, controls, parameters)


def check_no_path(phase: Phase, guess: str) -> None:
    """Raise InputError where a guess gives positions of joints that the phase takes from its path."""
    if phase.path is not None:
        raise InputError(
            f"{guess} gives positions of joints, but phase {phase.name!r} takes them from the path of FollowPath; "
            "leave the guess out, or give rt.guess.StraightLine(duration)."
        )
