"""Configurations at ends of phases that rows on positions determine, and the choice of the fastest branches.

Every such end has several branches, such as an elbow up or down. The time between two configurations is that of the
joint that takes longest at its limit of speed. The fastest chain of branches is found by dynamic programming.

Source: Viterbi, IEEE Transactions on Information Theory 13 (1967), for the chain.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj.guess.ends import guessed_duration
from robotraj.guess.reaching.open_end import OpenEnd
from robotraj.guess.reaching.position_rows import of_positions
from robotraj.problem.constraints.base import Where
from robotraj.problem.links.continuity import Continuity
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import Kind, PhaseRow
from robotraj.problem.problem import Problem

Node = Sequence[tuple["Phase", Where]]
"""The ends of phases that share one configuration."""

APART = 0.3
"""Least difference of a joint [rad, m] between two branches."""
BRANCHES = 8
"""Largest number of branches of an end; the fastest are kept."""


def reached_ends(problem: Problem, branch: int = 0) -> Mapping[int, tuple[Array, Array]]:
    """Return positions (nq,) at the start and the end of phases, by index of the phase; NaN where no row applies.

    The result is empty unless all phases move robots with a fixed root and without contacts, and rows determine an end.

    Parameters
    ----------
    problem : Problem
    branch : int
        Rank of the chain of branches: 0 is the fastest. Ranks beyond the last one start again at 0.
    """
    phases = problem.phases
    reached, starts, ends = nodes_of(problem)
    if not any(isinstance(each, OpenEnd) for each in reached):
        return {}
    chain = _fastest_chain(phases[0], reached, branch)
    return {i: (chain[starts[i]], chain[ends[i]]) for i in range(len(phases))}


def nodes_of(problem: Problem) -> tuple[list[OpenEnd | Array | None], list[int], list[int]]:
    """Return the ends of phases that share a configuration, and the numbers of each phase's start and end among them.

    An end is a search, its only configuration (nq,), or None if no row applies. There are none unless all phases move
    robots with a fixed root and without contacts.
    """
    phases = problem.phases
    if not all(_is_searched(phase) for phase in phases):
        return [], [], []
    joined = {link.second % len(phases) for link in problem.links if isinstance(link, Continuity)}
    nodes: list[list[tuple[Phase, Where]]] = []
    starts: list[int] = []
    ends: list[int] = []
    for i, phase in enumerate(phases):
        if i not in joined or i == 0:
            nodes.append([])
        starts.append(len(nodes) - 1)
        nodes[-1].append((phase, Where.START))
        nodes.append([(phase, Where.END)])
        ends.append(len(nodes) - 1)
    times = np.cumsum([0.0, *(guessed_duration(phase, None) for phase in phases)])
    reached: list[OpenEnd | Array | None] = []
    for k, node in enumerate(nodes):
        time = times[ends.index(k) + 1] if k in ends else times[starts.index(k)]
        reached.append(_at(node, float(time)))
    return reached, starts, ends


def _is_searched(phase: Phase) -> bool:
    robot = phase.robot
    return robot is not None and robot.root == "fixed" and robot.nq == robot.nv and not phase.bound_contacts


def _at(node: Node, time: float) -> OpenEnd | Array | None:
    """Return the search at a node, its only configuration (nq,), or None if no row applies."""
    robot = node[0][0].robot
    assert robot is not None
    for phase, where in node:
        bounds = phase.joint_ends[where]
        if (bounds.lower[: robot.nq] == bounds.upper[: robot.nq]).all():
            return bounds.lower[: robot.nq]
    lower, upper = np.full(robot.nq, -np.inf), np.full(robot.nq, np.inf)
    parts = []
    for phase, where in node:
        bounds, limits = phase.joint_ends[where], phase.rows.limits()
        throughout = np.array([limits.get(f"q.{name}", (-np.inf, np.inf)) for name in robot.position_names])
        lower = np.maximum(lower, np.maximum(bounds.lower[: robot.nq], throughout[:, 0]))
        upper = np.minimum(upper, np.minimum(bounds.upper[: robot.nq], throughout[:, 1]))
        parts.append((phase, _rows_of_positions(phase, where)))
    if (lower > upper).any() or not any(rows for _, rows in parts):
        return None
    return OpenEnd(tuple(parts), lower, upper, _speeds(node[0][0]), time)


def _rows_of_positions(phase: Phase, where: Where) -> tuple[PhaseRow, ...]:
    """Return the rows that apply at an end and depend on the positions of the robot alone."""
    table, n = phase.rows, len(phase.body.states) // 2
    throughout = (row for row in table.path if row.where is Where.THROUGHOUT and row.kind is Kind.PATH)
    return of_positions(phase, (*table.at(where), *throughout), n)


def _fastest_chain(phase: Phase, nodes: Sequence[OpenEnd | Array | None], branch: int) -> list[Array]:
    """Return one configuration (nq,) for every node; NaN where no row applies."""
    robot = phase.robot
    assert robot is not None
    open_places = np.full(robot.nq, np.nan)
    near, costs, speeds = np.array([robot.neutral]), np.zeros(1), _speeds(phase)
    layers: list[tuple[Array, NDArray[np.int_]] | None] = []
    for node in nodes:
        if node is None:
            layers.append(None)
            continue
        found = node.reached(near[np.argmin(costs)]) if isinstance(node, OpenEnd) else node[None]
        if not len(found):
            # Without a solution the guess of the end follows from its bounds.
            layers.append(None)
            continue
        between = np.max(np.abs(found[None] - near[:, None]) / speeds, axis=2)
        total = costs[:, None] + between
        order = _apart(found, total.min(axis=0))
        layers.append((found[order], total.argmin(axis=0)[order]))
        near, costs = found[order], total.min(axis=0)[order]
    chain = [open_places] * len(nodes)
    chosen: int | None = None
    for k in range(len(nodes) - 1, -1, -1):
        layer = layers[k]
        if layer is None:
            continue
        configurations, before = layer
        chosen = branch % len(configurations) if chosen is None else chosen
        chain[k], chosen = configurations[chosen], int(before[chosen])
    return chain


def _speeds(phase: Phase) -> Array:
    """Return the limits of the joints' speeds (nq,), 1 where there is none."""
    assert phase.robot is not None
    limits = phase.rows.limits()
    speeds = np.array([limits.get(f"v.{name}", (-np.inf, np.inf))[1] for name in phase.robot.velocity_names])
    return np.where(np.isfinite(speeds) & (speeds > 0), speeds, 1.0)


def _apart(found: Array, costs: Array) -> NDArray[np.int_]:
    """Return the indices of distinct branches, the fastest first."""
    kept: list[int] = []
    for i in np.argsort(costs).tolist():
        if all(np.max(np.abs(found[i] - found[k])) > APART for k in kept):
            kept.append(i)
        if len(kept) == BRANCHES:
            break
    return np.array(kept)
