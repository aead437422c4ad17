"""Motions on which the links of a robot do not overlap, by its exact shapes, as guesses of phases.

A known motion is followed where it is free. Where it is not, a path from a random search leads around the overlap.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.precision import ROUND_OFF, SAMPLES
from robotraj._util.values import dataclass
from robotraj.guess.ends import default_parameters
from robotraj.guess.joint_motion import joint_motion
from robotraj.guess.paths.free_path import TRIES, Free, free_path
from robotraj.problem.initial_guess import InitialGuess, PhaseGuess
from robotraj.problem.phase import Phase

Motion = Callable[[Array], Array]
"""From fractions of a phase (m,) to configurations (m, nq)."""

BESIDE = 4
"""Number of free configurations before and after an overlap from which a path leads around it."""
ROUNDED = 7
"""Number of samples on each side over which a path around an overlap is averaged."""


@dataclass(frozen=True, eq=False)
class AroundItself(InitialGuess):
    """Motions through configurations at equal steps of time.

    Parameters
    ----------
    routes : tuple of Route or None
        For each phase; None where ``line`` is the guess.
    line : InitialGuess
    """

    routes: tuple[Route | None, ...]
    line: InitialGuess

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Return the motion of a phase."""
        route = self.routes[index]
        if route is None:
            return self.line.of(phase, index)
        duration = float(np.clip(route.duration, *phase.duration_bounds))
        return joint_motion(phase, duration, lambda s: route.motion(s, duration), default_parameters(phase))


@dataclass(frozen=True, eq=False)
class Route:
    """Configurations (n, nq) at equal steps of time, and the duration [s]."""

    samples: Array
    duration: float

    def __call__(self, fractions: Array) -> Array:
        """Return the configurations (m, nq) at fractions of the duration (m,)."""
        return _between(self.samples, fractions)

    def motion(self, fractions: Array, duration: float) -> tuple[Array, Array, Array]:
        """Return positions, velocities and accelerations (m, nv) of a motion that takes a duration [s]."""
        step = duration / (len(self.samples) - 1)
        v = np.gradient(self.samples, step, axis=0)
        v[[0, -1]] = 0.0
        return self(fractions), _between(v, fractions), _between(np.gradient(v, step, axis=0), fractions)


def route_around(
    motion: Motion, duration: float, free: Free, bounds: tuple[Array, Array], seed: int, whole: bool = False
) -> Route | None:
    """Return a free motion that leaves a known one where that is not free; None if none was found.

    Parameters
    ----------
    motion : callable
        From fractions (m,) to configurations (m, nq).
    duration : float
        Of the known motion [s].
    free : callable
        Compares configurations.
    bounds : (ndarray (nq,), ndarray (nq,))
        Bounds of the positions; infinite ones of joints without limits.
    seed : int
    whole : bool
        Whether all of the motion is replaced, not only what is near an overlap.
    """
    known = motion(np.linspace(0.0, 1.0, SAMPLES))
    open_ = free(known)
    if not (open_[0] and open_[-1]):
        return None
    first, last = (0, SAMPLES - 1) if whole else _window(open_)
    path = free_path(free, known[first : last + 1], *bounds, TRIES if whole else TRIES // 4, seed)
    if path is None:
        return None
    step = duration / (SAMPLES - 1)
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    before = float(np.linalg.norm(np.diff(known[first : last + 1], axis=0), axis=1).sum())
    # The way around takes the time of the way through, or longer at its mean speed.
    spent = (last - first) * step * max(1.0, float(lengths.sum()) / max(before, ROUND_OFF))
    steps = (
        np.full(first, step),
        spent * lengths / max(float(lengths.sum()), ROUND_OFF),
        np.full(SAMPLES - 1 - last, step),
    )
    every, clock = np.concatenate([known[:first], path, known[last + 1 :]]), np.append(0.0, np.cumsum(np.hstack(steps)))
    even = np.linspace(0.0, clock[-1], SAMPLES)
    samples = np.column_stack([np.interp(even, clock, column) for column in every.T])
    return Route(_rounded(samples, free), float(clock[-1]))


def _window(open_: NDArray[np.bool_]) -> tuple[int, int]:
    """Return the samples before and after all that is not free, with up to ``BESIDE`` free ones on both sides."""
    shut = np.flatnonzero(~open_)
    if not shut.size:
        return 0, len(open_) - 1
    # Between two overlaps a motion may be in a pocket from which no path leads.
    return max(int(shut[0]) - BESIDE, 0), min(int(shut[-1]) + BESIDE, len(open_) - 1)


def _rounded(samples: Array, free: Free) -> Array:
    """Return averages over up to ``ROUNDED`` neighbours on each side, half as many until they are free."""
    width = ROUNDED
    while width:
        padded = np.concatenate(
            [np.repeat(samples[:1], width, axis=0), samples, np.repeat(samples[-1:], width, axis=0)]
        )
        sums = np.cumsum(np.concatenate([np.zeros((1, samples.shape[1])), padded]), axis=0)
        averages = (sums[2 * width + 1 :] - sums[: -2 * width - 1]) / (2 * width + 1)
        averages[[0, -1]] = samples[[0, -1]]
        if free(averages).all():
            return np.asarray(averages)
        width //= 2
    return samples


def _between(values: Array, fractions: Array) -> Array:
    even = np.linspace(0.0, 1.0, len(values))
    return np.column_stack([np.interp(fractions, even, column) for column in values.T])
