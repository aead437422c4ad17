"""The interface of solvers: values that take an Nlp and return the last iterate, a status and multipliers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import field

from robotraj._util.arrays import Array
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.solvers.status import Status
from robotraj.transcription.nlp import Nlp

TOLERANCE, MOST_ITERATIONS = 1e-8, 1000
"""Tolerance of the optimality conditions, relative to the unit of the objective, and the largest number of iterations.

Both are defaults of every solver. A barrier parameter as small as the tolerance leaves a known solution where it is.
"""
BARRIER, SMALL_BARRIER = 1e-2, 1e-4
"""First barrier parameters from a guess; the latter for contacts of a floating root, and from known solutions.

From a barrier as small as the latter, such contacts start with zero multipliers of their equations. Those of least
squares would make the Hessian indefinite: early iterations would take several factorisations. Planar walkers take more
iterations so, and some end in a worse optimum.
"""
NEARBY_BARRIER, ALTERED_BARRIER = 1e-5, 1e-3
"""First barrier parameters of a solve from the solution on another mesh, and from that of another problem."""
BOUND_RELAXATION = 1e-10
"""Relaxation of bounds relative to them: with a wider one, the eighth digit of minimum times changes."""


@dataclass(frozen=True, eq=False)
class Origin(OneLine):
    """Data of a solve, kept for solves of similar problems.

    Attributes
    ----------
    nlp : Nlp
    w : ndarray (n_w,)
        Last iterate, in physical units.
    """

    nlp: Nlp
    w: Array


@dataclass(frozen=True)
class Iteration(OneLine):
    """One iteration of a solver.

    Attributes
    ----------
    number : int
        0 for the start of a solve.
    objective : float
    infeasibility : float
        Largest violation of a scaled row.
    read : callable, optional
        Returns the iterate. It may be called only inside the callback, since the solver goes on to work in its memory.
    """

    number: int
    objective: float
    infeasibility: float
    read: Callable[[], Origin] | None = field(default=None, compare=False, repr=False)


Progress = Callable[[Iteration], None]
"""A callback that a solver calls once an iteration."""


@dataclass(frozen=True, eq=False)
class Multipliers(OneLine):
    """Multipliers of rows (n_g,) and of variable bounds (n_w,), in physical units: grad f + J' rows + bounds = 0.

    In physical units they are independent of the scaling, as a warm start requires.
    """

    rows: Array
    bounds: Array

    @property
    def sizes(self) -> tuple[int, int]:
        """n_g and n_w."""
        return len(self.rows), len(self.bounds)

    @property
    def origin(self) -> Origin | None:
        """Data of the solver that found them, for a later solve; None where it keeps none."""
        return None

    @property
    def plain(self) -> Multipliers:
        """The arrays without the data of a solver."""
        return self


class LazyMultipliers(Multipliers):
    """Multipliers computed at first use, since those of eliminated rows need a further solve.

    Parameters
    ----------
    find : callable
        Returns the multipliers.
    sizes : (int, int)
    origin : Origin, optional
    """

    def __init__(self, find: Callable[[], Multipliers], sizes: tuple[int, int], origin: Origin | None = None) -> None:
        self.__dict__.update(find=find, _sizes=sizes, _origin=origin)

    @cached_property
    def plain(self) -> Multipliers:
        """The arrays without the data of a solver."""
        find: Callable[[], Multipliers] = self.__dict__["find"]
        return find()

    @property
    def sizes(self) -> tuple[int, int]:
        """n_g and n_w."""
        sizes: tuple[int, int] = self.__dict__["_sizes"]
        return sizes

    @property
    def origin(self) -> Origin | None:
        """Data of the solver that found them, for a later solve."""
        origin: Origin | None = self.__dict__["_origin"]
        return origin

    @property
    def rows(self) -> Array:
        """Multipliers of rows (n_g,)."""
        return self.plain.rows

    @property
    def bounds(self) -> Array:
        """Multipliers of variable bounds (n_w,)."""
        return self.plain.bounds

    def __reduce__(self) -> tuple[type[Multipliers], tuple[Array, Array]]:
        # Another process receives the arrays without the data of a solver.
        return Multipliers, (self.rows, self.bounds)


@dataclass(frozen=True, eq=False)
class Outcome(OneLine):
    """The result of a solve.

    Attributes
    ----------
    status : Status
    message : str
        Message of the solver.
    w : ndarray (n_w,)
        Last iterate, in physical units.
    multipliers : Multipliers
    iterations : int
    times : dict of str to float
        Processor times [s] of ``"setup"``, ``"solve"`` and their parts, such as ``"solve: functions"``.
    by : str
        Another solver that took over, and why; empty where the first one ended.
    """

    status: Status
    message: str
    w: Array
    multipliers: Multipliers
    iterations: int
    times: dict[str, float] = field(default_factory=dict)
    by: str = ""


class Solver(OneLine, ABC):
    """A solver and its options, as one frozen value. A new solver is one new file."""

    @property
    def stagewise(self) -> bool:
        """Whether the solver works stage by stage. It then calls native functions itself, and path rows are cheap."""
        return False

    def at_most(self, iterations: int) -> Solver:
        """Return this solver for a solve that may fail: no more than these iterations, and no fallback.

        A solver without such a limit returns itself.
        """
        return self

    def until_settled(self, change: float) -> Solver:
        """Return this solver for a solution that need not be optimal to the tolerance.

        It ends where several iterations change the objective by less than ``change`` of it, and all rows hold. A solver
        that cannot do so returns itself.
        """
        return self

    def accurate_to(self, tolerance: float) -> Solver:
        """Return this solver with no larger tolerance; itself where it has none."""
        return self

    def with_early_stop(self) -> Solver:
        """Return this solver with few iterations and no fallback, for a problem that seldom has a solution."""
        return self

    def from_nearby(self, altered: bool = False) -> Solver:
        """Return this solver for a start near the optimum, such as the solution on a coarser mesh.

        Parameters
        ----------
        altered : bool
            Whether the start solves a problem that differs in more than its mesh.
        """
        return self

    def resolve(
        self, nlp: Nlp, known: Multipliers, progress: Progress | None = None, multipliers: Multipliers | None = None
    ) -> Outcome:
        """Solve an NLP similar to an earlier one, with the data of that solve.

        Parameters
        ----------
        nlp : Nlp
            An NLP that differs from the earlier one only in bounds, fixed values or guess. Any other NLP is solved by
            ``solve``.
        known : Multipliers
            Multipliers of the earlier outcome. Their ``origin`` has the data of the solver.
        progress, multipliers
            As for ``solve``.
        """
        return self.solve(nlp, progress, multipliers)

    def within(self, seconds: float) -> Solver:
        """Return this solver with a limit of processor seconds for one solve; itself where it has no such limit."""
        return self

    def with_smaller_gap(self, factor: float) -> Solver:
        """Return this solver with ``factor`` times its duality gap; itself where it cannot change the gap.

        An interior-point method stops where the product of multiplier and distance from the bound is small at every
        bound. The gap is the sum of these products, and a finer mesh has more bounds.
        """
        return self

    @abstractmethod
    def solve(self, nlp: Nlp, progress: Progress | None = None, multipliers: Multipliers | None = None) -> Outcome:
        """Solve from ``nlp.guess``; return the last iterate also where the solve fails.

        Parameters
        ----------
        nlp : Nlp
        progress : callable, optional
            Called once per iteration.
        multipliers : Multipliers, optional
            Multipliers of an earlier solution, for a warm start.
        """
