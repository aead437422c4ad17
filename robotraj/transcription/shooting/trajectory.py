"""Polynomials of a one-step scheme: the dense output of the step over every piece."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import lobatto_sites
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.problem.phase import Phase
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.shooting.shooting import Rate


def shot_polynomials(
    phase: Phase, layout: PhaseLayout, outputs: Array, w: Array
) -> tuple[PiecewisePolynomial, PiecewisePolynomial, PiecewisePolynomial]:
    """Return states, algebraic variables (none) and controls of a phase, one polynomial per interval of its mesh.

    Parameters
    ----------
    outputs : ndarray (n_y, E)
        Outputs of the phase's block at w.
    """
    scheme = layout.scheme
    assert isinstance(scheme, OneStep)
    nx, pieces = len(phase.dae.states), len(scheme.pieces) - 1
    rate = Rate.of(phase, scheme)
    sites = lobatto_sites(scheme.degree + 1)
    # Only single shooting has several pieces; the states between them are outputs after the defect.
    between = outputs[nx : nx * pieces].T.reshape(outputs.shape[1], pieces - 1, nx)
    before, after, read, controls = [], [], [], []
    for interval, inner in zip(layout.intervals, between, strict=True):
        knots = [w[interval.left], *inner, w[interval.right]]
        clock = interval.clock
        scalars = [clock.base.of(w), clock.span.of(w), *(s.of(w) for s in layout.parameters)]
        for j, (low, high) in enumerate(zip(scheme.pieces[:-1], scheme.pieces[1:], strict=True)):
            u = w[interval.controls[scheme.controls_of(j)]]
            place = [clock.start + clock.length * low, clock.length * (high - low)]
            controls.append(u)
            before.append(knots[j])
            after.append(knots[j + 1])
            read.append(np.concatenate([u.ravel(), scalars, place]))
    zero = np.zeros((len(before), rate.size - nx))
    samples = scheme.samples(rate.function, sites).map(len(before))
    found = np.array(samples(np.hstack([before, zero]).T, np.hstack([after, zero]).T, np.array(read).T)).reshape(
        rate.size, len(before), len(sites)
    )
    breaks = layout.breaks(w)
    # Contiguous, as they are after loading: products of strided arrays differ in the last digit.
    states = [np.ascontiguousarray(found[:nx, k].T) for k in range(len(before))]
    return (
        PiecewisePolynomial(breaks, [sites] * len(states), states),
        PiecewisePolynomial(breaks, [sites] * len(states), [np.zeros((len(sites), 0))] * len(states)),
        PiecewisePolynomial(breaks, [scheme.piece_sites] * len(states), controls),
    )
