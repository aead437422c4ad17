"""The project's primal-dual interior-point method, in C++; an iteration runs no Python.

Newton systems of a problem in stages (``robotraj.solvers.stagewise``) are solved by a Riccati recursion. Those of any
other problem (``robotraj.solvers.assembled``) are solved by a sparse factorisation; see
``robotraj.solvers.formulation``.

Sources: Waechter and Biegler, Mathematical Programming 106 (2006), for the filter line search. Vanroye, Sathya, De
Schutter, Decre, FATROP, IROS (2023), for the stages.
"""

from __future__ import annotations

import os
from dataclasses import field, replace
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.precision import ROUND_OFF
from robotraj._util.time_left import used_time
from robotraj._util.values import dataclass
from robotraj.native.build import load_native
from robotraj.solvers.attempts import (
    AHEAD,
    FACTOR,
    PATIENCE_ASSEMBLED,
    PATIENCE_STAGES,
    WeighedAttempt,
    later_attempts,
    solve_in_turn,
)
from robotraj.solvers.base import (
    ALTERED_BARRIER,
    BARRIER,
    BOUND_RELAXATION,
    MOST_ITERATIONS,
    NEARBY_BARRIER,
    TOLERANCE,
    LazyMultipliers,
    Multipliers,
    Outcome,
    Progress,
    Solver,
)
from robotraj.solvers.checks import LOOSEST, above_zero, counted, no_mapping
from robotraj.solvers.compiled import CompiledOrigin, CompiledProgram, report, warm_barrier, warm_start
from robotraj.solvers.fallback import fall_back
from robotraj.solvers.formulation import Formulation, assembled, first_barrier, formulate, options
from robotraj.solvers.formulation import multipliers as original_multipliers
from robotraj.solvers.ipopt import Ipopt
from robotraj.solvers.objective_scale import of_program
from robotraj.solvers.stagewise.native import native_program, refresh
from robotraj.solvers.stagewise.reduction import Reduction
from robotraj.solvers.status import Status
from robotraj.transcription.assembly.block import alike

if TYPE_CHECKING:
    from robotraj.native import Options
    from robotraj.native import Outcome as NativeOutcome
    from robotraj.transcription.nlp import Nlp

LOST_DIGITS = ("step failed",)
"""Ends of a recursion that loses digits, as on fine meshes where few motors bring many states to their end."""
UNSOLVED = (Status.STALLED, Status.SOLVER_ERROR)
"""Statuses after which the fallback solves the problem.

Limits of the user and divergence, which any solver would meet, are not among them. Neither is an infeasible problem:
``rt.plan`` solves it from other guesses.
"""


