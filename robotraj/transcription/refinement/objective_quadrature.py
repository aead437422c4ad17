"""Error of the objective's integrals: the sum that was minimised against the integral along the motion.

A scheme sums the integrand l at its nodes, h sum_j b_j l(t_j). Its error on an interval,

    error = h sum_j b_j l(t_j) - integral l dt,

with the integral by Gauss's rule along the motion, is the distance of the objective from the cost of the motion.
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.polynomials import gauss
from robotraj.problem.objectives.base import Integral
from robotraj.transcription.driven_motion import PlannedInputs
from robotraj.transcription.schemes.collocation import Collocation

if TYPE_CHECKING:
    from collections.abc import Sequence

    from robotraj.problem.phase import Phase
    from robotraj.transcription.driven_motion import Inputs
    from robotraj.transcription.extract import PhaseTrajectory
    from robotraj.transcription.schemes.collocation import Scheme

Array = NDArray[np.float64]

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
    rate = rate_of(phase)
    if rate is None:
        return errors
    breaks = trajectory.x.breaks
    groups: dict[Scheme, list[int]] = {}
    for k, scheme in enumerate(schemes):
        groups.setdefault(scheme, []).append(k)
    for scheme, which in groups.items():
        if not isinstance(scheme, Collocation):
            continue
        points, weights = gauss(len(scheme.nodes) + MORE)
        fine = 0.5 * (points + 1.0)
        places = np.concatenate([scheme.nodes, fine])
        x, z, u = (np.array(curve.inside(places)[which]) for curve in (trajectory.x, trajectory.z, trajectory.u))
        if not isinstance(inputs, PlannedInputs):
            z[:, len(scheme.nodes) :], u[:, len(scheme.nodes) :] = (each[which] for each in inputs.inside(fine))
        lengths = breaks[np.array(which) + 1] - breaks[which]
        times = breaks[which][:, None] + lengths[:, None] * places
        count = times.size
        parameters = np.tile(np.array(list(trajectory.parameters.values()), dtype=float)[:, None], count)
        columns = (value.reshape(count, -1).T for value in (x, z, u))
        values = np.array(rate.map(count)(times.reshape(1, -1), *columns, parameters)).reshape(times.shape)
        errors[which] = lengths * (values @ np.concatenate([scheme.objective_weights, -0.5 * weights]))
    return errors


_RATES: WeakKeyDictionary[Phase, ca.Function | None] = WeakKeyDictionary()


def rate_of(phase: Phase) -> ca.Function | None:
    """Return the integrand of the objective, a function of (t, x, z, u, p); None without an integral."""
    if phase not in _RATES:
        _RATES[phase] = _new_rate(phase)
    return _RATES[phase]


def _new_rate(phase: Phase) -> ca.Function | None:
    terms = [] if phase.objective is None else phase.objective.terms
    integrals = [(weight, term) for weight, term in terms if isinstance(term, Integral)]
    if not integrals:
        return None
    dae = phase.dae
    sizes = (1, len(dae.states), len(dae.algebraic), len(dae.controls), len(phase.parameter_names))
    symbols = [ca.SX.sym(name, size) for name, size in zip("txzup", sizes, strict=True)]
    t, x, z, u, p = symbols
    point = dae.point(t, x, z, u, p, phase.parameter_names)
    total = sum((weight * term.rate(point) for weight, term in integrals), ca.SX(0))
    return ca.Function("rate", symbols, [ca.densify(ca.SX(total))])
