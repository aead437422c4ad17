"""Ends of phases that no configuration satisfies: poses out of reach, footholds, mirror images, clearances.

Every motion has a configuration at both ends of every phase. It satisfies the rows of the phase that depend on
positions alone, the contacts that are held and the links. Between the ends no joint moves faster than its speed limit.
These conditions are necessary and few. Every row is relaxed by slacks s >= 0,

    minimise  sum_i w_i s_i    subject to  l_i - c_i s_i <= h_i(q_0, q_1, T, p) <= u_i + c_i s_i,

from several seeded starts. Where the least sum is zero, configurations exist; else rows with slacks must give, and rows
with multipliers conflict with them.
Source: Gill, Murray and Saunders, SNOPT, SIAM Review 47 (2005), section 4.4 (elastic mode).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.dynamics.point import Point
from robotraj.guess.ends import default_parameters, ends_of, guessed_duration
from robotraj.problem.constraints.base import Where
from robotraj.problem.links.base import Ends
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits
from robotraj.robot.root import QUATERNION
from robotraj.solution.conflict import Conflict

Array = NDArray[np.float64]

REACHED = 1e-5
"""Slacks relative to the scale of their row that count as zero."""
STARTS, STARTS_MOVING = 12, 3
"""Seeded starts for robots with a fixed root and systems, and for those with a moving root."""
ITERATIONS = 150
"""Of the solver, from one start."""
SHORTEST = 1e-3
"""Least duration of a phase [s], which keeps mean speeds finite."""
NEARNESS = 1e-6
"""Weight of the squared distance from the start, which makes the minimum unique."""
ENDS, HELD, GIVEN = 20.0, 5.0, 1.0
"""Weights of slacks: states that the user gave at an end; contacts, links and frames at an end; limits."""
SMALL = 1e-2
"""Slacks relative to the scale of their row that the reweighted sum counts fully."""
BINDING = 2e-2
"""Multipliers relative to the largest one above which a row takes part in a conflict."""
NAMED = 3
"""Rows named as the other side of a conflict."""


@dataclass(frozen=True, eq=False)
class _EndRow:
    """A row of the relaxed problem: value, bounds, and how it is named."""

    value: ca.SX
    lower: float
    upper: float
    phase: str
    name: str
    unit: str
    time: ca.SX
    weight: float
    physical: bool = False

    @property
    def scale(self) -> float:
        """Unit of the slack: the larger finite bound, else 1, in ``unit``."""
        return max((abs(b) for b in (self.lower, self.upper) if np.isfinite(b) and b), default=1.0)


@dataclass(frozen=True, eq=False)
class _Ends:
    """Symbols of the two ends of a phase, and the points of them."""

    phase: Phase
    first: ca.SX
    last: ca.SX
    begun: ca.SX
    duration: ca.SX
    parameters: ca.SX
    start: Point
    end: Point

    @property
    def unknowns(self) -> list[ca.SX]:
        """Positions at both ends, time of the start, duration and parameters."""
        size = _size(self.phase)
        known = self.begun if self.begun.is_symbolic() else ca.SX(0, 1)
        return [self.first[:size], self.last[:size], known, self.duration, self.parameters]


def unreached_ends(problem: Problem) -> tuple[Conflict, ...]:
    """Return the rows that must give for configurations at the ends of all phases to exist, largest slack first.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    tuple of Conflict
        Empty where such configurations were found, and where the ends are fixed and nothing else reads them.
    """
    ends = _all_ends(problem.phases)
    rows = [row for each in ends for row in _rows_of(each)]
    links = list(_rows_of_links(problem, ends))
    if not links and not any(row.weight == HELD or not row.physical for row in rows):
        return ()
    unknown = ca.vertcat(*(symbol for each in ends for symbol in each.unknowns))
    rows = [row for row in (*rows, *links) if _reads_only(row.value, unknown)]
    rows = [row for row in rows if ca.depends_on(row.value, unknown)]
    return _least_slacks(problem, rows, unknown) if rows else ()


def _size(phase: Phase) -> int:
    """Return how many states are positions; all states of a System."""
    return phase.robot.nq if phase.robot is not None else len(phase.body.states)


def _all_ends(phases: Sequence[Phase]) -> list[_Ends]:
    found = []
    for i, phase in enumerate(phases):
        begun = ca.SX.sym(f"t{i}") if i else ca.SX(0)
        body, names = phase.body, phase.parameter_names
        first, last = (ca.SX.sym(f"{which}{i}", len(body.states)) for which in ("first", "last"))
        duration, p = ca.SX.sym(f"T{i}"), ca.SX.sym(f"p{i}", len(names))
        start = body.point(begun, first, None, None, p, names)
        end = body.point(begun + duration, last, None, None, p, names)
        found.append(_Ends(phase, first, last, begun, duration, p, start, end))
    return found


def _rows_of(ends: _Ends) -> Iterator[_EndRow]:
    """Yield the rows of one phase: limits, what the user gave, contacts, mean speeds."""
    phase, size = ends.phase, _size(ends.phase)
    table, states = phase.rows, [state.name for state in phase.body.states]
    # A kinematic plan has the same symbols among its algebraic variables and its controls.
    inner = ca.vertcat(ca.SX(0, 1), *ca.symvar(ca.vertcat(*table.point.z.values(), *table.point.u.values())))
    groups = (table.path, table.at(Where.START), table.at(Where.END))
    read = [row for group in groups for row in group if not ca.depends_on(table.expressions((row,))[0], inner)]
    sides = (
        (Where.START, ends.start, ends.first, ends.begun, phase.start_bounds),
        (Where.END, ends.end, ends.last, ends.begun + ends.duration, phase.end_bounds),
    )
    for where, point, x, t, given in sides:
        for row in table.bounds:
            if row.variable in states[:size] and row.where in (Where.THROUGHOUT, where):
                value = x[states.index(str(row.variable))]
                yield _EndRow(value, row.lower, row.upper, phase.name, row.label, row.unit, t, GIVEN, True)
        for variable, value, low, high in zip(phase.body.states[:size], ca.vertsplit(x[:size]), *given, strict=False):
            label = f"{where.value} {variable.quantity}, {variable.label}"
            yield _EndRow(value, low, high, phase.name, label, variable.unit, t, ENDS, True)
        here = [row for row in read if row.where in (Where.THROUGHOUT, where)]
        values = _values(ends, here, x, t)
        for row, value in zip(here, values, strict=True):
            weight = GIVEN if row.where is Where.THROUGHOUT else HELD
            yield _EndRow(value, row.lower, row.upper, phase.name, row.label, row.unit, t, weight)
        held = phase.body.invariant(point) if phase.body.invariants else ca.SX(0, 1)
        for variable, value in zip(phase.body.invariants, ca.vertsplit(held), strict=True):
            label = f"{variable.quantity}, {variable.label}"
            yield _EndRow(value, 0.0, 0.0, phase.name, label, variable.unit, t, HELD)
    middle = ends.begun + 0.5 * ends.duration
    for name, value, low, high in zip(
        phase.parameter_names, ca.vertsplit(ends.parameters), *phase.parameter_bounds, strict=True
    ):
        yield _EndRow(value, low, high, phase.name, f"parameter {name}", "", middle, GIVEN, True)
    least, longest = phase.duration_bounds
    yield _EndRow(ends.duration, max(least, SHORTEST), longest, phase.name, "duration", "s", ends.duration, GIVEN, True)
    yield from _mean_speeds(ends)


def _values(ends: _Ends, rows: Sequence[object], x: ca.SX, t: ca.SX) -> list[ca.SX]:
    """Return the expressions of rows of the state at one end."""
    table = ends.phase.rows
    if not rows:
        return []
    column = ca.vertcat(*table.expressions(tuple(rows)))  # type: ignore[arg-type]
    symbols = table.symbols
    extra = symbols[1].numel() - x.numel()
    state = ca.vertcat(x, ca.SX.sym("added", extra)) if extra else x
    return list(
        ca.vertsplit(ca.substitute([column], [symbols[0], symbols[1], symbols[4]], [t, state, ends.parameters])[0])
    )


def _mean_speeds(ends: _Ends) -> Iterator[_EndRow]:
    """Yield (q_1 - q_0) / T within the speed limits, for joints with one position."""
    phase, robot = ends.phase, ends.phase.robot
    if robot is None or not isinstance(phase.limits, Limits):
        return
    positions = list(robot.position_names)
    for joint, unit, limit in zip(robot.velocity_names, robot.units, phase.limits.velocity, strict=True):
        if joint in positions and np.isfinite(limit):
            i = positions.index(joint)
            mean = (ends.last[i] - ends.first[i]) / ends.duration
            half = ends.begun + 0.5 * ends.duration
            yield _EndRow(mean, -limit, limit, phase.name, f"velocity limit, {joint}", f"{unit}/s", half, GIVEN, True)


def _rows_of_links(problem: Problem, ends: Sequence[_Ends]) -> Iterator[_EndRow]:
    for link in problem.bound_links:
        own = {unknown.name: ca.SX.sym(unknown.name) for unknown in link.unknowns}
        values = link.values([Ends(ends[i].start, ends[i].end) for i in link.phases], own)
        at = ends[link.phases[0]]
        for row, value in zip(link.rows, values, strict=True):
            name = f"{row.label} of {link.name}"
            yield _EndRow(value, row.lower, row.upper, at.phase.name, name, row.unit, at.begun + at.duration, HELD)


def _reads_only(value: ca.SX, unknown: ca.SX) -> bool:
    """Whether a value depends on positions, durations and parameters alone, not on speeds or impulses."""
    known = {symbol.name() + str(symbol.__hash__()) for symbol in ca.vertsplit(unknown)}
    return all(symbol.name() + str(symbol.__hash__()) in known for symbol in ca.symvar(value))


def _least_slacks(problem: Problem, rows: Sequence[_EndRow], unknown: ca.SX) -> tuple[Conflict, ...]:
    """Minimise the slacks from one start after the other, and describe the least sum."""
    sides = [
        (i, sign, bound)
        for i, row in enumerate(rows)
        for sign, bound in ((1.0, row.lower), (-1.0, row.upper))
        if np.isfinite(bound)
    ]
    slack, near, weight = (ca.SX.sym(*each) for each in (("s", len(sides)), ("y", unknown.numel()), ("w", len(sides))))
    scaled = [sign * (rows[i].value - bound) / rows[i].scale for i, sign, bound in sides]
    weights = np.array([rows[i].weight for i, *_ in sides])
    cost = ca.dot(weight, slack) + NEARNESS * ca.sumsqr(unknown - near)
    options = {"tol": 1e-8, "max_iter": ITERATIONS, "print_level": 0, "sb": "yes"}
    solver = ca.nlpsol(
        "ends",
        "ipopt",
        {"x": ca.vertcat(unknown, slack), "p": ca.vertcat(near, weight), "f": cost, "g": ca.vertcat(*scaled) + slack},
        {"ipopt": options, "print_time": False, "error_on_fail": False, "show_eval_warnings": False},
    )
    values = ca.Function("values", [unknown], [ca.vertcat(*scaled)])
    free = unknown.numel()
    bounds = {"lbx": np.append(np.full(free, -np.inf), np.zeros(len(sides))), "ubx": np.inf, "lbg": 0.0, "ubg": np.inf}

    def solved(start: Array, weights: Array) -> tuple[float, Array, Array, Array]:
        first = np.maximum(0.0, -np.array(values(start)).ravel())
        guess = np.append(start, np.where(np.isfinite(first), first, 1.0))
        found = solver(x0=guess, p=np.append(start, weights), **bounds)
        place = np.array(found["x"]).ravel()[:free]
        left = np.maximum(0.0, -np.array(values(place)).ravel())
        total = float(weights @ left) if np.all(np.isfinite(left)) else np.inf
        return total, place, left, np.abs(np.array(found["lam_g"]).ravel())

    best: tuple[float, Array, Array, Array] | None = None
    for start in _starts(problem):
        found = solved(start, weights)
        if found[0] < REACHED:
            return ()
        if best is None or found[0] < best[0]:
            best = found
    if best is None or not np.isfinite(best[0]):
        return ()
    _, place, left, multipliers = best
    if np.sum(left > REACHED) > 1:
        # Reweighted, the sum counts slacks instead of adding them up.
        again = solved(place, weights / (left + SMALL) * SMALL)
        if np.sum(again[2] > REACHED) < np.sum(left > REACHED):
            _, place, left, multipliers = again
    times = np.array(ca.Function("times", [unknown], [ca.vertcat(*(row.time for row in rows))])(place)).ravel()
    return _conflicts(rows, sides, left, multipliers, times)


def _conflicts(
    rows: Sequence[_EndRow],
    sides: Sequence[tuple[int, float, float]],
    left: Array,
    multipliers: Array,
    times: Array,
) -> tuple[Conflict, ...]:
    """Describe rows with slacks, and the rows that they conflict with."""
    giving = [k for k in np.argsort(-left) if left[k] > REACHED]
    binding = [k for k in np.argsort(-multipliers) if multipliers[k] > BINDING * multipliers.max() and k not in giving]
    named = [rows[sides[k][0]] for k in binding if rows[sides[k][0]].name != "duration"]
    # States that the user fixed are named where nothing else conflicts.
    named = [row for row in named if row.weight != ENDS] or named
    others = list(dict.fromkeys(row.name for row in named))[:NAMED]
    reason = f"against {', '.join(others)}" if others else ""
    found = []
    for k in giving:
        i, sign, bound = sides[k]
        row = rows[i]
        needed = bound - sign * float(left[k]) * row.scale
        found.append(
            Conflict(
                row.phase,
                row.name,
                float(times[i]),
                bound,
                needed,
                row.unit,
                float(left[k]),
                row.physical,
                reason,
                True,
            )
        )
    return tuple(found)


def _starts(problem: Problem) -> Iterator[Array]:
    """Yield values of the unknowns: guessed ends, then seeded random ones within the position limits."""
    rng = np.random.default_rng(0)
    phases = problem.phases
    moving = any(phase.robot is not None and phase.robot.root != "fixed" for phase in phases)
    base, reached = [], None
    for phase in phases:
        first, last = ends_of(phase)
        size = _size(phase)
        if moving and reached is not None and len(reached) == len(last):
            # Where nothing is known of an end, the robot stays where it was.
            known = [np.isfinite(bounds.lower[: len(last)]) for bounds in (phase.start_bounds, phase.end_bounds)]
            first, last = (
                np.where(given.any() * np.ones(len(last), bool), x, reached)
                for given, x in zip(known, (first, last), strict=True)
            )
        parameters = default_parameters(phase)
        free = [n for n, low, high in zip(phase.parameter_names, *phase.parameter_bounds, strict=True) if low != high]
        for contact in phase.bound_contacts:
            assert phase.robot is not None
            parameters |= {name: v for name, v in contact.locate(phase.robot, first[:size]).items() if name in free}
        base.append((phase, first, last, guessed_duration(phase, None), parameters))
        reached = last
    for k in range(STARTS_MOVING if moving else STARTS):
        parts, begun = [], 0.0
        for i, (phase, first, last, duration, parameters) in enumerate(base):
            size = _size(phase)
            for state in (first, last):
                parts.append(state[:size] if k == 0 else _varied(phase, state[:size], rng))
            lasting = max(duration, SHORTEST)
            parts += [np.array([begun] * bool(i)), np.array([lasting]), np.array(list(parameters.values()))]
            begun += lasting
        yield np.concatenate(parts)


def _varied(phase: Phase, x: Array, rng: np.random.Generator) -> Array:
    """Return random positions of the joints between their limits; a floating root keeps its pose."""
    bounds = phase.rows.limits()
    names = [state.name for state in phase.body.states][: len(x)]
    lower, upper = np.array([bounds.get(name, (-np.inf, np.inf)) for name in names]).reshape(-1, 2).T
    low = np.where(np.isfinite(lower), lower, x - np.pi)
    high = np.where(np.isfinite(upper), upper, x + np.pi)
    drawn = rng.uniform(np.minimum(low, high), np.maximum(low, high))
    if phase.robot is not None and phase.robot.root == "floating":
        drawn[: QUATERNION.stop] = x[: QUATERNION.stop]
    return np.asarray(drawn)
