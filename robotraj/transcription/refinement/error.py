"""Error of a collocated trajectory between its nodes, interval by interval.

At any time the collocated polynomial x(t) has the residual e(t) = xdot(t) - f(x, z, u, p, t), zero at the nodes only.
Kelly measures an interval by the integral of its absolute value, state by state and in the state's own unit; Betts
relates that to the size of each state and takes the largest,

    eta_i = integral |e_i| dt,    error = max_i eta_i / s_i,

with the size s_i of a state from the motion itself (``robot.size.state_sizes``).

Algebraic variables are not interpolated but solved from 0 = g(x, z, u, p, t) at every sample, so that the residual
of g counts as well. For a robot by inverse dynamics this compares the planned acceleration with the true one under the
torques that drive the motion (``driven_motion``).

With damping the residual of a light joint is large even if its motion is accurate. The effect of e decays at the rate
lambda_i = (M^-1 D)_ii (with contacts, the entry of the constrained inverse) and is at most |e_i| / lambda_i. Over an
interval of length h the residual therefore counts as |e_i| / (1 + h lambda_i).

Schemes that integrate from knot to knot have the same estimate, by the polynomial of their dense output. It measures
the error of the integration between two knots. For classical Runge-Kutta and compressed Hermite-Simpson it falls as
h^4. For an adaptive integrator it is of the size of the integrator's tolerance on any mesh. It does not measure the
error of piecewise constant or linear controls, which only the objective shows.
Sources: Betts, Practical Methods for Optimal Control (2010), section 4.7.4; Kelly, SIAM Review 59 (2017), section 8.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.curves.polynomials import gauss
from robotraj._util.precision import ROUND_OFF, SAME
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.problem.phase import Phase
from robotraj.problem.sizes.motion_sizes import units_of_states
from robotraj.robot.size.state_sizes import ROUNDING, state_sizes
from robotraj.transcription.driven_motion import Inputs, MotionEquations, PlannedInputs
from robotraj.transcription.extract import PhaseTrajectory

NEWTON_STEPS = 4
"""Newton steps for g = 0 from the interpolated z; one is exact where g is linear in z, as for rigid bodies.

A step is the last one if it changes no algebraic variable by more than ``SAME`` of its largest value.
"""
DEPENDENT = 1e-5
"""Singular values of contact Jacobians below this, relative to the largest, belong to dependent rows.

Of legs in nearly parallel planes, these values are 1e-8 to 1e-6, others above 1e-2."""

CLOSELY = 2**13
"""Points of a System's phase at which its equations are searched for short events."""
PANEL = 512
"""Largest number of points of one rule of Gauss."""
EVENT = 2.0
"""Ratio of the errors at many and at few points of an interval above which an event lies between the few."""


class Residuals(NamedTuple):
    """Residuals of a trajectory at the points of Gauss's rule on every interval.

    Attributes
    ----------
    interval : ndarray (m,)
        Interval of each point.
    weights : ndarray (m,)
        Weights of the rule [s].
    values : ndarray (m, nx)
        xdot - f.
    decay : ndarray (m, nx) or None
        Rates at which each state decays by damping [1/s]; None without damping.
    """

    interval: Indices
    weights: Array
    values: Array
    decay: Array | None

    def effects(self, lengths: Array) -> Array:
        """Return residuals, reduced by the decay over ``lengths`` (K,) of time, (m, nx)."""
        if self.decay is None:
            return self.values
        return np.asarray(self.values / (1.0 + lengths[self.interval][:, None] * self.decay))


def residuals_of(phase: Phase, trajectory: PhaseTrajectory, inputs: Inputs | None = None) -> Residuals:
    """Evaluate xdot - f between the nodes; for the parameters see ``interval_errors``."""
    return _residuals_at(phase, trajectory, inputs, [len(sites) + 2 for sites in trajectory.z.sites])


