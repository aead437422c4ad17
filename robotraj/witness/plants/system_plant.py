"""A System under its planned controls."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj.robot.size.state_sizes import state_sizes
from robotraj.witness.numbers import as_numbers
from robotraj.witness.planned import system_of
from robotraj.witness.plants.plant import Landing
from robotraj.witness.point import system_point
from robotraj.witness.protocols import PhaseSolutionLike, Settle, SystemLike

ALGEBRAIC_TOLERANCE = 1e-9
"""Largest residual of a solved algebraic equation, in units of 1 + the largest planned |z|."""

DIFFERENCE = 1e-7
"""Finite difference of a state, relative to its size in the motion, or to its value where that is larger."""


class SystemPlant:
    """A System under its planned controls; see ``Plant``.

    Algebraic variables are solved for at every evaluation of the rates.
    """

    def __init__(self, planned: PhaseSolutionLike) -> None:
        self._system = system_of(planned)
        self.names = tuple(s.name for s in self._system.states)
        self.gap_names = self.names
        self.gap_units = tuple(s.unit for s in self._system.states)
        self._planned = planned

    settle: Settle | None = None

    @cached_property
    def _sizes(self) -> Array:
        return state_sizes(self.gap_units, self.states(np.asarray(self._planned.knots)))

    def states(self, times: Array, interval: int | NDArray[np.int_] | None = None) -> Array:
        """Return the planned states (m, n)."""
        return columns(self._planned.at(times, interval=interval).x, self.names, len(times))

    def gaps(self, states: Array, planned: Array) -> Array:
        """Return the differences (m, n), state by state."""
        return states - planned

    def coordinates(self, states: Array) -> Array:
        """Return the states themselves."""
        return states

    def spread(self, sizes: Array) -> Array:
        """Return the sizes themselves."""
        return sizes

    def begin(self, x: Array) -> tuple[Array, tuple[Landing, ...]]:
        """Return x: a System has no contacts."""
        return x, ()

    def watched(self, landings: tuple[Landing, ...], states: Array) -> tuple[Landing, ...]:
        """Return the landings unchanged: a System has none."""
        return landings

    def given(self, times: Array) -> Array:
        """Return the controls, and the planned algebraic variables as first iterates."""
        sample = self._planned.at(times)
        controls = columns(sample.u, tuple(c.name for c in self._system.controls), len(times))
        algebraic = columns(sample.z, tuple(z.name for z in self._system.algebraic), len(times))
        return np.hstack([controls, algebraic])

    def rate(self, t: float, x: Array, given: Array) -> Array:
        """Evaluate the user's equations on numbers."""
        system, count = self._system, len(self._system.controls)
        u, z = given[:count], given[count:]
        if len(z):
            z = _solve_algebraic(system, t, x, z, u, self._planned.parameters)
        point = system_point(system, t, x, z, u, self._planned.parameters)
        return as_numbers(system.dynamics(point), "dynamics")

    def jacobian(self, t: float, x: Array, given: Array) -> Array:
        """Differentiate the rates by forward differences."""
        here = self.rate(t, x, given)
        matrix = np.empty((len(here), len(x)))
        for i, size in enumerate(DIFFERENCE * np.maximum(self._sizes, np.abs(x))):
            there = x.copy()
            there[i] += size
            matrix[:, i] = (self.rate(t, there, given) - here) / size
        return matrix


def columns(named: Mapping[str, float | Array], names: tuple[str, ...], count: int) -> Array:
    """Stack the named entries of a sample into (count, len(names))."""
    if not names:
        return np.empty((count, 0))
    return np.column_stack([np.asarray(named[name], dtype=float) for name in names])


def arguments(planned: PhaseSolutionLike, times: Array, interval: int | NDArray[np.int_]) -> list[Array]:
    """Return the values of a phase's symbols t, x, z, u, p at times (m,) of intervals, one column a time."""
    sample, dae, count = planned.at(times, interval=interval), planned.phase.dae, len(times)
    kinds = ((sample.x, dae.states), (sample.z, dae.algebraic), (sample.u, dae.controls))
    values = [columns(named, tuple(v.name for v in kind), count).T for named, kind in kinds]
    parameters = np.array([planned.parameters[name] for name in planned.phase.parameter_names], dtype=float)
    return [times[None, :], *values, np.tile(parameters[:, None], count)]


def _solve_algebraic(
    system: SystemLike, t: float, x: Array, z: Array, u: Array, parameters: Mapping[str, float]
) -> Array:
    """Solve 0 = g(x, z, u, p, t) for z from the planned z; return NaN where no root is near it."""
    residual = system.residual
    assert residual is not None

    def rows(trial: Array) -> Array:
        return as_numbers(residual(system_point(system, t, x, trial, u, parameters)), "residual")

    # MINPACK reports "no progress" at round-off, so the residual decides.
    found = scipy.optimize.root(rows, z, method="hybr", tol=1e-14)
    solved = np.max(np.abs(found.fun)) <= ALGEBRAIC_TOLERANCE * (1.0 + np.max(np.abs(z)))
    return found.x if solved else np.full_like(z, np.nan)
