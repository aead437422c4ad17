"""Ends of phases that no configuration satisfies: poses out of reach, footholds, mirror images, clearances.

Every motion has a configuration at both ends of every phase. It satisfies the rows of the phase that depend on
positions alone, the contacts that are held and the links. Between the ends no joint moves faster than its speed limit.
These conditions are necessary and few. Every row is relaxed by slacks s, r >= 0,

    minimise  sum_i w_i (s_i + r_i)    subject to  l_i <= h_i(q_0, q_1, T, p) + c_i (s_i - r_i) <= u_i,

where c_i is the scale of row i, from several seeded starts. Configurations exist if the least sum is zero. Otherwise
rows with slacks must be relaxed, and rows with multipliers conflict with them.
Source: Gill, Murray and Saunders, SNOPT, SIAM Review 47 (2005), section 4.4 (elastic mode).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj.fixed_mesh.diagnosis.end_rows import (
    CONSTRAINT_WEIGHT,
    END_WEIGHT,
    QUATERNION_WEIGHT,
    EndRow,
    ends_of_phases,
    position_count,
    reads_only,
    rows_at_ends,
    rows_of_links,
)
from robotraj.fixed_mesh.warm_start import PATIENCE
from robotraj.guess.along_path import SHORTEST
from robotraj.guess.ends import default_parameters, ends_of, guessed_duration
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.root import QUATERNION
from robotraj.solution.conflict import CLEAR, NOTICED, Conflict
from robotraj.solvers.ipopt import NO_FILE
from robotraj.transcription.extract import PhaseTrajectory

REACHED = 1e-5
"""Slacks relative to the scale of their row that count as zero."""
STARTS, STARTS_MOVING = 12, 6
"""Seeded starts for robots with a fixed root and systems; most of them for those with a moving root.

