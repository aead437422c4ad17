"""Multipliers for a new mesh from the duals on another, by the inverse of the covector mapping.

On every interval the defects' multipliers mu are chosen so that the stage costates are the known costate at
the nodes,

    -(sum_j mu_j A_jk + mu_e b_k) / b_k = lambda(t_k),

in the sense of least squares. Densities of algebraic rows, path rows and bounds are multiplied by the
quadrature weight of a node on the new mesh. Multipliers of ends, durations and links are zero.
Source: the mapping of ``covector``, inverted.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from robotraj._util.arrays import Array
from robotraj.solution.costates.duals import PhaseDuals
from robotraj.solvers.base import LazyMultipliers, Multipliers
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.schemes.collocation import Collocation


def transfer(duals: Sequence[PhaseDuals], nlp: Nlp) -> Multipliers | None:
    """Estimate the multipliers of an NLP of the same problem, None where its schemes or sizes do not allow it.

    They are computed when they are first read, since not every solver starts from them.
    """
    schemes = (interval.scheme for layout in nlp.layouts for interval in layout.intervals)
    if len(duals) != len(nlp.layouts) or not all(isinstance(scheme, Collocation) for scheme in schemes):
        return None
    return LazyMultipliers(partial(_transferred, duals, nlp), (len(nlp.rows), len(nlp.variables)))


def _transferred(duals: Sequence[PhaseDuals], nlp: Nlp) -> Multipliers:
    rows, bounds = np.zeros(len(nlp.rows)), np.zeros(len(nlp.variables))
    # Where costates are not unique there are no duals to transfer, and the estimate is zero.
    for i, (known, layout) in enumerate(zip(duals, nlp.layouts, strict=False)):
        breaks = layout.breaks(nlp.guess)
        _defects(nlp, i, known, layout, breaks, rows)
        _places(nlp, i, known, layout, breaks, rows)
        _bounds(known, layout, breaks, bounds)
    return Multipliers(rows, bounds)


def _defects(nlp: Nlp, phase: int, known: PhaseDuals, layout: PhaseLayout, breaks: Array, rows: Array) -> None:
    chosen = [i for i, e in enumerate(nlp.rows.entries) if e.phase == phase and e.name == "defect"]
    where = np.flatnonzero(np.isin(nlp.rows.meaning, chosen)).reshape(-1, known.costate.size)
    first = 0
    for k, interval in enumerate(layout.intervals):
        scheme = interval.scheme
        assert isinstance(scheme, Collocation)
        coefficients = scheme.matrix[scheme.nodes > 0.0]
        if scheme.nodes[-1] < 1.0:
            coefficients = np.vstack([coefficients, scheme.weights])
        times = breaks[k] + (breaks[k + 1] - breaks[k]) * scheme.nodes
        wanted = -scheme.weights[:, None] * known.costate(_inside(known, times))
        rows[where[first : first + len(coefficients)]] = np.linalg.lstsq(coefficients.T, wanted, rcond=None)[0]
        first += len(coefficients)


def _places(nlp: Nlp, phase: int, known: PhaseDuals, layout: PhaseLayout, breaks: Array, rows: Array) -> None:
    """Algebraic and path rows: each is one output of one place of the phase's block."""
    block = nlp.blocks[phase]
    width, nx = block.stage.outputs, known.costate.size
    seconds, times = np.zeros(block.count), np.zeros(block.count)
    for k, interval in enumerate(layout.intervals):
        assert isinstance(interval.scheme, Collocation)
        length = breaks[k + 1] - breaks[k]
        np.add.at(seconds, interval.places, length * interval.scheme.weights)
        times[interval.places] = breaks[k] + length * interval.scheme.nodes
    at = _inside(known, times)
    densities = np.hstack([known.residual(at), known.path(at)]) * seconds[:, None]
    by_output = block.scatter.tocsc()
    for j in range(densities.shape[1]):
        outputs = np.arange(block.count) * width + nx + j
        alone = np.diff(by_output.indptr)[outputs] == 1
        rows[by_output.indices[by_output.indptr[outputs[alone]]]] = densities[alone, j]


def _bounds(known: PhaseDuals, layout: PhaseLayout, breaks: Array, bounds: Array) -> None:
    for k, interval in enumerate(layout.intervals):
        scheme = interval.scheme
        assert isinstance(scheme, Collocation)
        length = breaks[k + 1] - breaks[k]
        times = _inside(known, breaks[k] + length * scheme.nodes)
        weights = length * scheme.weights
        np.add.at(bounds, interval.states, weights[:, None] * known.states(times))
        np.add.at(bounds, interval.algebraic, weights[:, None] * known.algebraic(times))
        sites = _inside(known, breaks[k] + length * scheme.control_sites)
        np.add.at(bounds, interval.controls, (weights @ scheme.control_at_nodes)[:, None] * known.controls(sites))


def _inside(known: PhaseDuals, times: Array) -> Array:
    return np.clip(times, known.costate.breaks[0], known.costate.breaks[-1])
