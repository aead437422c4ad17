"""The stated objective against the cost of the planned motion.

The terms' own expressions are integrated by Gauss and Legendre's rule, and evaluated at both ends. The sum at the
collocation points, which the solver minimises, has no part in it.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.point import AnyPoint
from robotraj.problem.objectives.base import Integral
from robotraj.problem.phase import Phase
from robotraj.problem.rows import phase_symbols
from robotraj.solution.claims.objective_size import objective_size
from robotraj.witness.plants.system_plant import arguments
from robotraj.witness.protocols import PhaseSolutionLike, SolutionLike
from robotraj.witness.sampling import interval_samples

POINTS = 6
"""Points of an interval, exact for integrands of degree 11."""


@dataclass(frozen=True)
class ObjectiveCheck(OneLine):
    """The stated objective and the cost of the motion.

    Attributes
    ----------
    stated : float
        ``solution.objective``.
    of_motion : float
        The sum of integrals along the motion and of end costs.
    size : float
        The sum of the absolute values of all terms, since terms may cancel, at least that of ``objective_size``.
    """

    stated: float
    of_motion: float
    size: float

    @property
    def relative(self) -> float:
        """|stated - of_motion| / size; 0 where both are 0."""
        off = abs(self.stated - self.of_motion)
        return off / self.size if self.size > 0.0 else (0.0 if off == 0.0 else np.inf)


def objective_check(solution: SolutionLike, clock: Callable[[], None] = lambda: None) -> ObjectiveCheck:
    """Return the cost of the motion beside the stated objective."""
    total = size = 0.0
    for planned in solution.phases:
        clock()
        for value, scale in _costs(planned):
            total, size = total + value, size + scale
    stated = float(solution.objective)
    return ObjectiveCheck(stated, total, max(size, objective_size(solution.phases, stated)))


def _costs(planned: PhaseSolutionLike) -> list[tuple[float, float]]:
    """Return the weighted value and the size of every term of a phase."""
    objective, phase = planned.phase.objective, planned.phase
    if objective is None:
        return []
    found: list[tuple[float, float]] = []
    integrals = [(weight, term) for weight, term in objective.terms if isinstance(term, Integral)]
    if integrals:
        symbols, point = _symbols(phase)
        rates = ca.vertcat(*(ca.SX(weight * term.rate_of_motion(point)) for weight, term in integrals))
        integrand = ca.Function("integrand", symbols, [ca.densify(rates)])
        sites, weights = np.polynomial.legendre.leggauss(POINTS)
        sums = np.zeros((2, len(integrals)))
        for part in interval_samples(planned, POINTS, 0.5 * (sites + 1.0)):
            given = arguments(planned, part.times, part.interval)
            values = np.array(integrand.map(len(part.times))(*given))
            share = np.repeat(0.5 * (part.ends - part.begins), POINTS) * np.tile(weights, len(part.intervals))
            sums += np.array([values @ share, np.abs(values) @ share])
        found += [(float(value), float(scale)) for value, scale in sums.T]
    ends = [(weight, term) for weight, term in objective.terms if not isinstance(term, Integral)]
    if ends:
        (first, start), (second, last) = _symbols(phase), _symbols(phase)
        costs = ca.vertcat(*(ca.SX(weight * term.value(start, last)) for weight, term in ends))
        knots = np.asarray(planned.knots, dtype=float)
        at_ends = [
            value
            for times, interval in ((knots[:1], 0), (knots[-1:], len(knots) - 2))
            for value in arguments(planned, times, interval)
        ]
        values = np.array(ca.Function("ends", [*first, *second], [ca.densify(costs)])(*at_ends)).ravel()
        found += [(float(value), abs(float(value))) for value in values]
    return found


def _symbols(phase: Phase) -> tuple[list[ca.SX], AnyPoint]:
    """Return symbols t, x, z, u, p of a phase, and its point of these symbols."""
    symbols = phase_symbols(phase.dae, phase.parameter_names)
    return list(symbols), phase.dae.point(*symbols, phase.parameter_names)