@dataclass(frozen=True)
class InteriorPoint(Solver):
    """A primal-dual interior-point method with a filter line search.

    A problem that couples only neighbouring intervals is solved stage by stage. Problems with contacts, closed gaits,
    design parameters, integrals or shooting are solved by a sparse factorisation, and others where stages lose digits.

    Parameters
    ----------
    tolerance : float
        Optimality tolerance on the scaled problem.
    max_iterations : int
        Iterations of one solve, including those of the restoration phase. The ``fallback`` counts its own.
    time_limit : float or None
        Wall-clock time of one solve [s], including the ``fallback``. Finer meshes and restarts are further solves.
    initial_barrier : float, optional
        The first barrier parameter. The default is 1e-4 for contacts of a floating root, and 1e-2 otherwise.
    barrier_factor : float, optional
        The barrier parameter falls when the error of its problem is below this multiple of it. The default is 3000
        for contacts of a floating root from a guess and a first barrier of at most 1e-4, else 100.
    adaptive_barrier : bool
        Choose the barrier parameter of every step from a step without a barrier, as long as that makes progress
        (Nocedal, Waechter, Waltz, SIAM J. Optim. 19, 2009). Otherwise the parameter falls monotonically.
    threads : int, optional
        Number of threads that evaluate points; by default the number of processors of the process. Solutions are
        bitwise identical for any number.
    fallback : Solver or None
        Solves the problem where the line search or the iterations of this method fail, unless it diverged or reached a
        ``max_iterations`` set by the user. The message names the reason. None switches it off.
    objective_scale : float, optional
        Factor of the objective. The default makes the weight of the first barrier independent of the mesh. Except for
        small objectives on coarse meshes, it is independent of the unit too; see ``robotraj.solvers.objective_scale``.
        Multipliers belong to the unscaled objective.
    objective_change : float, optional
        Share of the objective. Where eight iterations change less, and so does the duality gap, further steps only
        restore the rows, and the solve ends.

    Raises
    ------
    InputError
        An option is no number above 0, or ``fallback`` is no solver.
    """

    tolerance: float = TOLERANCE
    max_iterations: int = MOST_ITERATIONS
    time_limit: float | None = None
    initial_barrier: float | None = None
    barrier_factor: float | None = None
    adaptive_barrier: bool = False
    threads: int | None = None
    fallback: Solver | None = field(default_factory=Ipopt)
    objective_scale: float | None = None
    objective_change: float | None = None

    def __post_init__(self) -> None:
        no_mapping("InteriorPoint", self.tolerance)
        above_zero("InteriorPoint(tolerance)", self.tolerance, most=LOOSEST)
        counted("InteriorPoint(max_iterations)", self.max_iterations)
        if self.time_limit is not None:
            above_zero("InteriorPoint(time_limit)", self.time_limit, "s")
        for name in ("initial_barrier", "barrier_factor", "objective_change"):
            above_zero(f"InteriorPoint({name})", 1.0 if getattr(self, name) is None else getattr(self, name))
        scale = self.objective_scale
        if scale is not None and not 0 < scale < np.inf:
            raise InputError(f"InteriorPoint(objective_scale) is None or above 0 and finite, got {scale}.")
        if self.threads is not None:
            counted("InteriorPoint(threads)", self.threads)
        if not isinstance(self.fallback, Solver | None):
            raise InputError(
                f"InteriorPoint(fallback) is a solver value such as rt.Ipopt(), or None; got {self.fallback!r}."
            )

    def accurate_to(self, tolerance: float) -> InteriorPoint:
        """Return this solver with no larger tolerance."""
        return replace(self, tolerance=min(self.tolerance, tolerance))

    def with_early_stop(self) -> InteriorPoint:
        """Return this solver with a seventh of its iterations, most of a first attempt, and without its fallback."""
        return replace(self, fallback=None, max_iterations=max(1, self.max_iterations // 7))

    def from_nearby(self, altered: bool = False) -> InteriorPoint:
        """Return this solver with a smaller first barrier, which is adaptive where only the mesh differs."""
        barrier = min(self.initial_barrier or np.inf, ALTERED_BARRIER if altered else NEARBY_BARRIER)
        return replace(self, initial_barrier=barrier, adaptive_barrier=self.adaptive_barrier or not altered)

    def at_most(self, iterations: int) -> InteriorPoint:
        """Return this solver with no more than these iterations and no fallback."""
        return replace(self, max_iterations=min(self.max_iterations, iterations), fallback=None)

    def until_settled(self, change: float) -> InteriorPoint:
        """Return this solver, which ends where its objective hardly changes."""
        return replace(self, objective_change=change)

    def within(self, seconds: float) -> InteriorPoint:
        """Return this solver with a limit of processor seconds for one solve."""
        return replace(self, time_limit=min(seconds, self.time_limit or seconds))

    @property
    def stagewise(self) -> bool:
        """True."""
        return True

    def solve(self, nlp: Nlp, progress: Progress | None = None, multipliers: Multipliers | None = None) -> Outcome:
        """Solve from ``nlp.guess``."""
        began = used_time()
        formulation = formulate(nlp)
        program = formulation.program
        equations, unknowns = int(program.equalities.sum() + program.nx[1:].sum()), int((program.nu + program.nx).sum())
        if equations > unknowns:
            why = f"there are {equations} equations for {unknowns} unknowns"
            if self.fallback is None:
                zeros = Multipliers(np.zeros(len(nlp.rows)), np.zeros(len(nlp.variables)))
                return Outcome(Status.OVERDETERMINED, f"interior point: {why}", nlp.guess, zeros, 0)
            return fall_back(self.fallback, nlp, progress, multipliers, why, self._left(began))
        return self._solve_formulated(formulation, began, progress, multipliers)

    def solve_assembled(self, nlp: Nlp) -> Outcome:
        """Solve from ``nlp.guess`` without stages."""
        return self._solve_formulated(assembled(nlp), used_time(), None, None)

    def resolve(
        self, nlp: Nlp, known: Multipliers, progress: Progress | None = None, multipliers: Multipliers | None = None
    ) -> Outcome:
        """Solve with the compiled program of an earlier solve, without symbolic work, chain rule or allocation."""
        began = used_time()
        origin = known.origin
        # An NLP with added rows, or of another transcription, has other blocks, and the earlier program does not fit.
        if not isinstance(origin, CompiledOrigin) or not alike(origin.nlp.blocks, nlp.blocks):
            return self.solve(nlp, progress, multipliers)
        compiled = origin.compiled
        formulation = origin.formulation.refreshed(nlp) if compiled.threads == self._threads else None
        # Plans in several threads may start from the same solution. Only the first of them uses its program.
        if formulation is None or not compiled.alone.acquire(blocking=False):
            return self.solve(nlp, progress, multipliers)
        try:
            refresh(compiled.native, formulation.program)
            return self._run(formulation, compiled, began, progress, multipliers)
        finally:
            compiled.alone.release()

    @property
    def _threads(self) -> int:
        return self.threads or len(os.sched_getaffinity(0))

    def _solve_formulated(
        self, formulation: Formulation, began: float, progress: Progress | None, multipliers: Multipliers | None
    ) -> Outcome:
        native = native_program(formulation.program, formulation.nlp.engine, self._threads)
        compiled = CompiledProgram(native, self._threads)
        with compiled.alone:
            return self._run(formulation, compiled, began, progress, multipliers)

    def _run(
        self,
        formulation: Formulation,
        compiled: CompiledProgram,
        began: float,
        progress: Progress | None,
        multipliers: Multipliers | None,
    ) -> Outcome:
        nlp, program, native = formulation.nlp, formulation.program, compiled.native
        ready = used_time()
        start, stages = formulation.start(nlp.guess), isinstance(formulation, Reduction)
        from_guess = barrier = self.initial_barrier or first_barrier(formulation)
        factor = self.barrier_factor or FACTOR
        later = later_attempts(from_guess, factor)
        warm = warm_start(multipliers, formulation)
        if warm:
            known_rows = self.adaptive_barrier and "lam" in warm
            barrier = min(barrier, warm_barrier(native, start, program, known_rows))
        elif barrier <= first_barrier(formulation) < BARRIER:
            warm = {"lam": np.zeros(program.form_rows.size)}
            factor = self.barrier_factor or AHEAD * FACTOR

        def attempt(chosen: WeighedAttempt, iterations: int) -> NativeOutcome:
            scale = self.objective_scale or chosen.weight * of_program(native, start, program, from_guess, nlp)
            left = self._left(ready)
            return native.solve(
                start,
                program.lower,
                program.upper,
                self._options(chosen.barrier, chosen.factor, iterations, formulation),
                objective_scale=scale,
                callback=report(progress, native, formulation),
                time_limit=np.inf if left is None else left,
                **chosen.known,
            )

        tried = solve_in_turn(
            (WeighedAttempt(barrier, factor, 1.0, warm), *later),
            PATIENCE_STAGES if stages else PATIENCE_ASSEMBLED,
            self.max_iterations,
            LOST_DIGITS if stages else (),
            attempt,
        )
        status, iterations, found = tried.status, tried.iterations, tried.found[-1]
        if status in (Status.ITERATION_LIMIT, Status.STALLED) and np.abs(found.y).max(initial=0.0) > 1.0 / ROUND_OFF:
            status = Status.DIVERGED
        spent = used_time() - ready
        if stages and found.status in LOST_DIGITS and iterations < self.max_iterations:
            rest = replace(self, max_iterations=self.max_iterations - iterations, time_limit=self._left(ready))
            outcome = rest._solve_formulated(assembled(nlp), used_time(), progress, multipliers)
            times = outcome.times | {"solve": outcome.times.get("solve", 0.0) + spent}
            return replace(outcome, iterations=iterations + outcome.iterations, times=times)
        # A default limit ends this method, not the plan.
        exhausted = status is Status.ITERATION_LIMIT and self.max_iterations == InteriorPoint.max_iterations
        if (status in UNSOLVED or exhausted) and self.fallback is not None:
            reason = f"the interior-point method ended with {found.status!r}"
            outcome = fall_back(self.fallback, nlp, progress, multipliers, reason, self._left(ready))
            if outcome.status is Status.ITERATION_LIMIT and not exhausted:
                # The fallback has found nothing: other guesses are tried, as after this method alone.
                outcome = replace(outcome, status=status)
            times = outcome.times | {"solve": outcome.times.get("solve", 0.0) + spent, "solve: interior point": spent}
            return replace(outcome, iterations=iterations + outcome.iterations, times=times)
        # The parts are measured by wall clock; the machine may give the process less than that.
        wall = {name: sum(each.times[name] for each in tried.found) for name in found.times}
        share = min(1.0, spent / max(wall.pop("total", spent), ROUND_OFF))
        parts = {f"solve: {name}": share * seconds for name, seconds in wall.items()}
        # Vectors, line search and residuals; the time of Python around the solve is negligible.
        parts["solve: steps"] = max(0.0, spent - sum(parts.values()))
        y, lam, sizes = found.y, found.lam, (len(nlp.rows), len(nlp.variables))
        w = formulation.columns(y)
        accuracy = self.tolerance if found.status == "solved" else np.inf
        origin = CompiledOrigin(nlp, w, formulation, lam, compiled, accuracy)
        return Outcome(
            status,
            f"interior point: {found.status}" + (f" ({found.message})" if found.message else ""),
            w,
            LazyMultipliers(lambda: Multipliers(*original_multipliers(formulation, y, lam)), sizes, origin),
            iterations,
            {"setup": ready - began, "solve": spent, **parts},
        )

    def _options(self, barrier: float, barrier_factor: float, iterations: int, formulation: Formulation) -> Options:
        chosen: Options = load_native().Options(
            tolerance=self.tolerance,
            max_iterations=iterations,
            initial_barrier=barrier,
            barrier_factor=barrier_factor,
            adaptive_barrier=self.adaptive_barrier,
            objective_change=self.objective_change or 0.0,
            # Pivots of a last interval with a fixed end are of the order of its length squared: a larger threshold
            # would take them for zeros.
            elimination_tolerance=1e-10,
            bound_relaxation=BOUND_RELAXATION,
            **options(formulation),
        )
        return chosen

    def _left(self, began: float) -> float | None:
        """Seconds of the time limit that are left."""
        return None if self.time_limit is None else began + self.time_limit - used_time()