def _residuals_at(phase: Phase, trajectory: PhaseTrajectory, inputs: Inputs | None, counts: Sequence[int]) -> Residuals:
    """Evaluate xdot - f at the points of Gauss's rule, a number of them on every interval."""
    breaks = trajectory.x.breaks
    times: list[Array] = []
    weights: list[Array] = []
    for k, count in enumerate(counts):
        points, w = _rule(count)
        length = breaks[k + 1] - breaks[k]
        times.append(breaks[k] + 0.5 * length * (points + 1.0))
        weights.append(0.5 * length * w)
    t = np.concatenate(times)
    x, xdot = trajectory.x(t), trajectory.x.derivative()(t)
    z, u = (inputs or PlannedInputs(trajectory)).at(t)
    p = np.array(list(trajectory.parameters.values()), dtype=float)
    values = xdot - _rates(phase, t, x, z, u, p)
    interval = np.repeat(np.arange(len(counts)), [len(each) for each in weights])
    return Residuals(interval, np.concatenate(weights), values, _decay(phase, t, x, z, u, p))


def _rule(count: int) -> tuple[Array, Array]:
    """Return at least ``count`` points of [-1, 1] with their weights: Gauss's rule, of ``PANEL`` points on equal parts.

    The points of one rule are eigenvalues, whose time grows with the cube of their number.
    """
    parts = -(-count // PANEL)
    points, weights = gauss(min(count, PANEL))
    begins = -1.0 + 2.0 * np.arange(parts)[:, None] / parts
    return (begins + (points + 1.0) / parts).ravel(), np.tile(weights / parts, parts)


def interval_errors(
    phase: Phase,
    trajectory: PhaseTrajectory,
    inputs: Inputs | None = None,
    residuals: Residuals | None = None,
    sizes: Array | None = None,
) -> Array:
    """Return the relative error of every interval by Betts's definition, (K,).

    Parameters
    ----------
    phase : Phase
    trajectory : PhaseTrajectory
        Its polynomials.
    inputs : Inputs, optional
        Algebraic variables and controls along the motion; by default their polynomials.
    residuals : Residuals, optional
        Those of ``residuals_of``, where they are known.
    sizes : ndarray (nx,), optional
        Sizes of the states; by default those along this trajectory alone.
    """
    size = sizes_of(phase, [trajectory]) if sizes is None else sizes
    return np.asarray((state_errors(phase, trajectory, inputs, residuals) / size).max(axis=1))


def sizes_of(phase: Phase, trajectories: Sequence[PhaseTrajectory]) -> Array:
    """Return the sizes of the states along the trajectories of phases with the same states, (nx,)."""
    moved = np.vstack([values for each in trajectories for values in each.x.values])
    return state_sizes(units_of_states(phase.dae.states), moved)


def state_errors(
    phase: Phase, trajectory: PhaseTrajectory, inputs: Inputs | None = None, residuals: Residuals | None = None
) -> Array:
    """Return the integral of |xdot - f| over every interval by Kelly's definition, (K, nx), in each state's unit.

    Residuals are reduced by the decay that damping causes, as in the docstring of this module.

    Parameters
    ----------
    phase, trajectory, inputs, residuals
        See ``interval_errors``.
    """
    known = residuals_of(phase, trajectory, inputs) if residuals is None else residuals
    lengths = np.diff(trajectory.x.breaks)
    eta = np.zeros((len(lengths), known.values.shape[1]))
    np.add.at(eta, known.interval, known.weights[:, None] * np.abs(known.effects(lengths)))
    if phase.robot is not None or phase.dae.algebraic:
        return eta
    # The equations of a user may hold an event that is shorter than the distance of the points, such as a kick.
    closely = np.zeros_like(eta)
    every = _residuals_at(phase, trajectory, inputs, [-(-CLOSELY // len(lengths))] * len(lengths))
    np.add.at(closely, every.interval, every.weights[:, None] * np.abs(every.effects(lengths)))
    return np.where(closely > EVENT * eta, closely, eta)


def _decay(phase: Phase, t: Array, x: Array, z: Array, u: Array, p: Array) -> Array | None:
    """Return the rates [1/s] at which each state decays by damping, (m, nx); None without damping."""
    body = phase.body
    if not isinstance(body, InverseRigidBody) or body.design is not None or not np.any(body.robot.damping):
        return None
    nq, nv = body.robot.nq, body.robot.nv
    if phase.dae.algebraic[:nv] != body.algebraic[:nv]:
        return None
    inverse = np.linalg.pinv(MotionEquations.of(phase).slopes(t, x, z, u, p))
    decay = np.zeros_like(x)
    decay[:, nq : nq + nv] = np.maximum(np.einsum("mii->mi", inverse[:, :nv, :nv]) * body.robot.damping, 0.0)
    return decay


def _rates(phase: Phase, t: Array, x: Array, z: Array, u: Array, p: Array) -> Array:
    """Evaluate f at samples with z solved from g = 0, (m, nx)."""
    equations = MotionEquations.of(phase)
    held = _held_block(phase)
    if z.shape[1]:
        for _ in range(NEWTON_STEPS):
            slopes, rows = equations.slopes(t, x, z, u, p), equations.rows(t, x, z, u, p)
            independent = None if held is None else _independent_rows(slopes, *held)
            change = _least_change(slopes, rows) if independent is None else _solved_least(independent, rows)
            z = z - change
            largest = np.abs(z).max(axis=0)
            if np.all(np.abs(change) <= SAME * np.maximum(largest, ROUNDING * largest.max())):
                break
    return equations.rates(t, x, z, u, p)


def _held_block(phase: Phase) -> tuple[int, int] | None:
    """Return nv, and nv plus the number of contact forces, of a robot by inverse dynamics whose contacts hold."""
    body = phase.body
    if not isinstance(body, InverseRigidBody) or not body.contacts or not all(c.holds for c in body.contacts):
        return None
    if phase.dae.algebraic[: len(body.algebraic)] != body.algebraic:
        return None
    return body.robot.nv, len(body.algebraic)


def _independent_rows(slopes: Array, nv: int, last: int) -> Array | None:
    """Remove nearly dependent rows from the contact Jacobians J in dg/dz = [[M, -J'], [J, 0]], (m, nz, nz).

    None where there are none. Legs that move in nearly parallel planes cannot change the distance of their feet across
    these planes. The error of that row, divided by its tiny singular value, would otherwise count as an acceleration.
    """
    left, sizes, _ = np.linalg.svd(slopes[:, nv:last, :nv], full_matrices=False)
    dependent = sizes <= DEPENDENT * sizes.max(axis=1, keepdims=True)
    if not dependent.any():
        return None
    kept = np.where(dependent[:, None, :], 0.0, left) @ left.transpose(0, 2, 1)
    slopes = slopes.copy()
    slopes[:, nv:last, :nv] = kept @ slopes[:, nv:last, :nv]
    slopes[:, :nv, nv:last] = slopes[:, :nv, nv:last] @ kept
    return slopes


def _least_change(slopes: Array, rows: Array) -> Array:
    """Solve slopes change = rows at every sample, (m, nz).

    Slack variables of an objective cause more unknowns than rows, and forces of redundant contacts singular rows. The
    solution is then the least change.
    """
    if slopes.shape[1] == slopes.shape[2]:
        try:
            change = np.linalg.solve(slopes, rows[:, :, None])
        except np.linalg.LinAlgError:
            pass
        else:
            left = np.abs(slopes @ change - rows[:, :, None])
            if np.max(left, initial=0.0) <= SAME * np.max(np.abs(rows), initial=1e-300):
                return np.asarray(change[:, :, 0])
    return _solved_least(slopes, rows)


def _solved_least(slopes: Array, rows: Array) -> Array:
    """Return the change of least norm that solves singular equations best, (m, nz)."""
    return np.asarray((np.linalg.pinv(slopes, rcond=ROUND_OFF) @ rows[:, :, None])[:, :, 0])
