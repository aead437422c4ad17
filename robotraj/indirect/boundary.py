"""Pontryagin's boundary value problem: arcs joined at switching times, with as many equations as unknowns.

The unknowns are the states and costates at every knot, the durations of the arcs and the multipliers pi of end
constraints. The boundary conditions are

    x = value, or lambda(t0) = -dPhi/dx(t0),      Phi = M + pi' psi (Mayer terms and end constraints)
    x = value, or lambda(tf) = +dPhi/dx(tf)
    tf = value, or H(tf) = -dPhi/dtf
    H_u_i = 0 where control i reaches or leaves a bound
    h(t0) = H(t0),   J(t0) = 0

Source: Bryson and Ho, Applied Optimal Control (1975), sections 2.7, 2.8 and 3.9.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.expression_values import as_rows
from robotraj.dynamics.point import AnyPoint
from robotraj.dynamics.row import Row
from robotraj.indirect.arcs import Arc, Side
from robotraj.indirect.pontryagin import Pontryagin, columns
from robotraj.problem.constraints.base import AtEnd, AtStart, Constraint, Where
from robotraj.problem.constraints.bounds import between
from robotraj.problem.constraints.path import PathConstraint
from robotraj.problem.links.base import BoundLink, Ends, Link
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import PhaseRow
from robotraj.problem.problem import Problem

ACTIVE_TOLERANCE = 1e-6
"""Distance from a bound at which an end constraint or the duration counts as active."""


@dataclass(frozen=True)
class Conditions(Link):
    """Boundary conditions between the start of the first arc and the end of the last, as rows that are zero."""

    arcs: int
    labels: tuple[str, ...]
    expression: Callable[[AnyPoint, AnyPoint], ca.SX]

    def bind(self, phases: Sequence[Phase]) -> BoundLink:
        """Return one row for each condition."""
        rows = tuple(Row("boundary condition", "", 0.0, 0.0, label) for label in self.labels)
        return BoundLink(
            "boundary conditions",
            (0, self.arcs - 1),
            rows,
            lambda ends, _: as_rows(self._values(ends), "conditions"),
        )

    def _values(self, ends: Sequence[Ends]) -> ca.SX:
        return self.expression(ends[0][0], ends[-1][1])


@dataclass(frozen=True, eq=False)
class EndData(OneLine):
    """Active conditions at the ends of the direct solution.

    Attributes
    ----------
    start, end : ndarray (nx,)
        Fixed states, NaN where free.
    time : float or None
        Fixed end time [s], None where free.
    constraints : tuple of (PhaseRow, float)
        Active rows at an end, each with its active bound.
    """

    start: Array
    end: Array
    time: float | None
    constraints: tuple[tuple[PhaseRow, float], ...]


def end_data(equations: Pontryagin, x0: Array, xf: Array, duration: float) -> EndData:
    """Return the end conditions that are active at a solution from 0 to ``duration``."""
    phase = equations.phase
    fixed = []
    for bounds, value in ((phase.start_bounds, x0), (phase.end_bounds, xf)):
        scale = 1.0 + np.abs(value)
        low = np.abs(value - bounds.lower) < ACTIVE_TOLERANCE * scale
        high = np.abs(value - bounds.upper) < ACTIVE_TOLERANCE * scale
        fixed.append(np.where(low, bounds.lower, np.where(high, bounds.upper, np.nan)))
    least, most = phase.duration_bounds
    time = next((b for b in (least, most) if abs(duration - b) < ACTIVE_TOLERANCE * (1.0 + duration)), None)
    active = []
    for row in phase.rows:
        if row.where in (Where.START, Where.END):
            state, t = (xf, duration) if row.where is Where.END else (x0, 0.0)
            found = _end_value(equations, row, t, state)
            active += [
                (row, b) for b in {row.lower, row.upper} if abs(found - b) < ACTIVE_TOLERANCE * (1.0 + abs(found))
            ]
    return EndData(fixed[0], fixed[1], time, tuple(active))


def _end_value(equations: Pontryagin, row: PhaseRow, t: float, state: Array) -> float:
    function = equations.phase.rows.function((row,))
    if any(function.jac_sparsity(0, i).nnz() for i in (2, 3)):
        raise InputError(
            f"{row.label!r} at an end depends on accelerations or controls; rt.indirect.polish supports end "
            "constraints on states and time only. Keep the direct solution."
        )
    free = (np.zeros(function.size1_in(i)) for i in (2, 3))
    return float(function(t, state, *free, equations.parameters))


def boundary_value_problem(equations: Pontryagin, arcs: Sequence[Arc], ends: EndData) -> Problem:
    """Return the problem of the arcs and their conditions, with as many rows as unknowns."""
    multipliers = {f"pi {i}": between(None, None) for i in range(len(ends.constraints))}
    phases = [
        Phase(
            equations.system(arc.sides),
            duration=between(0.0, None),
            constraints=_switching(equations, arcs, k),
            parameters=multipliers if k == len(arcs) - 1 else {},
            name=f"arc {k + 1}",
        )
        for k, arc in enumerate(arcs)
    ]
    links: list[Link] = [Continuity(k, k + 1) for k in range(len(arcs) - 1)]
    links.append(_conditions(equations, len(arcs), ends))
    return Problem(phases, links)


def _switching(equations: Pontryagin, arcs: Sequence[Arc], k: int) -> list[Constraint]:
    """Return H_u = 0 where a control changes sides, on the arc where it is at a bound, and h = H at the start."""
    sides = arcs[k].sides
    found: list[Constraint] = []
    if k == 0:
        value = equations.quantity("H", None, sides)
        found.append(AtStart(PathConstraint(lambda p: value(p) - p.x["hamiltonian"], 0.0, 0.0, "Hamiltonian")))
    if k > 0:
        found += [
            AtStart(PathConstraint(equations.quantity("by_u", i, sides), 0.0, 0.0, f"switching function {i}"))
            for i in _changed(arcs, k - 1)
            if arcs[k - 1].sides[i] is Side.INTERIOR
        ]
    if k < len(arcs) - 1:
        found += [
            AtEnd(PathConstraint(equations.quantity("by_u", i, sides), 0.0, 0.0, f"switching function {i}"))
            for i in _changed(arcs, k)
            if sides[i] is not Side.INTERIOR
        ]
    return found


def _changed(arcs: Sequence[Arc], k: int) -> list[int]:
    """Return the indices of controls that change sides between arcs k and k + 1."""
    return [i for i, (a, b) in enumerate(zip(arcs[k].sides, arcs[k + 1].sides, strict=True)) if a is not b]


def _conditions(equations: Pontryagin, count: int, ends: EndData) -> Conditions:
    """Return the boundary conditions of states, costates and time."""
    nx = equations.nx
    phi, symbols = potential(equations, ends)
    gradients = [ca.densify(ca.gradient(phi, symbols[name])) for name in ("x0", "xf", "tf")]
    function = ca.Function("potential", list(symbols.values()), gradients)
    labels = [f"start of {s.name}" for s in equations.phase.dae.states]
    labels += [f"end of {s.name}" for s in equations.phase.dae.states]
    labels += [
        "end time",
        "cost at the start",
        *(f"end constraint {i}" for i in range(len(ends.constraints))),
    ]
    rows = _active_rows(equations, ends, symbols)
    active = ca.Function("active", list(symbols.values()), [ca.densify(rows)])

    def expression(start: AnyPoint, end: AnyPoint) -> ca.SX:
        y0, yf = (columns(point.x, equations.state_names) for point in (start, end))
        pi = columns(end.p, [f"pi {i}" for i in range(len(ends.constraints))])
        arguments = (start.t, y0[:nx], end.t, yf[:nx], pi)
        by_x0, by_xf, by_tf = function(*arguments)
        rows = [y0[i] - ends.start[i] if np.isfinite(ends.start[i]) else y0[nx + i] + by_x0[i] for i in range(nx)]
        rows += [yf[i] - ends.end[i] if np.isfinite(ends.end[i]) else yf[nx + i] - by_xf[i] for i in range(nx)]
        rows.append(end.x["hamiltonian"] + by_tf if ends.time is None else end.t - ends.time)
        rows.append(start.x["cost"])
        return ca.vertcat(*rows, active(*arguments))

    return Conditions(count, tuple(labels), expression)


def potential(equations: Pontryagin, ends: EndData) -> tuple[ca.SX, dict[str, ca.SX]]:
    """Return Phi = M + pi' psi as an expression, and its arguments t0, x0, tf, xf, pi."""
    nx, phase = equations.nx, equations.phase
    symbols = {name: ca.SX.sym(name, n) for name, n in (("t0", 1), ("x0", nx), ("tf", 1), ("xf", nx))}
    symbols["pi"] = ca.SX.sym("pi", len(ends.constraints))
    p = ca.SX(ca.DM(equations.parameters))
    start, end = (
        phase.dae.point(symbols[t], symbols[x], None, None, p, phase.parameter_names)
        for t, x in (("t0", "x0"), ("tf", "xf"))
    )
    phi = ca.SX(0)
    for weight, term in phase.end_costs:
        phi += weight * as_rows(term.value(start, end), "Mayer expression")[0]
    return phi + ca.dot(symbols["pi"], _active_rows(equations, ends, symbols)), symbols


def _active_rows(equations: Pontryagin, ends: EndData, symbols: dict[str, ca.SX]) -> ca.SX:
    """Return the active end constraints psi minus their bounds."""
    dae, names = equations.phase.dae, equations.phase.parameter_names
    p = ca.SX(ca.DM(equations.parameters))
    rows = []
    for row, bound in ends.constraints:
        t, x = (symbols["tf"], symbols["xf"]) if row.where is Where.END else (symbols["t0"], symbols["x0"])
        z, u = ca.SX.zeros(len(dae.algebraic)), ca.SX.zeros(len(dae.controls))
        point = dae.point(t, x, z, u, p, names)
        rows.append(equations.phase.rows.values((row,), point)[0] - bound)
    return ca.vertcat(*rows) if rows else ca.SX(0, 1)
