"""Error of integral constraints, interval by interval: a scheme's quadrature against a finer one.

A scheme sums the integrand q of an integral constraint at its nodes, h sum_j b_j q(t_j). Its error on an interval,

    error = K |h sum_j b_j q(t_j) - integral q dt| / (1 + |bound|),

takes the integral by Gauss's rule along the polynomials of the states and controls. By the factor K, the number of
intervals, the largest error bounds that of the whole integral. It is not part of the residual of the dynamics. A
control that oscillates from node to node may satisfy the sum but not the constraint.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import gauss
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.problem.phase import Phase
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.schemes.collocation import Collocation, Scheme

MORE = 8
"""Number of points of the finer rule beyond those of the scheme, for integrands of controls that alternate."""


def integral_errors(phase: Phase, trajectory: PhaseTrajectory, schemes: Sequence[Scheme]) -> Array:
    """Return the largest error of an integral constraint on every interval, K times relative to 1 + |bound|, (K,).

    Parameters
    ----------
    phase : Phase
    trajectory : PhaseTrajectory
        Polynomials of the phase.
    schemes : sequence of Scheme
        Schemes of the K intervals.
    """
    breaks = trajectory.x.breaks
    rows = phase.rows.integrals
    collocated = [scheme for scheme in schemes if isinstance(scheme, Collocation)]
    errors = np.zeros(len(breaks) - 1)
    if not rows or len(collocated) < len(schemes):
        return errors
    places, weights, owner = [], [], []
    for k, scheme in enumerate(collocated):
        fine, shares = gauss(len(scheme.nodes) + MORE)
        places.append(np.concatenate([scheme.nodes, 0.5 * (fine + 1.0)]))
        weights.append((breaks[k + 1] - breaks[k]) * np.concatenate([scheme.objective_weights, -0.5 * shares]))
        owner.append(np.full(len(places[-1]), k))
    values = _integrands(phase, trajectory, places)
    bounds = [row.greatest_bound for row in rows]
    left = np.zeros((len(errors), len(rows)))
    np.add.at(left, np.concatenate(owner), np.concatenate(weights)[:, None] * values)
    return np.asarray(len(errors) * np.max(np.abs(left) / (1.0 + np.array(bounds)), axis=1))


def _integrands(phase: Phase, trajectory: PhaseTrajectory, places: Sequence[Array]) -> Array:
    """Return the integrands at places of every interval, at knots those of its own side, (m, rows)."""
    breaks = trajectory.x.breaks
    times = [a + (b - a) * tau for a, b, tau in zip(breaks[:-1], breaks[1:], places, strict=True)]

    def sampled(curve: PiecewisePolynomial) -> Array:
        return np.vstack([curve(t, k) for k, t in enumerate(times)])

    x, z, u = (sampled(curve) for curve in (trajectory.x, trajectory.z, trajectory.u))
    parameters = np.array(list(trajectory.parameters.values()), dtype=float)
    return phase.rows.sample(phase.rows.integrals, np.concatenate(times), x, z, u, parameters)
