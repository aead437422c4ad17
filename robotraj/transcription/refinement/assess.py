"""Assessment of a mesh by the solution on it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import basis
from robotraj._util.precision import SAME
from robotraj.dynamics.path_body import ACCELERATION, SPEED
from robotraj.robot.size.state_sizes import WINDOWS, error_window
from robotraj.transcription.driven_motion import inputs_of, is_driven
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.refinement.base import Assessment
from robotraj.transcription.refinement.error import interval_errors, residuals_of, sizes_of
from robotraj.transcription.refinement.integrals import integral_errors
from robotraj.transcription.refinement.path_violations import beyond_limits, broken_rows
from robotraj.transcription.refinement.simulation_errors import errors_of_simulations, errors_of_windows
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.transcription.extract import PhaseTrajectory

LASTING = 20.0
"""Number of intervals for which a missing s'' lasts, chosen so that the loss is not underestimated."""


def assess(phase: Phase, trajectory: PhaseTrajectory, mesh: Mesh, settled: bool) -> Assessment:
    """Assess every interval of a phase; jumps of the control at moving knots are ignored."""
    moving = isinstance(mesh, MovingMesh)
    inputs = None if is_exact(phase, mesh.given) else inputs_of(phase, trajectory, mesh.schemes)
    errors = np.maximum(interval_errors(phase, trajectory, inputs), integral_errors(phase, trajectory, mesh.schemes))
    if phase.path is not None:
        # Relative to the duration, and to the share of an interval.
        errors = np.maximum(errors, len(errors) * path_bends(phase, trajectory) / trajectory.duration)
    broken = broken_rows(phase, trajectory)
    if is_driven(phase, mesh.schemes):
        # Bernstein bounds hold for the polynomials of torques, not for the torques of the equations of motion.
        broken = np.maximum(broken, beyond_limits(phase, trajectory, inputs_of(phase, trajectory, mesh.schemes)))
    return Assessment(
        errors,
        control_jumps(trajectory, moving),
        _decays(trajectory),
        broken,
        settled,
        _coarse(trajectory, moving),
    )


def errors_of(
    phase: Phase,
    trajectory: PhaseTrajectory,
    mesh: Mesh,
    whole: float | None = None,
    alike: Sequence[PhaseTrajectory] = (),
) -> Array:
    """Relative error of every interval, of its states or of an integral constraint, (K,).

    States of an exact motion have none: its torques follow from inverse dynamics (``transcription.exact_motion``).
    With the duration ``whole`` of the whole motion [s], they count as a simulation shows them too
    (``simulation_errors``). The sizes of the states are those of the trajectories of all phases that are ``alike``.
    """
    of_integrals = integral_errors(phase, trajectory, mesh.schemes)
    if is_exact(phase, mesh.given):
        return of_integrals
    residuals = residuals_of(phase, trajectory, inputs_of(phase, trajectory, mesh.schemes))
    sizes = sizes_of(phase, alike or [trajectory])
    errors = np.maximum(interval_errors(phase, trajectory, residuals=residuals, sizes=sizes), of_integrals)
    if whole is None or phase.path is not None:
        return errors
    if phase.robot is None:
        return np.maximum(errors, errors_of_windows(trajectory, residuals, whole / WINDOWS, sizes))
    nq, nv = phase.robot.nq, phase.robot.nv
    window = error_window(phase.robot)
    return np.maximum(errors, errors_of_simulations(trajectory, residuals, window, sizes, slice(nq, nq + nv)))


def control_jumps(trajectory: PhaseTrajectory, moving: bool = False) -> Array:
    """Return the largest change of a control in every interval or at its ends, relative to its range, (K,).

    Jumps at moving knots are ignored, since these knots follow the switches.
    """
    values = trajectory.u.values
    every = np.vstack(list(values))
    if not every.shape[1]:
        return np.zeros(len(values))
    span = np.ptp(every, axis=0)
    span = np.where(span > 0, span, 1.0)
    inside = np.array([np.max(np.ptp(value, axis=0) / span) for value in values])
    if moving:
        return inside
    # A switch may also stand between the last node of one interval and the first of the next.
    ends = np.array([np.max(np.abs(b[0] - a[-1]) / span) for a, b in zip(values[:-1], values[1:], strict=True)])
    return np.maximum(inside, np.maximum(np.append(ends, 0.0), np.append(0.0, ends)))


def _coarse(trajectory: PhaseTrajectory, moving: bool) -> Array:
    """Return duration times squared difference of the controls from those extrapolated from neighbours (K,).

    The difference is relative to the range of the control over the phase. For constants it is the step, for lines the
    kink. Steps at moving knots are ignored.
    """
    values, sites, lengths = trajectory.u.values, trajectory.u.sites, np.diff(trajectory.u.breaks)
    missed = np.zeros(len(values))
    if moving or not values[0].shape[1]:
        return missed
    span = np.ptp(np.vstack(list(values)), axis=0)
    span = np.where(span > 0, span, 1.0)
    middles = 0.5 * (trajectory.u.breaks[:-1] + trajectory.u.breaks[1:])
    own = np.array([basis(at, np.array([0.5]))[0] @ value for at, value in zip(sites, values, strict=True)])
    for k in range(len(values) - 1):
        for here, there in ((k, k + 1), (k + 1, k)):
            tau = np.array([0.5 + (middles[there] - middles[here]) / lengths[here]])
            carried = basis(sites[here], tau)[0] @ values[here]
            missed[there] = max(missed[there], np.max(np.abs(carried - own[there]) / span))
    return np.asarray(lengths * missed**2)


def _decays(trajectory: PhaseTrajectory) -> Array:
    """Return the least decay -d log10 |c_n| / dn of the Legendre coefficients of the states (K,)."""
    decays = []
    # Values below this share of the largest one in the phase are rounding.
    least = SAME * np.abs(np.vstack(list(trajectory.x.values))).max(axis=0)
    for sites, values in zip(trajectory.x.sites, trajectory.x.values, strict=True):
        degree = len(sites) - 1
        coefficients = np.abs(np.polynomial.legendre.legfit(2 * sites - 1, values, degree))
        scale = np.maximum(np.abs(values).max(axis=0), least)
        # Coefficients below round-off do not measure smoothness.
        with np.errstate(divide="ignore", invalid="ignore"):
            logs = np.log10(np.maximum(np.nan_to_num(coefficients / scale), 1e-14))
        slopes = np.polyfit(np.arange(1, degree + 1), logs[1:], 1)[0] if degree > 1 else logs[1] - logs[0]
        moving = coefficients[1:].max(axis=0) > 1e-10 * scale
        decays.append(float(np.min(-slopes[moving], initial=np.inf)))
    return np.array(decays)


def path_bends(phase: Phase, trajectory: PhaseTrajectory) -> Array:
    """Return the time lost on every interval [s], (K,)."""
    lengths, count = np.diff(trajectory.x.breaks), len(trajectory.x.values)
    ends = trajectory.u.inside(np.array([0.0, 1.0]))[:, :, 0]
    slopes = (ends[:, 1] - ends[:, 0]) / lengths
    bends = np.zeros(count + 1)
    bends[1:-1] = np.abs(np.diff(slopes))
    states = [state.name for state in phase.dae.states]
    speed = states.index(SPEED)
    fastest = np.abs(trajectory.x.inside(np.array([0.0, 1.0]))[:, :, speed]).max(axis=1)
    missed = LASTING * lengths if ACCELERATION in states else 1.0
    return missed * lengths**3 * (bends[1:] + bends[:-1]) / (32.0 * np.maximum(fastest, np.finfo(float).tiny))
