"""Rows on the time derivatives of controls and algebraic variables: jerks, rates of torques.

On an interval of relative length L of a phase of duration T, a variable is the polynomial through its values y_k at its
sites. The Bernstein coefficients of its derivative are sum_k D_jk y_k / (L T), so that l <= dy/dt <= u holds
everywhere if

    sum_k D_jk y_k - u L T <= 0,    sum_k D_jk y_k - l L T >= 0,

which is linear in the unknowns y and T. For the parabola through y_0, y_m, y_1 of Hermite-Simpson, D y is
4 y_m - 3 y_0 - y_1 and 3 y_1 + y_0 - 4 y_m, the derivatives at both ends. Rows are divided by L, and by T where it is
fixed.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.curves.polynomials import basis, differentiation
from robotraj._util.errors import InputError
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.interval_limits.bernstein_bounds import from_values
from robotraj.transcription.layout import PhaseLayout, Run
from robotraj.transcription.scalar_table import Entry, ScalarTable
from robotraj.transcription.schemes.onestep import OneStep


def impose_on_rates(phase: Phase, index: int, layout: PhaseLayout, rows: ScalarTable, linear: Triplets) -> None:
    """Add the rows on time derivatives of variables.

    Raises
    ------
    InputError
        The mesh moves, or a variable may jump at the knots.
    """
    if not phase.rows.rates:
        return
    kinds = enumerate((phase.dae.algebraic, phase.dae.controls))
    for row, component, group in ((*each, k) for k, variables in kinds for each in phase.rows.rates_of(variables)):
        for run in layout.runs:
            sites, columns = _sites(run, group)
            if layout.own_clocks is not None or isinstance(run.scheme, OneStep) or not _is_continuous(sites):
                raise InputError(
                    f"Phase {phase.name!r}: the {row.name} needs a variable that is continuous at fixed knots; use a "
                    "mesh such as rt.Mesh(20, rt.HermiteSimpson())."
                )
            _impose(row, index, layout, run, rows, linear, sites, columns[..., component])


def _sites(run: Run, group: int) -> tuple[Array, Indices]:
    scheme = run.scheme
    if isinstance(scheme, OneStep):
        return np.zeros(1), run.controls
    return (scheme.control_sites, run.controls) if group else (scheme.nodes, run.algebraic)


def _is_continuous(sites: Array) -> bool:
    return len(sites) > 1 and sites[0] == 0.0 and sites[-1] == 1.0


def _impose(
    row: PhaseRow,
    index: int,
    layout: PhaseLayout,
    run: Run,
    rows: ScalarTable,
    linear: Triplets,
    sites: Array,
    columns: Indices,
) -> None:
    """Add a row for every coefficient and every finite bound, columns (intervals, sites)."""
    weights = derivative_weights(tuple(sites.tolist()))
    fractions = np.linspace(0.0, 1.0, len(weights))
    at = run.start[:, None] + run.length[:, None] * fractions
    free = layout.duration.column
    scales = 1.0 / run.length if free is not None else 1.0 / (run.length * layout.duration.value)
    for bound, below in ((row.lower, True), (row.upper, False)):
        if not np.isfinite(bound):
            continue
        value = bound if free is None else 0.0
        lower, upper = (value, np.inf) if below else (-np.inf, value)
        added = rows.add([Entry.of(index, row)], at.ravel(), lower, upper).reshape(at.shape)
        linear.spread(added[..., None], columns[:, None, :], scales[:, None, None] * weights)
        if free is not None:
            linear.spread(added, np.array(free), -bound)


@lru_cache(maxsize=64)
def derivative_weights(sites: tuple[float, ...]) -> Array:
    """Return the matrix from a polynomial's values at m sites to the m - 1 coefficients of its derivative."""
    at = np.array(sites)
    equal = np.linspace(0.0, 1.0, len(at) - 1) if len(at) > 2 else np.zeros(1)
    slopes = differentiation(at)
    # The derivative has one degree less: its values at fewer places determine it.
    return np.asarray(from_values(len(at) - 2) @ (basis(at, equal) @ slopes))
