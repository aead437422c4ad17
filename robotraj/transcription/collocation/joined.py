"""Accelerations that are continuous at the knots, where all nodes of a scheme lie inside its intervals.

The acceleration of interval k is the polynomial through its values at the nodes, sum_j l_j(tau) a_kj. At a knot

    sum_j l_j(1) a_kj - sum_j l_j(0) a_{k+1,j} = 0.

With three nodes motions are quadratic accelerations without jumps, those of Hermite-Simpson. Torques, which follow from
them, have none either.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.curves.polynomials import basis
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.layout import PhaseLayout, Run
from robotraj.transcription.scalar_table import Entry, ScalarTable
from robotraj.transcription.schemes.gauss import GaussLegendre

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase


def join_accelerations(phase: Phase, index: int, layout: PhaseLayout, rows: ScalarTable, linear: Triplets) -> None:
    """Add the rows of the knots between intervals of joined schemes."""
    joined = [run for run in layout.runs if _is_joined(run)]
    if not joined or not is_exact(phase, [run.scheme for run in layout.runs]):
        return
    joints = [i for i, variable in enumerate(phase.dae.algebraic) if variable.name.startswith("a.")]
    variables = [phase.dae.algebraic[i] for i in joints]
    entries = [Entry(index, "continuity", variable.name, variable.unit) for variable in variables]
    for run in joined:
        before, after = basis(run.scheme.nodes, np.array([1.0, 0.0]))
        at = rows.add(entries, run.start[1:], 0.0, 0.0)
        for node, (last, first) in enumerate(zip(before, after, strict=True)):
            linear.spread(at, run.algebraic[:-1, node][:, joints], last)
            linear.spread(at, run.algebraic[1:, node][:, joints], -first)


def _is_joined(run: Run) -> bool:
    return isinstance(run.scheme, GaussLegendre) and run.scheme.joined
