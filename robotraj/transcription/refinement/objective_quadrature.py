"""Error of the objective's integrals: the sum at the nodes against the integral along the motion.

A scheme sums the integrand l at its nodes, h sum_j b_j l(t_j). Its error on an interval,

    error = h sum_j b_j l(t_j) - integral l dt,

with the integral by Gauss's rule along the motion, is the distance of the objective from the cost of the motion.

Variables that a term has added, such as the slack of an absolute value, have their least values here. The solver
minimises the sum with its own values. They are larger by its barrier, and by the shape of the control they are part of.
"""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import gauss
from robotraj.problem.objectives.base import Integral
from robotraj.problem.phase import Phase
from robotraj.problem.rows import phase_symbols
from robotraj.transcription.driven_motion import Inputs, PlannedInputs
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.schemes.collocation import Collocation, Scheme
from robotraj.transcription.smoothness.alternation import alternation_cost
from robotraj.transcription.smoothness.smoothing import smoothing_weights

MORE = 3
"""Number of points of Gauss's rule beyond those of the scheme."""


def quadrature_errors(phase: Phase, trajectory: PhaseTrajectory, schemes: Sequence[Scheme], inputs: Inputs) -> Array:
    """Return the error of the objective's integral on every interval, in its unit, (K,); 0 without nodes.

    Parameters
    ----------
    phase : Phase
    trajectory : PhaseTrajectory
    schemes : sequence of Scheme
        Schemes of the intervals.
    inputs : Inputs
        Inputs along the motion, for the integral. The sum has those of the collocated polynomials.
    """
    errors = np.zeros(len(schemes))
    rate = rate_of(phase, of_motion=True)
    if rate is None:
        return errors
    for scheme, which in _groups(schemes):
        points, weights = gauss(len(scheme.nodes) + MORE)
        fine = 0.5 * (points + 1.0)
        places = np.concatenate([scheme.nodes, fine])
        x, z, u = (np.array(curve.inside(places)[which]) for curve in (trajectory.x, trajectory.z, trajectory.u))
        if not isinstance(inputs, PlannedInputs):
            z[:, len(scheme.nodes) :], u[:, len(scheme.nodes) :] = (each[which] for each in inputs.inside(fine))
        lengths, values = _values(rate, trajectory, which, places, (x, z, u))
        errors[which] = lengths * (values @ np.concatenate([scheme.objective_weights, -0.5 * weights]))
    return errors


def surplus(phase: Phase, trajectory: PhaseTrajectory, schemes: Sequence[Scheme]) -> float:
    """Return what the variables added by the objective add to its sum at the nodes beyond their least values."""
    if not any(_has_variables(term) for _, term in _integrals(phase)):
        return 0.0
    summed, least = rate_of(phase), rate_of(phase, of_motion=True)
    assert summed is not None and least is not None
    total = 0.0
    for scheme, which in _groups(schemes):
        curves = tuple(curve.inside(scheme.nodes)[which] for curve in (trajectory.x, trajectory.z, trajectory.u))
        lengths, values = _values(summed, trajectory, which, scheme.nodes, curves)
        values = values - _values(least, trajectory, which, scheme.nodes, curves)[1]
        total += float(lengths @ (values @ scheme.objective_weights))
    return total


def smoothing_cost(phase: Phase, trajectory: PhaseTrajectory, schemes: Sequence[Scheme], smoothing: float) -> float:
    """Return what ``transcription.smoothness`` adds to the sum at the nodes."""
    alternating = alternation_cost(phase, trajectory, schemes, smoothing)
    return squares_cost(phase, trajectory, schemes, smoothing) + alternating


def squares_cost(phase: Phase, trajectory: PhaseTrajectory, schemes: Sequence[Scheme], smoothing: float) -> float:
    """Return what ``smoothness.smoothing`` adds to the sum at the nodes."""
    weights = smoothing_weights(phase, smoothing)
    if not any(each.any() for each in weights):
        return 0.0
    total, lengths = 0.0, np.diff(trajectory.x.breaks)
    for scheme, which in _groups(schemes):
        curves = (curve.inside(scheme.nodes)[which] for curve in (trajectory.z, trajectory.u))
        rates = sum(values**2 @ own for values, own in zip(curves, weights, strict=True))
        total += float(lengths[which] @ (rates @ scheme.objective_weights))
    return total


def _groups(schemes: Sequence[Scheme]) -> list[tuple[Collocation, list[int]]]:
    """Return the intervals of every collocation scheme."""
    groups: dict[Scheme, list[int]] = {}
    for k, scheme in enumerate(schemes):
        groups.setdefault(scheme, []).append(k)
    return [(scheme, which) for scheme, which in groups.items() if isinstance(scheme, Collocation)]


def _values(
    rate: ca.Function, trajectory: PhaseTrajectory, which: list[int], places: Array, curves: Sequence[Array]
) -> tuple[Array, Array]:
    """Return the lengths of intervals, (K,), and the integrand at places inside them, (K, m)."""
    breaks = trajectory.x.breaks
    lengths = breaks[np.array(which) + 1] - breaks[which]
    times = breaks[which][:, None] + lengths[:, None] * places
    count = times.size
    parameters = np.tile(np.array(list(trajectory.parameters.values()), dtype=float)[:, None], count)
    columns = (value.reshape(count, -1).T for value in curves)
    return lengths, np.array(rate.map(count)(times.reshape(1, -1), *columns, parameters)).reshape(times.shape)


_RATES: WeakKeyDictionary[Phase, dict[bool, ca.Function | None]] = WeakKeyDictionary()


def rate_of(phase: Phase, of_motion: bool = False) -> ca.Function | None:
    """Return the integrand of the objective, a function of (t, x, z, u, p); None without an integral.

    The integrand ``of_motion`` has the least values of variables that the objective has added.
    """
    known = _RATES.setdefault(phase, {})
    own = of_motion and any(_has_variables(term) for _, term in _integrals(phase))
    if own not in known:
        known[own] = _new_rate(phase, own)
    return known[own]


def _integrals(phase: Phase) -> list[tuple[float, Integral]]:
    terms = [] if phase.objective is None else phase.objective.terms
    return [(weight, term) for weight, term in terms if isinstance(term, Integral)]


def _has_variables(term: Integral) -> bool:
    """Whether a term's integrand of the motion alone is another one."""
    return type(term).rate_of_motion is not Integral.rate_of_motion


def _new_rate(phase: Phase, of_motion: bool) -> ca.Function | None:
    integrals = _integrals(phase)
    if not integrals:
        return None
    dae = phase.dae
    symbols = phase_symbols(dae, phase.parameter_names)
    point = dae.point(*symbols, phase.parameter_names)
    rates = (weight * (term.rate_of_motion(point) if of_motion else term.rate(point)) for weight, term in integrals)
    return ca.Function("rate", list(symbols), [ca.densify(ca.SX(sum(rates, ca.SX(0))))])
