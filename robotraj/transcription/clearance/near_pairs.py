"""The pairs of shapes that come near each other on the intervals of a known motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj.problem.clearance.pairs import ClearancePairs
from robotraj.transcription.clearance.proof import Shortfalls
from robotraj.transcription.clearance.supporting_planes import Motion
from robotraj.transcription.layout import PhaseLayout

SAMPLES = 5
"""Number of places of an interval at which a known motion is evaluated."""
FURTHER = 0.02
"""Largest distance by which a sphere with rows may be further than the nearest sphere of its link [m]."""
NEAR, NEAR_SOLUTION = 0.05, 0.01
"""Distances beyond the margin below which a pair has rows, along a guess and along a solution on another mesh [m].

A finer mesh hardly moves the solution. Rows that cannot become active took most of the time on fine meshes.
"""


class Nearest(NamedTuple):
    """Where each pair is nearest on each interval along a motion: fractions of the phase and distances [m], (K, n)."""

    fractions: Array
    distances: Array


def nearest_along(pairs: ClearancePairs, layout: PhaseLayout, motion: Motion) -> Nearest:
    """Return the least distance of each pair on each interval along a motion."""
    knots = layout.fractions
    at = knots[:-1, None] + np.diff(knots)[:, None] * np.linspace(0.0, 1.0, SAMPLES)
    distances = pairs.distances(*motion(at.ravel())).reshape(*at.shape, -1)
    where = distances.argmin(axis=1)
    least = np.take_along_axis(distances, where[:, None], axis=1)[:, 0]
    return Nearest(np.take_along_axis(at, where, axis=1), least)


def near_pairs(pairs: ClearancePairs, nearest: Nearest, near: float) -> Indices:
    """Return (interval, pair) of pairs that come within ``near`` [m] of their margin along a motion, (k, 2).

    Of the spheres of a link near one obstacle or link, only those within ``FURTHER`` of the nearest are returned.
    """
    found, numbers = nearest.distances, pairs.of_links
    least = np.full((int(numbers.max(initial=-1)) + 1, len(found)), np.inf)
    np.minimum.at(least, numbers, found.T)
    return np.argwhere((found < pairs.margin + near) & (found < least[numbers].T + FURTHER))


def nearest_of_links(pairs: ClearancePairs, found: Shortfalls) -> list[bool]:
    """Whether each shortfall is within ``FURTHER`` of the largest one of its links on its interval."""
    where = np.column_stack([found.intervals, pairs.of_links[found.pairs]])
    _, numbers = np.unique(where, axis=0, return_inverse=True)
    numbers = numbers.ravel()
    least = np.full(int(numbers.max(initial=-1)) + 1, np.inf)
    np.minimum.at(least, numbers, found.distances)
    chosen: list[bool] = (found.distances <= least[numbers] + FURTHER).tolist()
    return chosen
