"""Symbols of one evaluation of a point function, divided into unknowns and constants by the layout of a phase."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, count, pairwise

import casadi as ca

from robotraj._util.values import dataclass
from robotraj.problem.phase import Phase
from robotraj.transcription.layout import PhaseLayout, Scalar


@dataclass(frozen=True, eq=False)
class PointSymbols:
    """Symbols of one point of a phase, as unknowns and constants of the layout."""

    x: ca.SX
    z: ca.SX
    u: ca.SX
    t: ca.SX
    duration: ca.SX
    p: ca.SX
    unknowns: ca.SX
    constants: ca.SX


def point_symbols(phase: Phase, scalars: Sequence[Scalar]) -> PointSymbols:
    """Return the symbols; fixed ones of the scalars (base, span, parameters) are constants, as the fraction tau is."""
    dae = phase.dae
    ends = list(accumulate((len(dae.states), len(dae.algebraic), len(dae.controls)), initial=0))
    unknowns, constants, (t0, duration, *p) = shared_symbols(scalars, ends[-1], 1)
    # Slices of two long symbols: the concatenation of many short ones takes several times as long in CasADi.
    x, z, u = (unknowns[first:last] for first, last in pairwise(ends))
    return PointSymbols(x, z, u, t0 + constants[0] * duration, duration, column_of(p), unknowns, constants)


def shared_symbols(scalars: Sequence[Scalar], unknowns: int, constants: int) -> tuple[ca.SX, ca.SX, list[ca.SX]]:
    """Return symbols of unknowns, symbols of constants, and the symbol of each scalar.

    Parameters
    ----------
    scalars : sequence of Scalar
        Free ones are the last unknowns, fixed ones the last constants.
    unknowns, constants : int
        Number of the unknowns and of the constants before them.
    """
    free = sum(scalar.column is not None for scalar in scalars)
    v, c = ca.SX.sym("v", unknowns + free), ca.SX.sym("c", constants + len(scalars) - free)
    next_v, next_c = count(unknowns), count(constants)
    return v, c, [c[next(next_c)] if scalar.column is None else v[next(next_v)] for scalar in scalars]


def column_of(parts: Sequence[ca.SX]) -> ca.SX:
    """Return scalars as a column, which may be empty."""
    return ca.vertcat(*parts) if parts else ca.SX(0, 1)


def phase_scalars(layout: PhaseLayout) -> list[Scalar]:
    """Return start time, duration and parameters of a phase, in the order of the symbols."""
    return [layout.t0, layout.duration, *layout.parameters]


def interval_scalars(layout: PhaseLayout, interval: int) -> list[Scalar]:
    """Return base, span and parameters of an interval, in the order of the symbols."""
    clock = layout.clock(interval)
    return [clock.base, clock.span, *layout.parameters]
