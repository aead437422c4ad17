"""Division of a motion where bounds on its states become active or inactive: one phase of free duration per arc.

Where a state reaches a bound, the costate jumps, and controls or their rates jump. A polynomial on an interval
represents neither; the boundary between two phases represents both, and free durations move it to the right time.
Where a bound S(x) of order q is reached, its first q - 1 derivatives, which do not depend on controls, are zero:

    S(x) = 0,   dS/dt = 0,   ...,   d^(q-1) S/dt^(q-1) = 0   at the junctions.

Source: Bryson, Denham and Dreyfus, Optimal programming problems with inequality constraints I, AIAA Journal 1 (1963).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, require_solution
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.point import AnyPoint
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Variable
from robotraj.problem.constraints.base import AtEnd, AtStart
from robotraj.problem.constraints.path import PathConstraint
from robotraj.problem.initial_guess import Curve, InitialGuess, PhaseGuess
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.links.linkage import Linkage
from robotraj.problem.objectives.base import EndCost
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution

BOUND_TOLERANCE = 1e-3
"""Distance from a bound, relative to the range of the state over the motion, below which the state is at it."""
MIN_ARC_FRACTION = 0.02
"""Fraction of the duration below which a contact with a bound is a touch point, not an arc."""
SAMPLES = 2001
"""Number of times at which the motion is sampled."""
MIN_FACTOR, MAX_FACTOR = 0.2, 5.0
"""Bounds of the duration of an arc, relative to that in the given solution."""


@dataclass(frozen=True)
class BoundArc(OneLine):
    """A state at a bound from ``start`` to ``end`` [s]; ends inside the motion are junctions."""

    start: float
    end: float
    state: int
    bound: float


@dataclass(frozen=True)
class ArcGuess(InitialGuess):
    """A guess of every phase from its part of an earlier solution of one phase.

    Parameters
    ----------
    source : PhaseSolution
    times : sequence of float
        Ends of the parts [s], one more than parts.
    """

    source: PhaseSolution
    times: Sequence[float]

    def of(self, phase: Phase, index: int) -> PhaseGuess:
        """Sample part number ``index``."""
        first, last = self.times[index], self.times[index + 1]

        def sampled(variables: Sequence[Variable]) -> Curve:
            def curve(s: Array) -> Array:
                times = first + np.asarray(s) * (last - first)
                columns = self.source.columns(times, [v.name for v in variables])
                return np.column_stack(columns) if columns else np.zeros((len(times), 0))

            return curve

        dae = phase.dae
        states, algebraic, controls = (sampled(group) for group in (dae.states, dae.algebraic, dae.controls))
        return PhaseGuess(last - first, states, algebraic, controls, self.source.parameters)


def cut_at_junctions(solution: Solution) -> tuple[Problem, InitialGuess]:
    """Return a problem with one phase per arc of a motion's active state bounds, and the motion as its guess.

    Bounds of states are those of ``states=`` and joint limits on position and speed. Solve the problem on a few
    intervals per phase with a tight solver tolerance, since the objective is insensitive to the durations of the arcs.
    Use Radau IIA or Lobatto IIIA: Gauss-Legendre has no node at the knots, where the costate jumps::

        problem, guess = rt.indirect.cut_at_junctions(rt.plan(phase, tolerance=1e-6))
        rt.indirect.costates(rt.plan(problem, rt.Mesh(3, rt.schemes.RadauIIA(3)), guess, rt.Ipopt(1e-12)))

    Parameters
    ----------
    solution : Solution
        A converged solution of one phase.

    Returns
    -------
    Problem
        Phases joined by ``Continuity``. Their durations are free; the sum satisfies the bounds on the duration.
    InitialGuess

    Raises
    ------
    InputError
        Several phases, no arc at a bound of a state, or a phase that cannot be divided: with unknown parameters,
        integral constraints, or end costs other than ``Duration``.
    """
    require_solution(solution, "rt.indirect.cut_at_junctions")
    if len(solution.phases) != 1:
        raise InputError(f"cut_at_junctions takes a solution of one phase; this one has {len(solution.phases)}.")
    part = solution.phases[0]
    phase = solution.problem.phases[0]
    _refuse_indivisible(phase)
    bound_arcs = _bound_arcs(part)
    inside = part.t0 + MIN_ARC_FRACTION * part.duration, part.t0 + (1 - MIN_ARC_FRACTION) * part.duration
    junctions = [(time, arc) for arc in bound_arcs for time in (arc.start, arc.end) if inside[0] < time < inside[1]]
    if not junctions:
        raise InputError(
            f"Phase {phase.name!r} has no junction: no state bound becomes active or inactive inside the motion and is "
            f"active for more than {MIN_ARC_FRACTION:.0%} of it. Use the solution without dividing it."
        )
    junctions.sort(key=lambda pair: pair[0])
    times = [part.t0, *(time for time, _ in junctions), part.t0 + part.duration]
    phases = [_arc_phase(phase, part, i, times, junctions) for i in range(len(times) - 1)]
    last, (low, high) = len(phases) - 1, phase.duration_bounds
    whole = Linkage([0, last], lambda a, b: b.end.t - a.start.t, low, high, name=f"duration of {phase.name}", unit="s")
    return Problem(phases, [*(Continuity(i, i + 1) for i in range(last)), whole]), ArcGuess(part, tuple(times))


def _refuse_indivisible(phase: Phase) -> None:
    what = None
    if phase.parameter_names and not np.array_equal(*phase.parameter_bounds):
        what = "unknown parameters"
    if phase.rows.integrals:
        what = "an integral constraint"
    terms = phase.objective.terms if phase.objective else ()
    if any(isinstance(term, EndCost) and not isinstance(term, Duration) for _, term in terms):
        what = "a cost of its ends"
    if what:
        raise InputError(
            f"Phase {phase.name!r} has {what}, which cannot be divided among arcs; write one phase per arc."
        )


def _bound_arcs(part: PhaseSolution) -> list[BoundArc]:
    """Return the arcs at bounds of states, in the order of time."""
    times = np.linspace(part.t0, part.t0 + part.duration, SAMPLES)
    x = part.trajectory.x(times)
    reach = BOUND_TOLERANCE * np.maximum(np.ptp(x, axis=0), 1e-9)
    found = []
    for i, bound, _ in _state_bounds(part.phase):
        at = np.abs(x[:, i] - bound) < reach[i]
        edges = np.flatnonzero(np.diff(np.concatenate([[False], at, [False]])))
        for first, after in edges.reshape(-1, 2):
            if after - first > MIN_ARC_FRACTION * SAMPLES:
                found.append(BoundArc(float(times[first]), float(times[after - 1]), i, bound))
    return sorted(found, key=lambda arc: arc.start)


def _state_bounds(phase: Phase) -> list[tuple[int, float, Row]]:
    """Return the state's index, the bound and the row of every finite bound over the whole phase."""
    return [
        (state, bound, row)
        for row, state in phase.rows.bounds_of(phase.dae.states)
        for bound in (row.lower, row.upper)
        if np.isfinite(bound)
    ]


