"""What holds rows on states between the collocation points.

A row holds where it is imposed; between, the polynomial may bulge over. Two ways to deal with it:

- ``Exchange`` looks where a solution bulges, imposes the row there too and solves again (``guards``);
- ``ConvexHull`` imposes it, from the start, on the Bernstein coefficients of the polynomial on every interval. A
  polynomial lies in the convex hull of these, so the row holds everywhere. It asks a little more than needed, an excess
  that falls with the square of the interval's length.

Source: Farouki, The Bernstein polynomial basis: a centennial retrospective, Computer Aided Geometric Design 29 (2012).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj.constraints import Where
from robotraj.constraints.base import symbols_of
from robotraj.errors import InputError
from robotraj.polynomials import integrals
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.table import Entry, ScalarTable
from robotraj.transcription.triplets import Triplets

if TYPE_CHECKING:
    from robotraj.problem import Phase

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Exchange:
    """Impose rows where a solution breaks them and solve again, until none is broken by more than the tolerance.

    Parameters
    ----------
    tolerance : float
        How far a row on states may be broken between collocation points before it is imposed there [its SI unit].
    rounds : int
        Times that the problem is solved again at most; 0 looks, and says what it found, but imposes nothing.
    """

    tolerance: float = 5e-4
    rounds: int = 6

    def __post_init__(self) -> None:
        if not self.tolerance > 0:
            raise InputError(f"{type(self).__name__}(tolerance) must be above 0, got {self.tolerance}.")
        if self.rounds < 0:
            raise InputError(f"{type(self).__name__}(rounds) must be 0 or more, got {self.rounds}.")

    def covers(self, phase: Phase) -> frozenset[str]:
        """Give the states whose bounds are imposed on whole intervals: none."""
        return frozenset()


@dataclass(frozen=True)
class ConvexHull(Exchange):
    """Impose bounds of velocities, and of all states whose rates are unknowns, on Bernstein coefficients.

    What is left, rows on positions and expressions of the state, is dealt with as in ``Exchange``.
    """

    def covers(self, phase: Phase) -> frozenset[str]:
        """Give the states whose rates read algebraic variables or controls directly, in phases without invariants."""
        dae = phase.dae
        if dae.invariants:
            return frozenset()
        point = symbols_of(dae, phase.parameter_names)
        inner = ca.vertcat(ca.SX(0, 1), *(point.z[v.name] for v in phase.body.algebraic), *point.u.values())
        rates = ca.vertsplit(dae.rates(point))
        return frozenset(s.name for s, rate in zip(dae.states, rates, strict=True) if ca.depends_on(rate, inner))


def impose_hull(
    between: Exchange,
    phase: Phase,
    index: int,
    layout: PhaseLayout,
    rows: ScalarTable,
    linear: Triplets,
    scatter: Triplets,
    outputs: int,
) -> None:
    """Add rows on the inner Bernstein coefficients of covered states; the outer ones are the knots.

    Parameters
    ----------
    outputs : int
        Of the phase's stage, whose first ones are T f.
    """
    covered = between.covers(phase)
    names = [s.name for s in phase.dae.states]
    for constraint in phase.bound_constraints:
        chosen = [r for r in constraint.rows if r.variable in covered and constraint.where is Where.THROUGHOUT]
        if not chosen:
            continue
        component = np.array([names.index(str(row.variable)) for row in chosen])
        entries = [Entry(index, row.name, row.joint or "", row.unit) for row in chosen]
        lower, upper = (np.array([getattr(row, side) for row in chosen]) for side in ("lower", "upper"))
        for run in layout.runs:
            weights = coefficient_weights(tuple(run.scheme.nodes.tolist()))
            count = len(weights)
            fractions = run.start[:, None] + run.length[:, None] * (np.arange(count) + 1) / (count + 1)
            shape = (*fractions.shape, len(chosen))
            at = rows.add(entries, fractions.ravel(), lower, upper).reshape(shape)
            linear.spread(at, run.left[:, None, component], 1.0)
            scatter.spread(
                at[..., None],
                run.places[:, None, None, :] * outputs + component[:, None],
                run.clock_length[:, None, None, None] * weights[:, None, :],
            )


@lru_cache(maxsize=256)
def coefficient_weights(nodes: tuple[float, ...]) -> Array:
    """Weights W of x_0 + d sum_k W_jk (T f_k), the inner Bernstein coefficients j = 1 .. s - 1 of an interval's state.

    Parameters
    ----------
    nodes : tuple of float
        The s nodes of the scheme; the state is a polynomial of degree s.
    """
    s = len(nodes)
    sites = np.linspace(0.0, 1.0, s + 1)
    j = np.arange(s + 1)
    binomials = np.array([math.comb(s, k) for k in j.tolist()])
    bernstein = binomials * sites[:, None] ** j * (1.0 - sites[:, None]) ** (s - j)
    return np.asarray(np.linalg.solve(bernstein, integrals(np.array(nodes), sites))[1:-1])
