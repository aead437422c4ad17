"""fatrop, driven stage by stage through its own interface, with point functions evaluated in place.

The problem is rewritten in stages (``robotraj.solvers.stagewise``) and handed to C++ once; an iteration runs
no Python, and its
time grows with the number of intervals and no faster.
Source: Vanroye, Sathya, De Schutter, Decre, FATROP: a fast constrained optimal control problem solver for robot
trajectory optimization and control, IROS 2023.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Mapping
from dataclasses import field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.solvers.base import Iteration, LateMultipliers, Multipliers, Origin, Outcome, Progress, Solver
from robotraj.solvers.checks import above_zero, counted, named_options
from robotraj.solvers.ipopt import Ipopt
from robotraj.solvers.objective_scale import of_program
from robotraj.solvers.stagewise.multipliers import recover
from robotraj.solvers.stagewise.native import native_program, refresh
from robotraj.solvers.stagewise.reduction import NotStagewise, Reduction, reduce
from robotraj.solvers.stagewise.warm import carried_over
from robotraj.solvers.status import Status

if TYPE_CHECKING:
    from robotraj.transcription.nlp import Nlp

WARM_BARRIER = 1e-4
"""Barrier parameter of a solve that starts from multipliers."""
STATUSES = {
    "solved": Status.SOLVED,
    "acceptable": Status.SOLVED,
    "invalid number": Status.INVALID_NUMBER,
    "iteration limit": Status.ITERATION_LIMIT,
    "infeasible": Status.INFEASIBLE,
    "line search failed": Status.STALLED,
    "step failed": Status.STALLED,
    "time limit": Status.TIME_LIMIT,
    "interrupted": Status.INTERRUPTED,
    "stopped": Status.INTERRUPTED,
}
BARRIERS = (100.0, 10.0)
"""fatrop's ``barrier_tol_factor``: how far the problem of one barrier is solved before the barrier falls.

The first takes a quarter fewer iterations; where its line search fails, the second, fatrop's own, begins again from the
guess."""
WIDEST = 10_000
"""Variables times equalities of a stage from which on fatrop's fully pivoted elimination takes longer than IPOPT."""
SHORTEST = 1e-3
"""Seconds that a fallback is given at least."""
UNSOLVED = (Status.INFEASIBLE, Status.STALLED, Status.SOLVER_ERROR)
"""Ends that another solver may turn into better ones; limits that the user set are not among them, nor problems whose
variables run off, as they would with any solver."""
RUN_OFF = 1e12
"""Scaled variables beyond this, where fatrop ends unsolved, have run off to infinity."""


