"""Data that the compiled interior-point method keeps of a solve, for solves of similar problems."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.solvers.base import BARRIER, SMALL_BARRIER, TOLERANCE, Iteration, Multipliers, Origin, Progress
from robotraj.solvers.formulation import Formulation, carried
from robotraj.solvers.nearby_multipliers import interpolated

if TYPE_CHECKING:
    from robotraj.native import Program
    from robotraj.solvers.stagewise.program import StageProgram as Written


@dataclass(frozen=True, eq=False)
class CompiledProgram:
    """A program in C++, used by one solve at a time.

    Attributes
    ----------
    native : robotraj.native.Program
    threads : int
        Number of threads that evaluate points.
    alone : threading.Lock
        Lock of the solve that uses the program.
    """

    native: Program
    threads: int
    alone: threading.Lock = field(default_factory=threading.Lock)


@dataclass(frozen=True, eq=False)
class CompiledOrigin(Origin):
    """A formulation, the multipliers of its rows, and its compiled program.

    Its ``accuracy`` is the tolerance that the solve met, infinite where it stopped before.
    """

    formulation: Formulation
    lam: NDArray[np.float64]
    compiled: CompiledProgram
    accuracy: float = np.inf


def origin_of(multipliers: Multipliers | None) -> CompiledOrigin | None:
    """Return the origin of multipliers; None where another solver found them."""
    origin = None if multipliers is None else multipliers.origin
    return origin if isinstance(origin, CompiledOrigin) else None


def warm_start(multipliers: Multipliers | None, formulation: Formulation) -> dict[str, NDArray[np.float64]]:
    """Return the arguments of a solve that starts from multipliers; an empty mapping where they do not fit.

    Those of another mesh are interpolated for the inequality rows. The solver estimates the others.
    """
    origin = origin_of(multipliers)
    if origin is None:
        return {}
    if [layout.mesh for layout in origin.nlp.layouts] == [layout.mesh for layout in formulation.nlp.layouts]:
        lam = carried(origin.formulation, origin.lam, formulation)
        return {} if lam is None else {"lam": lam}
    of_bounds = interpolated(origin.formulation, origin.lam, formulation)
    return {} if of_bounds is None else {"lower_duals": of_bounds[0], "upper_duals": of_bounds[1]}


def warm_barrier(native: Program, start: NDArray[np.float64], program: Written, known_rows: bool) -> float:
    """Return the first barrier parameter of a solve that starts from multipliers, in ``known_rows`` of all rows.

    The largest violation of a scaled row at the start measures its distance from the central path. A start that
    violates a row by 1 gets the barrier of a guess, or the small one where the multipliers of all rows are known.
    """
    least, most = (TOLERANCE, SMALL_BARRIER) if known_rows else (SMALL_BARRIER, BARRIER)
    return max(least, most * _largest_violation(native, start, program))


def _largest_violation(native: Program, start: NDArray[np.float64], program: Written) -> float:
    rows = native.rows(start)
    equalities = rows.size - program.lower.size
    outside = np.maximum(program.lower - rows[equalities:], rows[equalities:] - program.upper)
    return float(max(np.max(np.abs(rows[:equalities]), initial=0.0), np.max(outside, initial=0.0)))


def report(
    progress: Progress | None, native: Program, formulation: Formulation
) -> Callable[[int, float, float], bool] | None:
    """Turn a progress callback into one that never stops the solver."""
    if progress is None:
        return None

    def read() -> Origin:
        return Origin(formulation.nlp, formulation.columns(native.iterate))

    def call(number: int, objective: float, infeasibility: float) -> bool:
        progress(Iteration(number, objective, infeasibility, read))
        return False

    return call
