"""Point functions at the ends of phases, made once for all meshes, and the symbols and columns of both ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import accumulate, pairwise
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array, Indices
from robotraj._util.values import dataclass
from robotraj.problem.links.base import BoundLink
from robotraj.problem.phase import Phase
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.collocation.symbols import column_of, phase_scalars, shared_symbols
from robotraj.transcription.layout import PhaseLayout


@dataclass(frozen=True, eq=False)
class EndFunctions:
    """Point functions of a block at ends of phases, which are the same on all meshes.

    Attributes
    ----------
    stage : PointFunctions
    read : ndarray of int
        Unknowns of the ends that it reads, of all of them in their order.
    inner : bool
        Whether it depends on accelerations, forces or controls.
    """

    stage: PointFunctions
    read: Indices
    inner: bool = False


_FUNCTIONS: WeakKeyDictionary[Phase | BoundLink, dict[tuple[object, ...], EndFunctions]] = WeakKeyDictionary()
"""Functions at ends with their derivatives, for phases and links that are transcribed again."""


def functions_of(
    owner: Phase | BoundLink, key: tuple[object, ...], layouts: Sequence[PhaseLayout], make: Callable[[], EndFunctions]
) -> EndFunctions:
    """Return the functions of that key: the same ones on all meshes with the same free scalars."""
    free = tuple(scalar.column is not None for layout in layouts for scalar in phase_scalars(layout))
    known = _FUNCTIONS.setdefault(owner, {})
    whole = (*key, free)
    if whole not in known:
        known[whole] = make()
    return known[whole]


class EndSymbols:
    """Symbols of both ends of a phase: states, with ``inner`` also algebraic variables and controls."""

    def __init__(self, phase: Phase, layout: PhaseLayout, inner: bool = False) -> None:
        dae, names, scalars = phase.dae, phase.parameter_names, phase_scalars(layout)
        nx, nz, nu = len(dae.states), len(dae.algebraic), len(dae.controls)
        sizes = (nx, nx, *((nz, nu, nz, nu) if inner else ()))
        cuts = list(accumulate(sizes, initial=0))
        self.unknowns, self.constants, (t0, duration, *each) = shared_symbols(scalars, cuts[-1], 0)
        p = column_of(each)
        first, last, *more = (self.unknowns[i:j] for i, j in pairwise(cuts))
        z0, u0, z1, u1 = more or (None,) * 4
        self.points = dae.point(t0, first, z0, u0, p, names), dae.point(t0 + duration, last, z1, u1, p, names)


def end_columns(layout: PhaseLayout, inner: bool = False) -> Indices:
    """Return the columns of the unknowns of ``EndSymbols``."""
    free = [scalar.column for scalar in phase_scalars(layout) if scalar.column is not None]
    more = list[Indices]()
    if inner:
        for node in (0, -1):
            interval = layout.interval(node)
            more += [interval.algebraic[node], interval.controls[node]]
    return np.concatenate([layout.knots[0], layout.knots[-1], *more, free]).astype(int)


def fixed_values(layout: PhaseLayout) -> Array:
    """Return the scalars of a phase that are no unknowns."""
    return np.array([scalar.value for scalar in phase_scalars(layout) if scalar.column is None])


def read_by(expression: ca.SX, unknowns: ca.SX) -> Indices:
    """Return the indices of the unknowns that an expression depends on, of all if it depends on none.

    Most terms and constraints at an end depend on few unknowns. Further ones would enlarge the matrices of the block,
    and torques among the unknowns of a block cannot be eliminated.
    """
    read = np.array(ca.which_depends(expression, unknowns, 1, False), dtype=bool)
    return np.flatnonzero(read) if read.any() else np.arange(read.size)


def point_functions(v: ca.SX, c: ca.SX, y: ca.SX, costed: int | None = None, as_tapes: bool = False) -> PointFunctions:
    """Return the functions of symbols among which there may be no constants."""
    return PointFunctions(v, c if c.numel() else ca.SX(0, 1), y, costed, as_tapes=as_tapes)