@dataclass(frozen=True)
class Fatrop(Solver):
    """fatrop's interior-point method: a Riccati recursion over the stages instead of a general factorisation.

    Parameters
    ----------
    tolerance : float
        Optimality tolerance on the scaled problem.
    max_iterations : int
        Of fatrop in one solve, never more; with a limit of 1 it takes none. The ``fallback`` has its own.
    time_limit : float or None
        Wall-clock seconds of one solve, those of the ``fallback`` included; finer meshes and other beginnings
        are further solves.
    initial_barrier : float
        fatrop's ``mu_init``.
    threads : int, optional
        That evaluate points side by side; as many as the process has processors by default. The answers are the same,
        bit by bit, for any number.
    fallback : Solver or None
        Solves what has no form in stages, such as shooting, and what fatrop gives up, unless its variables ran off; the
        message says why. None refuses the former and leaves the latter.
    options : mapping
        Any further options of fatrop by its own names; they win over the fields above. With a ``barrier_tol_factor``
        among them, a solve that stalls is not begun again with a smaller one.
    objective_scale : float, optional
        What the objective is multiplied by; by default a number that makes the first barrier weigh alike whatever the
        mesh and, but for small objectives on coarse meshes, the unit: see ``robotraj.solvers.objective_scale``.
        Multipliers are those of the objective as it is.
    """

    tolerance: float = 1e-8
    max_iterations: int = 1000
    time_limit: float | None = None
    initial_barrier: float = 1e-2
    threads: int | None = None
    fallback: Solver | None = field(default_factory=Ipopt)
    options: Mapping[str, Any] = field(default_factory=dict)
    objective_scale: float | None = None

    def __post_init__(self) -> None:
        above_zero("Fatrop(tolerance)", self.tolerance)
        counted("Fatrop(max_iterations)", self.max_iterations)
        if self.time_limit is not None:
            above_zero("Fatrop(time_limit)", self.time_limit, "s")
        above_zero("Fatrop(initial_barrier)", self.initial_barrier)
        if self.objective_scale is not None and not 0 < self.objective_scale < np.inf:
            raise InputError(
                f"Fatrop(objective_scale) must be above 0 and finite, or None to be chosen, got {self.objective_scale}."
            )
        if self.threads is not None:
            counted("Fatrop(threads)", self.threads)
        named_options("Fatrop(options)", self.options)
        if "mu_init" in self.options:
            above_zero('Fatrop(options)["mu_init"]', self.options["mu_init"])
        if not isinstance(self.fallback, Solver | None):
            raise InputError(f"Fatrop(fallback) is a solver value such as rt.Ipopt(), or None; got {self.fallback!r}.")

    def from_nearby(self) -> Fatrop:
        """Start at a smaller barrier, unless the options say where."""
        return replace(self, initial_barrier=min(self.initial_barrier, WARM_BARRIER))

    def within(self, seconds: float) -> Fatrop:
        """Give the same solver with at most so many wall-clock seconds a solve."""
        return replace(self, time_limit=min(seconds, self.time_limit or seconds))

    @property
    def stagewise(self) -> bool:
        """It does."""
        return True

    def solve(self, nlp: Nlp, progress: Progress | None = None, multipliers: Multipliers | None = None) -> Outcome:
        """Solve from ``nlp.guess``."""
        began = time.perf_counter()
        try:
            reduction = reduce(nlp)
        except NotStagewise as reason:
            return self._fall_back(nlp, progress, multipliers, str(reason), began)
        program = reduction.program
        unknowns = program.nu + program.nx
        stage = int(np.argmax(program.equalities - unknowns))
        if program.equalities[stage] > unknowns[stage]:
            why = f"a stage has {program.equalities[stage]} equations for {unknowns[stage]} unknowns"
            if self.fallback is None:
                zeros = Multipliers(np.zeros(len(nlp.rows)), np.zeros(len(nlp.variables)))
                return Outcome(Status.OVERDETERMINED, f"fatrop: {why}", nlp.guess, zeros, 0)
            return self._fall_back(nlp, progress, multipliers, why, began)
        widths = unknowns * program.equalities
        stage = int(np.argmax(widths))
        if widths[stage] > WIDEST and self.fallback is not None:
            return self._fall_back(
                nlp,
                progress,
                multipliers,
                f"a stage has {unknowns[stage]} variables and {program.equalities[stage]} "
                "equalities, which fatrop eliminates slowly",
                began,
            )
        compiled = _Compiled(native_program(program, nlp.engine, self._threads), self._threads)
        with compiled.alone:
            return self._run(reduction, compiled, began, progress, multipliers)

    def resolve(
        self, nlp: Nlp, known: Multipliers, progress: Progress | None = None, multipliers: Multipliers | None = None
    ) -> Outcome:
        """Solve with the compiled program of an earlier solve: no symbolic work, no chain rule, no allocation."""
        began = time.perf_counter()
        origin = known.origin
        # An NLP with guards, or of another transcription, has other blocks: nothing of the earlier program fits it.
        if not isinstance(origin, _Origin) or origin.nlp.blocks is not nlp.blocks:
            return self.solve(nlp, progress, multipliers)
        compiled = origin.compiled
        reduction = origin.reduction.refreshed(nlp) if compiled.threads == self._threads else None
        # Plans in other threads may start from the same solution: the first one has its program.
        if reduction is None or not compiled.alone.acquire(blocking=False):
            return self.solve(nlp, progress, multipliers)
        try:
            refresh(compiled.native, reduction.program)
            return self._run(reduction, compiled, began, progress, multipliers)
        finally:
            compiled.alone.release()

    @property
    def _threads(self) -> int:
        return self.threads or len(os.sched_getaffinity(0))

    def _run(
        self,
        reduction: Reduction,
        compiled: _Compiled,
        began: float,
        progress: Progress | None,
        multipliers: Multipliers | None,
    ) -> Outcome:
        nlp, program, native = reduction.nlp, reduction.program, compiled.native
        ready = time.perf_counter()
        start = reduction.start(nlp.guess)
        barrier = self.options.get("mu_init", self.initial_barrier)
        scale = self.objective_scale or of_program(native, start, program, barrier)
        tried = []
        iterations = 0
        for factor in BARRIERS:
            left = np.inf if self.time_limit is None else ready + self.time_limit - time.perf_counter()
            try:
                found = native.solve(
                    start,
                    program.lower,
                    program.upper,
                    self._options(factor, self.max_iterations - iterations),
                    objective_scale=scale,
                    callback=_report(progress),
                    time_limit=left,
                    **_warm(multipliers, reduction),
                )
            except ValueError as error:
                # What a progress callback raises comes through here as well.
                if "option" not in str(error):
                    raise
                raise InputError(f"fatrop refuses the options {dict(self.options)!r}: {error}.") from error
            tried.append(found)
            iterations += found.iterations
            status = STATUSES.get(found.status, Status.SOLVER_ERROR)
            if status is not Status.STALLED or "barrier_tol_factor" in self.options:
                break
            if iterations + 1 >= self.max_iterations:
                break
        if status in (Status.ITERATION_LIMIT, Status.STALLED) and np.max(np.abs(found.y), initial=0.0) > RUN_OFF:
            status = Status.DIVERGED
        spent = time.perf_counter() - ready
        if status in UNSOLVED and self.fallback is not None:
            outcome = self._fall_back(nlp, progress, multipliers, f"fatrop ended with {found.status!r}", ready)
            times = outcome.times | {"solve": outcome.times.get("solve", 0.0) + spent, "solve: fatrop": spent}
            return replace(outcome, iterations=iterations + outcome.iterations, times=times)
        parts = {f"solve: {name}": sum(each.times[name] for each in tried) for name in found.times if name != "total"}
        # Vectors, line search and residuals; what Python adds around the solve is nothing beside them.
        parts["solve: steps"] = max(0.0, spent - sum(parts.values()))
        y, lam = found.y, found.lam
        sizes = len(nlp.rows), len(nlp.variables)
        w = reduction.columns(y)
        origin = _Origin(nlp, w, reduction, lam, compiled)
        return Outcome(
            status,
            f"fatrop: {found.status}" + (f" ({found.message})" if found.message else ""),
            w,
            LateMultipliers(lambda: Multipliers(*recover(reduction, y, lam)), sizes, origin),
            iterations,
            {"setup": ready - began, "solve": spent, **parts},
        )

    def _options(self, barrier_tol_factor: float, iterations: int) -> dict[str, Any]:
        return {
            "tolerance": self.tolerance,
            # fatrop asks before it counts: it takes one step more than this, but none at 0.
            "max_iter": iterations - 1,
            "mu_init": self.initial_barrier,
            # Pivots of a last interval that must reach the goal are of the order of its length squared: with fatrop's
            # own threshold (1e-5) they pass for zeros.
            "linsol_lu_fact_tol": 1e-10,
            # Bounds hold at the answer; fatrop's own relaxation (1e-8) shows in the eighth digit of minimum times.
            "bound_relax_factor": 1e-10,
            "barrier_tol_factor": barrier_tol_factor,
            # At steps near rounding fatrop moves on without the multipliers' part, over and over, and never converges.
            "tiny_step_tol": 0.0,
            **self.options,
        }

    def _fall_back(self, nlp: Nlp, progress: Progress | None, multipliers: Any, reason: str, began: float) -> Outcome:
        if self.fallback is None:
            raise InputError(f"Fatrop takes problems in stages, but {reason}; use rt.Ipopt().")
        fallback = self.fallback
        if self.time_limit is not None:
            fallback = fallback.within(max(SHORTEST, began + self.time_limit - time.perf_counter()))
        outcome = fallback.solve(nlp, progress, multipliers)
        by = type(self.fallback).__name__
        return Outcome(
            outcome.status,
            f"{outcome.message} (by {by}, since {reason})",
            outcome.w,
            outcome.multipliers,
            outcome.iterations,
            outcome.times,
        )


@dataclass(frozen=True, eq=False)
class _Compiled:
    """A program in C++, that one solve at a time writes its numbers to."""

    native: Any
    threads: int
    alone: threading.Lock = field(default_factory=threading.Lock)


@dataclass(frozen=True, eq=False)
class _Origin(Origin):
    """What fatrop keeps: a program, the multipliers of its rows, and its compiled form."""

    reduction: Reduction
    lam: np.ndarray
    compiled: _Compiled


def _warm(multipliers: Multipliers | None, reduction: Reduction) -> dict[str, Any]:
    """Start from multipliers that fatrop itself found, where there are any."""
    if multipliers is None or not isinstance(multipliers.origin, _Origin):
        return {}
    origin = multipliers.origin
    return {"lam": carried_over(origin.reduction, origin.lam, reduction), "mu": WARM_BARRIER}


def _report(progress: Progress | None) -> Any:
    """Turn a progress callback into one that never asks to stop."""
    if progress is None:
        return None

    def report(number: int, objective: float, infeasibility: float) -> bool:
        progress(Iteration(number, objective, infeasibility))
        return False

    return report
