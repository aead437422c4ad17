"""Rows added between the collocation points: their choice by violations, and the NLP with these rows."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj.problem.phase_row import Kind
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.collocation.ends import widen
from robotraj.transcription.collocation.index_reduction import path_equalities
from robotraj.transcription.extract import extract
from robotraj.transcription.interval_limits.constraint_generation import add_rows
from robotraj.transcription.interval_limits.interval_violations import IntervalViolation
from robotraj.transcription.interval_limits.row_places import AddedRow
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.scalar_table import ScalarTable
from robotraj.transcription.scaling import row_scale
from robotraj.transcription.schemes.onestep import OneStep

SWINGS = (0.5 - 0.5 / np.sqrt(3.0), 0.5 + 0.5 / np.sqrt(3.0))
"""Extrema of t (t - 1/2) (t - 1)."""
SPREAD = 0.5 * (1.0 - np.cos(np.pi * (np.arange(6) + 0.5) / 6))
"""Places of an interval at which a row is imposed where one place was not enough."""


def rows_against_swings(nlp: Nlp) -> list[AddedRow]:
    """Return rows that are imposed between the points from the start: path inequalities that read speeds.

    Between two knots the speeds of an exact motion are cubic, and at the points of Hermite-Simpson a multiple of
    t (t - 1/2) (t - 1) is 0. Least time exploits it: a tool may exceed its limit on one half of every interval. The
    rows are imposed where that is greatest, at (1 -+ 1/sqrt(3)) / 2.
    """
    found = []
    for i, (phase, layout) in enumerate(zip(nlp.problem.phases, nlp.layouts, strict=True)):
        robot = phase.state_robot
        if robot is None or phase.path is not None or isinstance(layout.scheme, OneStep):
            continue
        speeds = phase.rows.symbols[1][robot.nq : robot.nq + robot.nv]
        rows = [
            row.number
            for row in phase.rows.of_state
            if row.kind is Kind.PATH
            and not row.is_equality
            and ca.depends_on(phase.rows.expressions((row,))[0], speeds)
        ]
        found += [
            AddedRow(i, interval, row, tau)
            for row in rows
            for interval in range(len(layout.intervals))
            for tau in SWINGS
        ]
    return found


def rows_to_add(nlp: Nlp, found: Sequence[IntervalViolation], added: Sequence[AddedRow]) -> list[AddedRow]:
    """Return the rows to impose against violations between the collocation points, without those already added.

    A row is imposed at its worst place. An inequality that was already added on the interval is imposed at Chebyshev
    points of the whole interval too. Several equalities on an interval would overdetermine the motion. For the same
    reason equalities that are imposed with their rates (``index_reduction``) are not added.
    """
    table = [phase.rows for phase in nlp.problem.phases]
    inequalities = {
        (each.phase, each.interval, each.row) for each in added if not table[each.phase].rows[each.row].is_equality
    }
    wanted: dict[AddedRow, None] = {}
    for violation in found:
        if _is_held_with_rates(nlp, violation):
            continue
        place = violation.phase, violation.interval, violation.row.number
        further = SPREAD.tolist() if place in inequalities else []
        wanted |= dict.fromkeys(AddedRow(*place, tau) for tau in (violation.tau, *further))
    known = set(added)
    return [each for each in wanted if each not in known]


def exceeded_although_added(
    nlp: Nlp, found: Sequence[IntervalViolation], added: Sequence[AddedRow]
) -> list[IntervalViolation]:
    """Return the violated path inequalities that are imposed at Chebyshev points of their interval already.

    Where joints oscillate, further places on the interval only move the peak between them. On a path, inequalities are
    not imposed at further points at all.
    """
    counts = Counter((each.phase, each.interval, each.row) for each in added)
    return [
        violation
        for violation in found
        if violation.row.kind is Kind.PATH
        and not violation.row.is_equality
        and not isinstance(nlp.layouts[violation.phase].scheme, OneStep)
        and (
            nlp.problem.phases[violation.phase].path is not None
            or counts[violation.phase, violation.interval, violation.row.number] > len(SPREAD)
        )
    ]


def _is_held_with_rates(nlp: Nlp, violation: IntervalViolation) -> bool:
    phase = nlp.problem.phases[violation.phase]
    if isinstance(nlp.layouts[violation.phase].scheme, OneStep):
        return False
    return any(phase.rows.path[equation.row] is violation.row for equation in path_equalities(phase))


def with_added_rows(nlp: Nlp, added: Sequence[AddedRow], w: Array) -> Nlp:
    """Append rows and their states to an NLP; everything else keeps its place, scale and functions.

    Parameters
    ----------
    nlp : Nlp
    added : sequence of AddedRow
        Rows that ``nlp`` does not have yet.
    w : ndarray (n_w,)
        Start of the solver in physical units; states at added rows are those of its polynomials.
    """
    phases, layouts = nlp.problem.phases, nlp.layouts
    columns, rows, linear = ScalarTable.after(nlp.variables), ScalarTable.after(nlp.rows), Triplets()
    points, others = nlp.blocks[: len(phases)], nlp.blocks[len(phases) :]
    scatters = [Triplets() for _ in phases]
    widths = [block.stage.outputs for block in points]
    more = add_rows(added, phases, layouts, columns, rows, linear, scatters, widths)
    variables, constraints = nlp.variables.joined(columns.finish()), nlp.rows.joined(rows.finish())
    shape = (len(constraints), len(variables))

    kept = [widen(block, *shape) for block in points]
    extra = [scatter.matrix(block.scatter.shape) for scatter, block in zip(scatters, kept, strict=True)]
    further = [widen(block, *shape) for block in more]
    for block in further:
        block.stage.as_tapes = nlp.engine.separate_torques
    matrix = linear.matrix(shape)
    scales = dict(zip(nlp.variables.meaning.tolist(), nlp.scale.tolist(), strict=True))
    scale = np.append(nlp.scale, [scales[m] for m in variables.meaning[len(nlp.variables) :].tolist()])
    start = np.append(w, _states(nlp, (added,), w))
    alone = [replace(block, scatter=own) for block, own in zip(kept, extra, strict=True) if own.nnz]
    rows_alone = row_scale([*alone, *further], matrix, variables, constraints, scale, start)

    before = nlp.linear.copy()
    before.resize(shape)
    points = tuple(replace(block, scatter=block.scatter + own) for block, own in zip(kept, extra, strict=True))
    return replace(
        nlp,
        variables=variables,
        rows=constraints,
        blocks=(*points, *(widen(block, *shape) for block in others), *further),
        linear=before + matrix,
        scale=scale,
        row_scale=np.append(nlp.row_scale, rows_alone[len(nlp.rows) :]),
        guess=start,
        additions=(*nlp.additions, tuple(added)),
    )


def with_added_states(nlp: Nlp, w: Array) -> Array:
    """Return a decision vector (n_w,) whose states at added rows are those of its polynomials."""
    own = _states(nlp, nlp.additions, w)
    return np.append(w[: len(w) - len(own)], own)


def _states(nlp: Nlp, additions: Sequence[Sequence[AddedRow]], w: Array) -> Array:
    """Return the states that path rows add, one after the other; rows that were added together share them."""
    found = [np.empty(0)]
    trajectories = None
    for added in additions:
        paths = [each for each in added if _adds_states(nlp, each)]
        for phase, interval, tau in dict.fromkeys(each.place for each in paths):
            trajectories = trajectories or extract(nlp, w)
            x = trajectories[phase].x
            first, last = x.breaks[interval : interval + 2]
            found.append(x(first + tau * (last - first), interval))
    return np.concatenate(found)


def _adds_states(nlp: Nlp, each: AddedRow) -> bool:
    row = nlp.problem.phases[each.phase].rows.rows[each.row]
    return row.kind is not Kind.BOUND and not isinstance(nlp.layouts[each.phase].scheme, OneStep)
