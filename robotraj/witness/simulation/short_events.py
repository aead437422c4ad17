"""Short events in the equations of a user, such as a kick of half a millisecond, at which the simulation looks closely.

A step of the simulation evaluates the equations at a few times, and an event between them is not seen. The rates along
the plan are therefore evaluated at many times first, drawn at random so that no event lies between them by design. A
span is cut into short pieces where the rates are not those of a polynomial through its own few times.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj.problem.phase import Phase
from robotraj.problem.rows import phase_symbols
from robotraj.witness.plants.system_plant import arguments
from robotraj.witness.protocols import PhaseSolutionLike
from robotraj.witness.simulation.spans import Span

TIMES = 2**13
"""Times of a phase at which its rates are evaluated."""
FEW = 12
"""Times of a span to which the many are compared, as many as a step of the simulation has."""
MISSED = 1e-4
"""Least change of a state by an event, relative to its size: a tenth of the local error that is allowed."""
PIECE = 4
"""Times in a piece of a span with an event."""
SEED = 20261128


def cut_at_events(
    planned: PhaseSolutionLike, windows: list[list[Span]], names: Sequence[str], sizes: Array
) -> list[list[Span]]:
    """Cut spans of a System's phase where its rates have short events.

    Parameters
    ----------
    planned : PhaseSolution
    windows : list of list of Span
    names : sequence of str
        The states of the System; an objective may add others.
    sizes : ndarray (n,)
        Their sizes.
    """
    if planned.phase.robot is not None or not isinstance(planned.phase, Phase):
        return windows
    spans = [span for window in windows for span in window]
    whole = sum(span.length for span in spans)
    rng = np.random.default_rng(SEED)
    counts = [max(FEW, int(np.ceil(TIMES * span.length / whole))) for span in spans]
    many = [(np.arange(count) + rng.uniform(size=count)) / count for count in counts]
    few = 0.5 * (1.0 + chebyshev.chebpts1(FEW))
    places = [np.concatenate([few, each]) for each in many]
    times = np.concatenate([span.inside(span.begin + span.length * at) for span, at in zip(spans, places, strict=True)])
    intervals = np.repeat([span.interval for span in spans], [len(at) for at in places])
    own = [[state.name for state in planned.phase.dae.states].index(name) for name in names]
    rates = _rates(planned, times, intervals)[:, own]
    if not np.isfinite(rates).all():
        return windows
    ends = np.cumsum([len(at) for at in places])
    cut: dict[Span, list[Span]] = {}
    for span, at, found in zip(spans, many, np.split(rates, ends[:-1]), strict=True):
        smooth = chebyshev.chebval(2.0 * at - 1.0, chebyshev.chebfit(2.0 * few - 1.0, found[:FEW], FEW - 1)).T
        missed = np.abs(found[FEW:] - smooth).mean(axis=0) * span.length
        if np.any(missed > MISSED * sizes):
            pieces = np.linspace(span.begin, span.end, -(-len(at) // PIECE) + 1)
            cut[span] = [Span(float(a), float(b), span.interval) for a, b in zip(pieces, pieces[1:], strict=False)]
    return [[piece for span in window for piece in cut.get(span, [span])] for window in windows] if cut else windows


def _rates(planned: PhaseSolutionLike, times: Array, intervals: NDArray[np.int_]) -> Array:
    """Evaluate the rates of the states along the plan, (m, n)."""
    phase, dae = planned.phase, planned.phase.dae
    symbols = phase_symbols(dae, phase.parameter_names)
    rates = ca.densify(ca.SX(dae.rates(dae.point(*symbols, phase.parameter_names))))
    along = ca.Function("along", list(symbols), [rates]).map(len(times))
    return np.asarray(np.array(along(*arguments(planned, times, intervals))).T)
