"""Rows on the Bernstein coefficients of the polynomials of an interval, which bound the polynomials.

A polynomial of degree n lies between the least and the greatest of its n + 1 coefficients b_j in

    sum_j b_j binom(n, j) tau^j (1 - tau)^(n - j),    tau in [0, 1].

The first and the last are its values at the ends. All coefficients are linear in the unknowns. The state is a
polynomial of degree s with unknown rates at the s nodes. The control is a polynomial through its m sites, and
accelerations are polynomials through the nodes. For the parabola through u_0, u_m, u_1 of Hermite-Simpson the middle
coefficient is 2 u_m - (u_0 + u_1) / 2.
Source: Farouki, The Bernstein polynomial basis: a centennial retrospective, Computer Aided Geometric Design 29 (2012).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import groupby

import numpy as np

from robotraj._util.arrays import Array, Indices, Mask
from robotraj._util.curves.polynomials import basis, integrals
from robotraj.dynamics.variable import Variable
from robotraj.problem.constraints.base import Where
from robotraj.problem.feasibility import SLACK
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.layout import PhaseLayout, Run
from robotraj.transcription.scalar_table import ScalarTable
from robotraj.transcription.schemes.onestep import OneStep


def impose_on_states(
    interval_limits: ConstraintGeneration,
    phase: Phase,
    index: int,
    layout: PhaseLayout,
    rows: ScalarTable,
    linear: Triplets,
    scatter: Triplets,
    outputs: int,
) -> None:
    """Add rows on the inner coefficients of covered states; the outer ones are values at the knots.

    Parameters
    ----------
    outputs : int
        Number of outputs of the phase's stage; the first ones are T f.
    """
    for chosen, component in _held(interval_limits, phase, phase.dae.states):
        for run in layout.runs:
            weights = state_weights(tuple(run.scheme.nodes.tolist()))
            fractions = (np.arange(len(weights)) + 1) / (len(weights) + 1)
            room = np.zeros((len(run.which), len(fractions), len(chosen)))
            for ends, interval in ((phase.start_bounds, 0), (phase.end_bounds, len(layout.knots) - 2)):
                room[run.which == interval] += _room(chosen, ends.lower[component], ends.upper[component])
            at = _add(rows, index, chosen, run, fractions, room)
            linear.spread(at, run.left[:, None, component], 1.0)
            scatter.spread(
                at[..., None],
                run.places[:, None, None, :] * outputs + component[:, None],
                run.clock_length[:, None, None, None] * weights[:, None, :],
            )


def impose_on_controls(
    interval_limits: ConstraintGeneration,
    phase: Phase,
    index: int,
    layout: PhaseLayout,
    rows: ScalarTable,
    linear: Triplets,
) -> None:
    """Add rows on the coefficients of covered controls and algebraic variables that are not values at their sites."""
    for variables, pieces in ((phase.dae.controls, _control_pieces), (phase.dae.algebraic, _algebraic_pieces)):
        for chosen, component in _held(interval_limits, phase, variables):
            for run in layout.runs:
                for sites, first, last, own in pieces(run):
                    weights, fractions = control_weights(tuple(sites.tolist()))
                    if not weights.size:
                        continue
                    at = _add(rows, index, chosen, run, first + (last - first) * fractions)
                    linear.spread(at[..., None], own[:, None][..., component].swapaxes(2, 3), weights[:, None, :])


def covered_in(interval_limits: ConstraintGeneration, phase: Phase, layout: PhaseLayout) -> frozenset[str]:
    """Return the variables with rows on coefficients; one-step schemes have none on those of states."""
    covered = interval_limits.covers(phase)
    if isinstance(layout.scheme, OneStep):
        covered -= {state.name for state in phase.dae.states}
    return covered


def columns_beside_rows(phase: Phase, layout: PhaseLayout) -> dict[str, Indices]:
    """Return the columns of every variable that have bounds beside the rows on coefficients, in the order of time.

    States have bounds at knots. Controls and algebraic variables have bounds where they are coefficients, if both ends
    of an interval are sites, else at all sites. The latter follow from the rows, but without them solvers take up to
    four times as many iterations.
    """
    held = {state.name: at for state, at in zip(phase.dae.states, layout.knots.T, strict=True)}
    for variables, pieces in ((phase.dae.controls, _control_pieces), (phase.dae.algebraic, _algebraic_pieces)):
        if not variables:
            continue
        found = []
        for run in layout.runs:
            for sites, _, _, own in pieces(run):
                kept = are_coefficients(sites)
                if kept.sum() < min(len(sites), 2):
                    kept[:] = True
                found.append(own[:, kept].reshape(-1, own.shape[-1]))
        columns = np.sort(np.concatenate(found), axis=0)
        fresh = np.append(True, np.diff(columns[:, 0]) > 0)
        held |= {variable.name: at for variable, at in zip(variables, columns[fresh].T, strict=True)}
    return held


def are_coefficients(sites: Array) -> Mask:
    """Return which values of a control are coefficients: those at the ends of its piece, and that of a constant."""
    return np.asarray((sites == 0.0) | (sites == 1.0) | (len(sites) == 1))


@lru_cache(maxsize=256)
def state_weights(nodes: tuple[float, ...]) -> Array:
    """Return the weights W of x_0 + d sum_k W_jk (T f_k), the inner coefficients j = 1 .. s - 1 of a state.

    Parameters
    ----------
    nodes : tuple of float
        The s nodes of the scheme; the state is a polynomial of degree s.
    """
    sites = np.linspace(0.0, 1.0, len(nodes) + 1)
    return np.asarray((from_values(len(nodes)) @ integrals(np.array(nodes), sites))[1:-1])


@lru_cache(maxsize=256)
def control_weights(sites: tuple[float, ...]) -> tuple[Array, Array]:
    """Return the weights W of sum_k W_jk u_k, the coefficients that are no u_k, and their places, (n, m), (n,).

    Parameters
    ----------
    sites : tuple of float
        Sites of the m values u_k; the control is a polynomial of degree m - 1.
    """
    at = np.array(sites)
    places = np.linspace(0.0, 1.0, len(at)) if len(at) > 1 else at
    missing = ~np.isin(places, at[are_coefficients(at)])
    if not missing.any():
        return np.empty((0, len(at))), np.empty(0)
    return (from_values(len(at) - 1) @ basis(at, places))[missing], places[missing]


def coefficients(sites: Array, values: Array) -> Array:
    """Return the Bernstein coefficients (m, n) of polynomials of degree m - 1 with values (m, n) at sites (m,)."""
    degree = len(sites) - 1
    if degree == 0:
        return values
    return np.asarray(from_values(degree) @ basis(sites, np.linspace(0.0, 1.0, degree + 1)) @ values)


def from_values(degree: int) -> Array:
    """Return the matrix from a polynomial's values at equal distances to its coefficients, (degree + 1, degree + 1)."""
    sites = np.linspace(0.0, 1.0, degree + 1)
    j = np.arange(degree + 1)
    binomials = np.array([math.comb(degree, k) for k in j.tolist()])
    return np.asarray(np.linalg.inv(binomials * sites[:, None] ** j * (1.0 - sites[:, None]) ** (degree - j)))