With a moving root the search ends where two starts agree, since its problems are larger.
"""
NEARNESS = 1e-6
"""Weight of the squared distance from the start, which makes the minimum unique."""
SMALL = 1e-2
"""Slacks relative to the scale of their row that the reweighted sum counts fully."""
NAMED = 3
"""Largest number of rows that are named as the other side of a conflict."""


def unreached_ends(problem: Problem, near: Sequence[PhaseTrajectory] = ()) -> tuple[Conflict, ...]:
    """Return the rows to relax for configurations at the ends of all phases to exist, largest slack first.

    Parameters
    ----------
    problem : Problem
    near : sequence of PhaseTrajectory
        A motion of the phases that a solver has come to; its ends are the first start.

    Returns
    -------
    tuple of Conflict
        They are certain where two starts end at the same least sum, since one local minimum does not exclude a motion.
        Empty where such configurations were found, and where a path gives them. Also empty where the ends are fixed
        and no other row depends on them.
    """
    if any(phase.path is not None for phase in problem.phases):
        return ()
    ends = ends_of_phases(problem.phases)
    rows = [row for each in ends for row in rows_at_ends(each)]
    links = list(rows_of_links(problem, ends))
    if not links and not any(row.weight == CONSTRAINT_WEIGHT or not row.physical for row in rows):
        return ()
    unknown = ca.vertcat(*(symbol for each in ends for symbol in each.unknowns))
    rows = [row for row in (*rows, *links) if reads_only(row.value, unknown)]
    rows = [row for row in rows if ca.depends_on(row.value, unknown)]
    return _least_slacks(problem, rows, unknown, near) if rows else ()


def _least_slacks(
    problem: Problem, rows: Sequence[EndRow], unknown: ca.SX, near_motion: Sequence[PhaseTrajectory]
) -> tuple[Conflict, ...]:
    """Minimise the slacks from one start after the other, and describe the least sum."""
    sides = [
        (i, sign, bound)
        for i, row in enumerate(rows)
        for sign, bound in ((1.0, row.lower), (-1.0, row.upper))
        if np.isfinite(bound)
    ]
    slack, near, weight = (ca.SX.sym(*each) for each in (("s", len(sides)), ("y", unknown.numel()), ("w", len(sides))))
    scaled = [sign * (rows[i].value - bound) / rows[i].scale for i, sign, bound in sides]
    # An equality is one row with two slacks. As two rows it would have multipliers that only their difference fixes.
    moved = [row.value / row.scale for row in rows]
    for k, (i, sign, _) in enumerate(sides):
        moved[i] += sign * slack[k]
    signs, owners = (np.array([side[j] for side in sides]) for j in (1, 0))
    scales = np.array([row.scale for row in rows])
    weights = np.array([rows[i].weight for i, *_ in sides])
    cost = ca.dot(weight, slack) + NEARNESS * ca.sumsqr(unknown - near)
    options = {"tol": 1e-8, "max_iter": PATIENCE, "print_level": 0, "sb": "yes", **NO_FILE}
    solver = ca.nlpsol(
        "ends",
        "ipopt",
        {"x": ca.vertcat(unknown, slack), "p": ca.vertcat(near, weight), "f": cost, "g": ca.vertcat(*moved)},
        {"ipopt": options, "print_time": False, "error_on_fail": False, "show_eval_warnings": False},
    )
    values = ca.Function("values", [unknown], [ca.vertcat(*scaled)])
    free = unknown.numel()
    bounds = {
        "lbx": np.append(np.full(free, -np.inf), np.zeros(len(sides))),
        "lbg": np.array([row.lower for row in rows]) / scales,
        "ubg": np.array([row.upper for row in rows]) / scales,
    }

    def solved(start: Array, weights: Array) -> tuple[float, Array, Array, Array]:
        first = np.maximum(0.0, -np.array(values(start)).ravel())
        guess = np.append(start, np.where(np.isfinite(first), first, 1.0))
        found = solver(x0=guess, p=np.append(start, weights), **bounds)
        place = np.array(found["x"]).ravel()[:free]
        left = np.maximum(0.0, -np.array(values(place)).ravel())
        total = float(weights @ left) if np.all(np.isfinite(left)) else np.inf
        return total, place, left, np.maximum(0.0, -signs * np.array(found["lam_g"]).ravel()[owners.astype(int)])

    best: tuple[float, Array, Array, Array] | None = None
    sums: list[float] = []
    moving = _moves(problem)

    def agree() -> bool:
        return best is not None and sum(total <= (1.0 + NOTICED) * best[0] for total in sums) > 1

    for start in chain(_ends_of_motion(problem, near_motion), _starts(problem)):
        found = solved(start, weights)
        if found[0] < REACHED:
            return ()
        sums.append(found[0])
        if best is None or found[0] < best[0]:
            best = found
        if moving and agree():
            break
    if best is None or not np.isfinite(best[0]):
        return ()
    certain = agree()
    _, place, left, multipliers = best
    if np.sum(left > REACHED) > 1:
        # Reweighted, the sum counts slacks instead of adding them up.
        again = solved(place, weights / (left + SMALL) * SMALL)
        if np.sum(again[2] > REACHED) < np.sum(left > REACHED):
            _, place, left, multipliers = again
    times = np.array(ca.Function("times", [unknown], [ca.vertcat(*(row.time for row in rows))])(place)).ravel()
    # The time of an end is any where the durations before it are free; the configurations do not depend on them.
    fixed = len(problem.phases) == 1 and len(set(problem.phases[0].duration_bounds)) == 1
    times = times if fixed else np.where([row.end is None for row in rows], times, np.nan)
    return _conflicts(rows, sides, left, multipliers, times, certain)


def _conflicts(
    rows: Sequence[EndRow],
    sides: Sequence[tuple[int, float, float]],
    left: Array,
    multipliers: Array,
    times: Array,
    certain: bool,
) -> tuple[Conflict, ...]:
    """Describe rows with slacks, and the rows that they conflict with."""
    giving = [k for k in np.argsort(-left) if left[k] > REACHED]
    binding = [k for k in np.argsort(-multipliers) if multipliers[k] > CLEAR * multipliers.max() and k not in giving]
    # Components of a contact or a frame share a name.
    kept = {"duration", *(rows[sides[k][0]].name for k in giving)}
    named = [rows[sides[k][0]] for k in binding if rows[sides[k][0]].name not in kept]
    named = [row for row in named if row.weight != QUATERNION_WEIGHT]
    # States that the user fixed are named where nothing else conflicts.
    named = [row for row in named if row.weight != END_WEIGHT] or named
    others = list(dict.fromkeys(row.name for row in named))[:NAMED]
    against = f"against {', '.join(others)}" if others else ""
    found = []
    for k in giving:
        i, sign, bound = sides[k]
        row = rows[i]
        needed = bound - sign * float(left[k]) * row.scale
        reason = ", ".join(filter(None, (f"at the {row.end.value}" if row.end else "", against)))
        found.append(
            Conflict(
                row.phase,
                row.name,
                float(times[i]),
                row.shown(bound),
                row.shown(needed),
                row.unit,
                float(left[k]),
                row.physical,
                reason,
                certain,
            )
        )
    return tuple(found)


def _ends_of_motion(problem: Problem, motion: Sequence[PhaseTrajectory]) -> Iterator[Array]:
    """Yield the values of the unknowns in a motion, if there is one."""
    parts = []
    for i, (phase, part) in enumerate(zip(problem.phases, motion, strict=False)):
        size = position_count(phase)
        parts += [part.x(t)[:size] for t in (part.t0, part.t0 + part.duration)]
        parts += [np.array([part.t0] * bool(i)), np.array([part.duration])]
        parts.append(np.array([part.parameters[name] for name in phase.parameter_names]))
    if parts and np.all(np.isfinite(np.concatenate(parts))):
        yield np.concatenate(parts)


def _starts(problem: Problem) -> Iterator[Array]:
    """Yield values of the unknowns: guessed ends, then seeded random ones within the position limits."""
    rng = np.random.default_rng(0)
    phases = problem.phases
    moving = _moves(problem)
    base, reached = [], None
    for phase in phases:
        first, last = ends_of(phase)
        size = position_count(phase)
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
            size = position_count(phase)
            for state in (first, last):
                parts.append(state[:size] if k == 0 else _varied(phase, state[:size], rng))
            lasting = max(duration, SHORTEST)
            parts += [np.array([begun] * bool(i)), np.array([lasting]), np.array(list(parameters.values()))]
            begun += lasting
        yield np.concatenate(parts)


def _moves(problem: Problem) -> bool:
    """Whether the root of a robot moves."""
    return any(phase.robot is not None and phase.robot.root != "fixed" for phase in problem.phases)


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
