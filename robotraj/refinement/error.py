"""Error of a collocated trajectory between its nodes, interval by interval.

At any time the collocated polynomial x(t) has the residual e(t) = xdot(t) - f(x, z, u, p, t), zero at the nodes only. Betts
measures an interval by the integral of its absolute value, relative to the size of each state,

    eta_i = integral |e_i| dt,    error = max_i eta_i / (1 + max over t of |x_i|, |xdot_i|).

Algebraic variables are not interpolated but solved from 0 = g(x, z, u, p, t) at every sample, so that the rows of g count
as well: for a robot by inverse dynamics this compares the planned acceleration with the true one.
Sources: Betts, Practical Methods for Optimal Control (2010), section 4.7.4; Kelly, SIAM Review 59 (2017), section 8.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj.transcription.extract import PhaseTrajectory

if TYPE_CHECKING:
    from robotraj.problem import Phase

Array = NDArray[np.float64]

NEWTON_STEPS = 4
"""Steps that solve g = 0 for z from the interpolated z; one is exact where g is linear in z, as for rigid bodies."""


def interval_errors(phase: Phase, trajectory: PhaseTrajectory) -> Array:
    """Relative error of every interval, (K,).

    Parameters
    ----------
    phase : Phase
    trajectory : PhaseTrajectory
        Its polynomials.
    """
    breaks = trajectory.x.breaks
    rates = trajectory.x.derivative()
    counts = [len(sites) + 2 for sites in trajectory.z.sites]
    times, weights, owner = [], [], []
    for k, count in enumerate(counts):
        points, w = np.polynomial.legendre.leggauss(count)
        length = breaks[k + 1] - breaks[k]
        times.append(breaks[k] + 0.5 * length * (points + 1.0))
        weights.append(0.5 * length * w)
        owner.append(np.full(count, k))
    t, weight, k = (np.concatenate(part) for part in (times, weights, owner))
    x, xdot, z, u = (curve(t) for curve in (trajectory.x, rates, trajectory.z, trajectory.u))
    f = _rates(phase, t, x, z, u, np.array(list(trajectory.parameters.values())))
    eta = np.zeros((len(counts), x.shape[1]))
    np.add.at(eta, k, weight[:, None] * np.abs(xdot - f))
    size = 1.0 + np.maximum(np.abs(x).max(axis=0), np.abs(xdot).max(axis=0))
    return np.asarray((eta / size).max(axis=1))


def _rates(phase: Phase, t: Array, x: Array, z: Array, u: Array, p: Array) -> Array:
    """f at samples with z solved from g = 0, (m, nx)."""
    dae = phase.dae
    symbols = [ca.SX.sym("t")] + [
        ca.SX.sym(name, size)
        for name, size in (
            ("x", len(dae.states)),
            ("z", len(dae.algebraic)),
            ("u", len(dae.controls)),
            ("p", len(p)),
        )
    ]
    point = dae.point(*symbols, phase.parameter_names)
    f = ca.Function("f", symbols, [ca.densify(dae.rates(point))]).map(len(t))
    parameters = np.tile(p[:, None], len(t))
    if z.shape[1]:
        g = dae.residual(point)
        step = ca.Function("g", symbols, [ca.densify(g), ca.densify(ca.jacobian(g, symbols[2]))]).map(len(t))
        for _ in range(NEWTON_STEPS):
            rows, slopes = step(t[None, :], x.T, z.T, u.T, parameters)
            matrices = np.array(slopes).reshape(z.shape[1], len(t), z.shape[1]).transpose(1, 0, 2)
            change = np.linalg.solve(matrices, np.array(rows).T[:, :, None])[:, :, 0]
            z = z - change
            if np.max(np.abs(change)) <= 1e-12 * (1.0 + np.max(np.abs(z))):
                break
    return np.array(f(t[None, :], x.T, z.T, u.T, parameters)).T
