"""Piecewise polynomials as callable values.

Each interval holds values on its own sites, so the degrees of intervals may differ.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import basis, basis_at, differentiation
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass


@dataclass(frozen=True)
class PiecewisePolynomial(OneLine):
    """A vector-valued function of time, polynomial on each interval.

    Attributes
    ----------
    breaks : ndarray (K + 1,)
        Ends of the intervals [s], ascending.
    sites : sequence of K arrays (m_k,)
        Places of the values of an interval, in [0, 1].
    values : sequence of K arrays (m_k, n)
        Values at the sites; the polynomial of interval k has degree m_k - 1.
    """

    breaks: Array
    sites: Sequence[Array]
    values: Sequence[Array]

    @property
    def size(self) -> int:
        """Length n of the vector."""
        return int(self.values[0].shape[1])

    @cached_property
    def _lengths(self) -> Array:
        return np.diff(self.breaks)

    @cached_property
    def _stacks(self) -> tuple[NDArray[np.int_], list[tuple[Array, Array]], NDArray[np.int_]]:
        """Kind of every interval, sites and stacked values of each kind, and index of every interval in its stack."""
        found: dict[bytes, int] = {}
        # Most intervals share one array of sites.
        distinct = {id(sites): sites for sites in self.sites}
        numbers = {
            key: found.setdefault(np.asarray(sites, dtype=float).tobytes(), len(found))
            for key, sites in distinct.items()
        }
        kinds = np.array([numbers[id(sites)] for sites in self.sites])
        members = [np.flatnonzero(kinds == kind) for kind in range(len(found))]
        position = np.empty(len(kinds), dtype=int)
        for own in members:
            position[own] = np.arange(len(own))
        return (
            kinds,
            [(self.sites[int(own[0])], np.stack([self.values[int(k)] for k in own])) for own in members],
            position,
        )

    def locate(self, t: Array | float) -> NDArray[np.int_]:
        """Interval of each time; a knot belongs to the interval on its right, the last knot to the last interval."""
        return np.clip(self.breaks.searchsorted(t, side="right") - 1, 0, len(self._lengths) - 1)

    def __call__(self, t: ArrayLike, interval: int | NDArray[np.int_] | None = None) -> Array:
        """Evaluate at times.

        Parameters
        ----------
        t : float or array (m,)
            Times [s].
        interval : int or array (m,), optional
            Interval whose polynomial is used, one or one per time. It selects one-sided values at knots.

        Returns
        -------
        ndarray (n,) or (m, n)
        """
        if np.ndim(t) == 0:
            return self._at(float(t), interval)  # type: ignore[arg-type]  # a scalar, since ndim is 0
        times = np.asarray(t, dtype=float)
        out = np.empty((len(times), self.size))
        where = self.locate(times) if interval is None else np.full(len(times), interval)
        lengths = self._lengths[where]
        with np.errstate(divide="ignore", invalid="ignore"):
            tau = np.where(lengths > 0, (times - self.breaks[where]) / lengths, 0.0)
        kinds, stacks, position = self._stacks
        for kind, (sites, values) in enumerate(stacks):
            chosen = kinds[where] == kind
            if chosen.any():
                weights = basis(sites, tau[chosen])
                out[chosen] = (weights[:, None, :] @ values[position[where[chosen]]])[:, 0]
        return out

    def _at(self, t: float, interval: int | NDArray[np.int_] | None) -> Array:
        """Evaluate at one time, fast: simulations do so thousands of times."""
        k = int(self.locate(t) if interval is None else interval)
        length = self._lengths[k]
        sites = self.sites[k]
        return basis_at(sites, (t - self.breaks[k]) / length if length > 0 else 0.0) @ self.values[k]

    def inside(self, tau: Array) -> Array:
        """Evaluate every interval at the same places tau in [0, 1], (m,) -> (K, m, n)."""
        out = np.empty((len(self.sites), len(tau), self.size))
        kinds, stacks, _ = self._stacks
        for kind, (sites, values) in enumerate(stacks):
            out[kinds == kind] = basis(sites, tau) @ values
        return out

    def derivative(self) -> PiecewisePolynomial:
        """Time derivative, on the same sites."""
        values = []
        kinds, stacks, _ = self._stacks
        matrices = [differentiation(sites) for sites, _ in stacks]
        for kind, value, length in zip(kinds, self.values, self._lengths, strict=True):
            rate = matrices[kind] @ value
            values.append(rate / length if length > 0 else np.zeros_like(rate))
        return PiecewisePolynomial(self.breaks, self.sites, values)

    def after(self, start: float) -> PiecewisePolynomial:
        """Return the function from a time on, with the same polynomials.

        Raises
        ------
        ValueError
            The time is not before the end.
        """
        if not start < self.breaks[-1]:
            raise ValueError(f"{start} is not before the end {self.breaks[-1]}.")
        first = int(self.locate(start))
        end = float(self.breaks[first + 1])
        values = self(start + (end - start) * np.asarray(self.sites[first]), first)
        breaks = np.append(start, self.breaks[first + 1 :])
        return PiecewisePolynomial(breaks, self.sites[first:], [values, *self.values[first + 1 :]])

    def shifted(self, offset: float) -> PiecewisePolynomial:
        """Return the function delayed by ``offset`` [s]."""
        return PiecewisePolynomial(self.breaks + offset, self.sites, self.values)
