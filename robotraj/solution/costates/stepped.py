"""Covector mapping of one-step schemes: shooting and compressed collocation.

The defect x_1 - Phi(x_0, u) = 0 of an interval has the multiplier mu; with L_k the interval's terms of the
Lagrangian,

    lambda(t_k+) = dL_k / dx_0,    lambda(t_{k+1}-) = -dL_k / dx_1 = -mu  in shooting,

which is the discrete adjoint of the integrator. Between the knots the adjoint equation lambdadot = -l_x -
f_x' lambda, linear in lambda, is collocated along the trajectory from the knot on the left. Multipliers of rows on
states make the costate jump at the knots. In single shooting, rows that are not bounds of states are taken as inactive
between the ends of the phase.

Source: Hager, Runge-Kutta methods in optimal control
and the transformed adjoint system, Numerische Mathematik 87 (2000).
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import integrals
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.solution.costates.duals import PhaseDuals
from robotraj.solution.costates.hamiltonian import Hamiltonian
from robotraj.solvers.base import Multipliers
from robotraj.transcription.extract import PhaseTrajectory, extract
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.schemes.lobatto import LobattoIIIA
from robotraj.transcription.schemes.onestep import OneStep

ADJOINT = LobattoIIIA(points=4)
"""Collocates the adjoint equation between the knots: order 6."""


def stepped_duals(nlp: Nlp, index: int, w: Array, multipliers: Multipliers) -> PhaseDuals:
    """Map the multipliers of a phase by a one-step scheme."""
    layout, phase = nlp.layouts[index], nlp.problem.phases[index]
    scheme = layout.scheme
    assert isinstance(scheme, OneStep)
    nx, pieces = len(phase.dae.states), len(scheme.pieces) - 1
    gradients, outputs = _lagrangian(nlp, index, w, multipliers)
    trajectory = extract(nlp, w)[index]
    weights, matrices = _adjoint(Hamiltonian.of(phase), trajectory)
    breaks, values = trajectory.x.breaks, []
    for k, gradient in enumerate(gradients):
        costate = gradient[:nx]
        for j in range(pieces):
            piece = k * pieces + j
            h = breaks[piece + 1] - breaks[piece]
            values.append(_carried(costate, h, weights[piece], matrices[piece]))
            # Single shooting: multipliers of states between its ends follow the defect's.
            costate = values[-1][-1] - outputs[k, nx + j * nx : 2 * nx + j * nx] if j + 1 < pieces else costate
        if pieces == 1:
            values[-1] = values[-1] + np.outer(ADJOINT.nodes, -gradient[nx : 2 * nx] - values[-1][-1])
    sites = [ADJOINT.nodes] * len(values)

    def nothing(size: int) -> PiecewisePolynomial:
        return PiecewisePolynomial(breaks, sites, [np.zeros((len(ADJOINT.nodes), size))] * len(values))

    return PhaseDuals(
        PiecewisePolynomial(breaks, sites, values),
        nothing(0),
        nothing(len(Hamiltonian.of(phase).path)),
        nothing(nx),
        nothing(0),
        _control_bounds(nlp, index, multipliers.bounds, breaks),
    )


def _lagrangian(nlp: Nlp, index: int, w: Array, multipliers: Multipliers) -> tuple[Array, Array]:
    """Gradients of the intervals' terms by their unknowns, (K, n_v), and multipliers of their outputs, (K, n_y)."""
    block = nlp.blocks[index]
    stage = block.stage
    outputs = (block.scatter.T @ multipliers.rows).reshape(block.count, stage.outputs)
    weighed = outputs.copy()
    if stage.costed is not None:
        weighed[:, stage.costed] += block.weights
    rows, columns = stage.jacobian_pattern
    nonzeros = np.array(stage.jacobian.map(block.count)(block.places(w), block.constants)).reshape(-1, block.count)
    gradients = np.zeros((block.count, stage.inputs))
    for row, column, values in zip(rows, columns, nonzeros, strict=True):
        gradients[:, column] += weighed[:, row] * values
    return gradients, outputs


def _adjoint(hamiltonian: Hamiltonian, trajectory: PhaseTrajectory) -> tuple[Array, Array]:
    """Gradients l_x (K, s, nx) and matrices f_x' (K, s, nx, nx) at the nodes of every interval of the mesh."""
    symbols, nx = hamiltonian.symbols, trajectory.x.size
    arguments = [symbols[name] for name in ("t", "x", "u", "p")]
    by_x = hamiltonian.gradient("x")
    none = [ca.SX.zeros(symbols[name].shape) for name in ("costate", "nu", "eta")]
    own = ca.substitute(by_x, ca.vertcat(*(symbols[n] for n in ("costate", "nu", "eta"))), ca.vertcat(*none))
    slopes = ca.jacobian(by_x, symbols["costate"])
    function = ca.Function("adjoint", arguments, [ca.densify(own), ca.densify(slopes)])
    breaks = trajectory.x.breaks
    times = breaks[:-1, None] + np.diff(breaks)[:, None] * ADJOINT.nodes
    x = np.vstack([trajectory.x(t, k) for k, t in enumerate(times)])
    u = np.vstack([trajectory.u(t, k) for k, t in enumerate(times)])
    p = np.tile(np.array(list(trajectory.parameters.values()), dtype=float)[:, None], times.size)
    a, b = (np.array(v) for v in function.map(times.size)(times.reshape(1, -1), x.T, u.T, p))
    shape = (*times.shape, nx)
    return a.T.reshape(shape), b.reshape(nx, times.size, nx).transpose(1, 0, 2).reshape(*shape, nx)


def _carried(start: Array, h: float, weights: Array, matrices: Array) -> Array:
    """Costate at the nodes of an interval: lambda_j + h sum_k A_jk (l_x + f_x' lambda)_k = start."""
    s, nx = weights.shape
    reach = integrals(ADJOINT.nodes, ADJOINT.nodes)
    system = np.eye(s * nx) + h * np.einsum("jk,kab->jakb", reach, matrices).reshape(s * nx, s * nx)
    right = start - h * reach @ weights
    return np.asarray(np.linalg.solve(system, right.ravel()).reshape(s, nx))


def _control_bounds(nlp: Nlp, index: int, bounds: Array, breaks: Array) -> PiecewisePolynomial:
    """Densities of the controls' bounds at the control's sites, weighted by the integrals of their polynomials."""
    layout = nlp.layouts[index]
    columns, sites = [], []
    for interval in layout.intervals:
        scheme = interval.scheme
        assert isinstance(scheme, OneStep)
        for j in range(len(scheme.pieces) - 1):
            columns.append(interval.controls[scheme.controls_of(j)])
            sites.append(scheme.piece_sites)
    seconds = np.zeros(len(nlp.variables))
    for own, at, h in zip(columns, sites, np.diff(breaks), strict=True):
        np.add.at(seconds, own, h * integrals(at, np.array([1.0]))[0][:, None])
    values = [bounds[own] / np.where(seconds[own] > 0, seconds[own], 1.0) for own in columns]
    return PiecewisePolynomial(breaks, sites, values)
