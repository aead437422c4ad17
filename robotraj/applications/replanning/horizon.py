"""One compiled program of a control loop: solved for other numbers from the last iterate, within a time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.applications.replanning.step_numbers import StepNumbers
from robotraj.guess.from_solution import FromSolution
from robotraj.native.build import load_native
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution
from robotraj.solvers.compiled import CompiledOrigin, origin_of, warm_barrier
from robotraj.solvers.formulation import first_barrier, options
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.objective_scale import of_program
from robotraj.solvers.parametric import parametric, with_constants
from robotraj.solvers.stagewise.native import refresh
from robotraj.solvers.stagewise.reduction import Reduction
from robotraj.solvers.status import STATUSES, Status
from robotraj.transcription.extract import extract
from robotraj.transcription.reuse import started_at
from robotraj.transcription.transcribe import transcribe

if TYPE_CHECKING:
    from robotraj.native import Options
    from robotraj.problem.initial_guess import InitialGuess
    from robotraj.solvers.formulation import Formulation
    from robotraj.transcription.clearance.plane_rows import PlaneRows


UNFINISHED = (Status.TIME_LIMIT, Status.ITERATION_LIMIT)
"""Statuses after which the iterate is the start of the next solve."""
FEASIBLE = 1e-4
"""Largest violation of a scaled row at which an iterate is a plan."""


@dataclass(frozen=True, eq=False)
class StepResult:
    """The end of one solve.

    Attributes
    ----------
    w : ndarray (n_w,)
        The iterate, in physical units.
    outputs : sequence of ndarray
        Its point functions.
    fresh : bool
        Whether it meets its rows.
    status : Status
    violation : float
        Largest violation of a scaled row.
    iterations : int
    """

    w: Array
    outputs: Sequence[Array]
    fresh: bool
    status: Status
    violation: float
    iterations: int


class Horizon:
    """A problem whose start, and other fixed numbers, change from solve to solve.

    Parameters
    ----------
    first : Solution
        Its first plan, with the program that was kept.
    solver : InteriorPoint
    of_gait : bool
        Whether the start alone changes, and the barrier follows the violation at the start of a solve. Periods of a
        gait are so alike that a larger one would first leave the known solution.
    """

    def __init__(self, first: Solution, solver: InteriorPoint, of_gait: bool) -> None:
        self.first, self._solver, self._of_gait = first, solver, of_gait
        origin = origin_of(first.multipliers)
        self.planes: PlaneRows | None = None
        phases = first.problem.phases
        if any(isinstance(each, CollisionFree) for phase in phases for each in phase.constraints):
            self.planes, origin = _with_planes(first)
        if origin is None:
            raise InputError(
                "A Replanner needs the program of rt.InteriorPoint, which solved this problem without one. Give "
                "another mesh or scheme."
            )
        origin = _with_speeds_as_numbers(origin)
        self._compiled, form = origin.compiled, origin.formulation
        self.numbers = StepNumbers(form.nlp)
        self._program = parametric(form, self.numbers.columns, () if of_gait else self.numbers.scalars)
        self.w, self._lam = np.array(origin.w), np.array(origin.lam)
        self._barrier = solver.initial_barrier or first_barrier(form)
        self._options = options(form)
        start = form.start(origin.w)
        self._scale = of_program(origin.compiled.native, start, form.program, self._barrier, origin.nlp)

    def solve(self, values: Array, time_limit: float, guess: InitialGuess | None = None) -> StepResult:
        """Solve for other numbers (e,), in physical units, from a guess or from the last iterate that was of use."""
        formulation = self._program.at(values)
        if guess is not None:
            self.w = started_at(formulation.nlp, guess).guess
        if self.planes is not None:
            formulation = with_constants(formulation, self.planes.constants(formulation.nlp, self.w))
        with self._compiled.alone:
            refresh(self._compiled.native, formulation.program)
            start, program = formulation.start(self.w), formulation.program
            barrier = warm_barrier(self._compiled.native, start, program, True) if self._of_gait else self._barrier
            found = self._compiled.native.solve(
                start,
                program.lower,
                program.upper,
                self._native_options(barrier),
                objective_scale=self._scale,
                callback=None,
                time_limit=max(0.0, time_limit),
                lam=self._lam,
            )
        status = STATUSES.get(found.status, Status.SOLVER_ERROR)
        w = formulation.columns(found.y)
        outputs = formulation.nlp.outputs(w)
        violation = _violation(formulation, w, outputs)
        fresh = violation <= FEASIBLE
        if fresh or (status in UNFINISHED and not self._of_gait and np.isfinite(violation)):
            # The next step continues from an unfinished iterate. From the earlier one it would not finish either. The
            # next one of this horizon is a cycle of the gait later.
            self.w, self._lam = w, found.lam
        self._nlp = formulation.nlp
        return StepResult(w, outputs, fresh, status, violation, found.iterations)

    def motion(self, found: StepResult) -> tuple[PhaseSolution, ...]:
        """Return the motion of each phase."""
        parts = zip(self.first.phases, extract(self._nlp, found.w, found.outputs), strict=True)
        return tuple(PhaseSolution(first.phase, first.mesh, trajectory) for first, trajectory in parts)

    def _native_options(self, barrier: float) -> Options:
        made: Options = load_native().Options(
            tolerance=self._solver.tolerance,
            max_iterations=self._solver.max_iterations,
            initial_barrier=barrier,
            barrier_factor=self._solver.barrier_factor or 100.0,
            elimination_tolerance=1e-10,
            bound_relaxation=1e-10,
            **self._options,
        )
        return made


def _with_planes(first: Solution) -> tuple[PlaneRows, CompiledOrigin | None]:
    """Solve the problem of a plan again from its solution, with the rows on distances of every step."""
    from robotraj.transcription.clearance.plane_rows import PlaneRows

    settings, problem = first.settings, first.problem
    assert settings is not None
    how = settings.engine, settings.interval_limits, settings.smoothing
    nlp = transcribe(problem, settings.mesh, FromSolution(first), *how)
    rows = PlaneRows(nlp)
    found = InteriorPoint(fallback=None).solve(rows.added(nlp))
    return rows, origin_of(found.multipliers)


def _with_speeds_as_numbers(origin: CompiledOrigin) -> CompiledOrigin:
    """Return an origin whose program reads the speed at the start as a number.

    Stages of a free duration have stretched speeds v T / T_0: the fixed ones are coefficients of the duration there.
    """
    form = origin.formulation
    if not isinstance(form, Reduction) or form.stretched is None:
        return origin
    found = InteriorPoint(fallback=None).solve_assembled(replace(origin.nlp, guess=origin.w))
    return origin_of(found.multipliers) or origin


def _violation(formulation: Formulation, w: Array, outputs: Sequence[Array]) -> float:
    """Return the largest violation of a scaled row or bound, NaN for an iterate that is no number."""
    nlp = formulation.nlp
    rows, variables = nlp.rows, nlp.variables
    values = nlp.values(w, outputs)
    of_rows = np.maximum(rows.lower - values, values - rows.upper) * nlp.row_scale
    of_bounds = np.maximum(variables.lower - w, w - variables.upper) / nlp.scale
    return max(0.0, float(np.max(of_rows, initial=0.0)), float(np.max(of_bounds, initial=0.0)))