def on_coefficients(row: PhaseRow, variable: str, covered: frozenset[str]) -> bool:
    """Whether a bound is imposed on coefficients: an inequality on a covered variable, throughout the phase."""
    limited = row.lower < row.upper and (np.isfinite(row.lower) or np.isfinite(row.upper))
    return bool(limited) and row.where is Where.THROUGHOUT and variable in covered


def _held(
    interval_limits: ConstraintGeneration, phase: Phase, variables: Sequence[Variable]
) -> Iterator[tuple[list[PhaseRow], Indices]]:
    """Yield for every constraint its rows on coefficients of the variables, and the indices of these."""
    covered = interval_limits.covers(phase)
    bounds = [
        (row, i) for row, i in phase.rows.bounds_of(variables) if on_coefficients(row, variables[i].name, covered)
    ]
    for _, group in groupby(bounds, lambda pair: pair[0].constraint):
        rows, indices = zip(*group, strict=True)
        yield list(rows), np.array(indices)


def _room(chosen: Sequence[PhaseRow], lower: Array, upper: Array) -> Array:
    """Return the relaxation of limits (n,) beside an end that is fixed at them, or beyond them by round-off."""
    nearest = [min(value - row.lower, row.upper - value) for row, value in zip(chosen, lower, strict=True)]
    sizes = np.array([SLACK * row.size for row in chosen])
    return np.where((lower == upper) & (np.array(nearest) <= sizes), 2.0 * sizes, 0.0)


def _add(
    rows: ScalarTable, index: int, chosen: Sequence[PhaseRow], run: Run, fractions: Array, room: Array | None = None
) -> Indices:
    """Add rows at fractions of every interval of a run, with ``room`` beyond bounds, (intervals, fractions, rows)."""
    at = run.start[:, None] + run.length[:, None] * fractions
    beyond = None if room is None else room.reshape(-1, len(chosen))
    return rows.impose(index, chosen, at.ravel(), beyond).reshape(*at.shape, len(chosen))


def _algebraic_pieces(run: Run) -> Iterator[tuple[Array, float, float, Indices]]:
    """Yield the nodes of the algebraic variables, the ends of an interval, and its columns (intervals, nodes, nz)."""
    yield run.scheme.nodes, 0.0, 1.0, run.algebraic


def _control_pieces(run: Run) -> Iterator[tuple[Array, float, float, Indices]]:
    """Yield the sites of every polynomial of the control, its start and end, and its columns (intervals, sites, nu)."""
    scheme = run.scheme
    if not isinstance(scheme, OneStep):
        yield scheme.control_sites, 0.0, 1.0, run.controls
        return
    for piece, (first, last) in enumerate(zip(scheme.pieces[:-1], scheme.pieces[1:], strict=True)):
        yield scheme.piece_sites, float(first), float(last), run.controls[:, scheme.controls_of(piece)]