def _arc_phase(
    phase: Phase, part: PhaseSolution, i: int, times: Sequence[float], junctions: Sequence[tuple[float, BoundArc]]
) -> Phase:
    """Return the phase of arc i: only the first and last have end constraints; a junction ends the arc before it."""
    first, last = i == 0, i == len(times) - 2
    kept = [
        constraint
        for constraint in phase.constraints
        if (first or not isinstance(constraint, AtStart)) and (last or not isinstance(constraint, AtEnd))
    ]
    if not last:
        kept += _junction(part.phase, junctions[i][1])
    duration = times[i + 1] - times[i]
    return replace(
        phase,
        duration=(MIN_FACTOR * duration, MAX_FACTOR * duration),
        start=phase.start if first else None,
        end=phase.end if last else None,
        constraints=kept,
        name=f"{phase.name}, arc {i + 1}",
    )


def _junction(phase: Phase, arc: BoundArc) -> list[AtEnd]:
    """Return the rows at the end: the bound and its derivatives that do not depend on controls."""
    dae, names = phase.dae, phase.parameter_names
    sizes = (1, len(dae.states), len(dae.algebraic), len(dae.controls), len(names))
    t, x, z, u, p = [ca.SX.sym(n, size) for n, size in zip("txzup", sizes, strict=True)]
    rates = dae.rates(dae.point(t, x, z, u, p, names))
    value = x[arc.state] - arc.bound
    rows: list[ca.SX] = []
    while len(rows) < len(dae.states) and not ca.depends_on(value, ca.vertcat(z, u)):
        rows.append(value)
        value = ca.jacobian(value, x) @ rates + ca.jacobian(value, t)
    function = ca.Function("junction", [t, x, p], [ca.vertcat(*rows)])
    states = [state.name for state in dae.states]

    def expression(point: AnyPoint) -> ca.SX:
        at = ca.vertcat(*(point.x[name] for name in states)), ca.vertcat(*(point.p[name] for name in names))
        return function(point.t, *at)

    label = dae.states[arc.state].name
    return [AtEnd(PathConstraint(expression, [0.0] * len(rows), [0.0] * len(rows), f"junction of {label}"))]
