"""A mesh: the intervals of a phase, and the scheme of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from textwrap import shorten

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.checks import is_number, is_whole, whole
from robotraj._util.curves.polynomials import lobatto_sites
from robotraj._util.errors import InputError
from robotraj._util.printing import WIDTH, OneLine, as_call
from robotraj._util.values import dataclass
from robotraj.transcription.schemes.collocation import Scheme
from robotraj.transcription.schemes.lobatto import HermiteSimpson

MOST = 100_000
"""Largest number of intervals; larger problems fill the memory of any machine."""


@dataclass(frozen=True)
class Mesh(OneLine):
    """Intervals of a phase and their scheme.

    Parameters
    ----------
    intervals : int or sequence of float
        Number of equal intervals, or knots as fractions of the phase, from 0 to 1.
    scheme : Scheme or sequence of Scheme
        One scheme for all intervals, or one for each.

    Raises
    ------
    InputError
        There is no interval, there are more than ``MOST``, the knots do not ascend from 0 to 1, or the numbers of
        schemes and intervals differ.
    """

    intervals: int | Sequence[float] = 40
    scheme: Scheme | Sequence[Scheme] = field(default_factory=HermiteSimpson)

    def __post_init__(self) -> None:
        if is_whole(self.intervals):
            whole("Mesh(intervals)", self.intervals, 1, MOST)
        elif np.isscalar(self.intervals):
            raise InputError(f"Mesh(intervals) must be a whole number or a list of knots, got {self.intervals!r}.")
        if not isinstance(self.intervals, int | np.integer):
            # A tuple can be compared and hashed; an array cannot.
            try:
                given = np.array(self.intervals, dtype=float).ravel()
            except (TypeError, ValueError):
                raise InputError(
                    f"Mesh(intervals) must be a whole number or a list of knots, got {self.intervals!r}."
                ) from None
            # Times divided by a duration end at 1 up to round-off.
            given[np.abs(given - 1.0) < 1e-14] = 1.0
            object.__setattr__(self, "intervals", tuple(given.tolist()))
        knots = self.knots
        if len(knots) < 2 or knots[0] != 0.0 or knots[-1] != 1.0 or not np.all(np.diff(knots) > 0):
            raise InputError(f"The knots of a mesh must ascend from 0 to 1; got {knots.tolist()}.")
        schemes: list[object] = list(self.scheme) if isinstance(self.scheme, list | tuple) else [self.scheme]
        for scheme in schemes:
            if not isinstance(scheme, Scheme):
                shown = f"the class {scheme.__name__}" if isinstance(scheme, type) else repr(scheme)
                raise InputError(
                    "Mesh(scheme) must be a scheme value such as rt.HermiteSimpson(), with its parentheses; "
                    f"got {shown}."
                )
        if len(schemes) not in (1, len(knots) - 1):
            raise InputError(f"The mesh has {len(knots) - 1} intervals but {len(schemes)} schemes.")

    def __str__(self) -> str:
        kinds = ", ".join(dict.fromkeys(map(as_call, self.given)))
        return shorten(f"{type(self).__name__} of {self.count} intervals, {kinds}", WIDTH, placeholder=" ...")

    @classmethod
    def chebyshev(cls, count: int, scheme: Scheme | Sequence[Scheme] | None = None) -> Mesh:
        """Return ``count`` intervals that are shorter at both ends: knots at (1 - cos(pi k / count)) / 2.

        The first and last interval take (pi / (2 count))^2 of the phase, those in the middle pi / (2 count). In minimum
        time a robot starts and stops within milliseconds, so that equal intervals need many more for the same error.

        Raises
        ------
        InputError
            ``count`` is no whole number from 1 to ``MOST``, or see ``Mesh``.
        """
        knots = tuple(lobatto_sites(whole("Mesh.chebyshev(count)", count, 1, MOST) + 1).tolist())
        return cls(knots, HermiteSimpson() if scheme is None else scheme)

    @property
    def knots(self) -> Array:
        """Knots as fractions of the phase, (K + 1,)."""
        if isinstance(self.intervals, int | np.integer):
            return np.linspace(0.0, 1.0, int(self.intervals) + 1)
        return np.asarray(self.intervals, dtype=float)

    @property
    def lengths(self) -> Array:
        """Lengths of the intervals as fractions of the phase, (K,); equal intervals have the same digits."""
        if isinstance(self.intervals, int | np.integer):
            return np.full(int(self.intervals), 1.0 / int(self.intervals))
        return np.diff(self.knots)

    @property
    def count(self) -> int:
        """Number of intervals K."""
        return len(self.knots) - 1

    @property
    def given(self) -> tuple[Scheme, ...]:
        """The given schemes: one for all intervals, or one for each."""
        return (self.scheme,) if isinstance(self.scheme, Scheme) else tuple(self.scheme)

    @property
    def schemes(self) -> tuple[Scheme, ...]:
        """The scheme of each interval."""
        given = self.given
        return given * self.count if len(given) == 1 else given


@dataclass(frozen=True)
class MovingMesh(Mesh):
    """A mesh whose knots move: interval lengths are unknowns, and controls may jump at every knot.

    Knots can thus move to switching times. Prefer a scheme with a constant or linear control, which cannot exceed its
    limits inside a long interval. The length h_k of interval k, given as the share d_k of the phase, satisfies
    least d_k T <= h_k <= most d_k T.

    Parameters
    ----------
    intervals, scheme
        See ``Mesh``; initial values of the knots.
    least, most : float
        Least and greatest length of an interval, relative to its given length.
    """

    least: float = 0.2
    most: float = 3.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (is_number(self.least) and is_number(self.most) and 0 < self.least <= 1 <= self.most):
            raise InputError(f"MovingMesh needs 0 < least <= 1 <= most; got least {self.least!r}, most {self.most!r}.")
