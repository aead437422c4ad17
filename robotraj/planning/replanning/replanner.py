"""Plan again from measured states, within a deadline, without building the program again."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.guess.default import as_guess
from robotraj.guess.from_solution import FromSolution
from robotraj.native.build import load_native
from robotraj.planning.plan import plan
from robotraj.planning.replanning.replan import Replan
from robotraj.planning.replanning.step_numbers import StepNumbers
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution
from robotraj.solvers.compiled import CompiledOrigin, origin_of
from robotraj.solvers.formulation import first_barrier
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.objective_scale import of_program
from robotraj.solvers.parametric import parametric, with_constants
from robotraj.solvers.stagewise.native import refresh
from robotraj.solvers.status import STATUSES, Status
from robotraj.transcription.extract import extract
from robotraj.transcription.reuse import started_at
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.transcribe import transcribe

if TYPE_CHECKING:
    from robotraj.dynamics.obstacles.base import Obstacle
    from robotraj.native import Options
    from robotraj.problem.initial_guess import InitialGuess
    from robotraj.problem.phase import Phase
    from robotraj.solvers.formulation import Formulation
    from robotraj.transcription.clearance.plane_rows import PlaneRows

Array = NDArray[np.float64]

INTERVALS = 50
"""Number of intervals of the default mesh."""
FORGOTTEN = 0.9
"""Decrease, from step to step, of the time that is reserved for checking and returning the iterate."""
UNFINISHED = (Status.TIME_LIMIT, Status.ITERATION_LIMIT)
"""Statuses after which the iterate is the start of the next solve."""
FEASIBLE = 1e-4
"""Largest violation of a scaled row at which an iterate is a plan."""


class Replanner:
    """One problem, solved again and again from measured states.

    The first plan is solved when the replanner is made, which builds and compiles the program. A step changes the fixed
    values of the ends, starts the interior-point method at the last iterate with its multipliers, and stops at the
    deadline. An iterate that meets the rows is the new plan, converged or not. Otherwise the earlier plan is kept, and
    the next step continues from the iterate.

    Parameters
    ----------
    problem : Phase or Problem
        One phase whose start is fixed. A step may change the fixed values of its ends, fixed parameters and the time of
        its start. A moving goal is a parameter or a function of ``point.t``. Obstacles of ``rt.CollisionFree`` are
        functions of time, or are given with every step.
    mesh : Mesh, optional
        50 Hermite-Simpson intervals by default.
    deadline : float, optional
        Wall-clock seconds of a step; none by default. The solver stops before an iteration that would end too late if
        it took as long as the one before. It leaves the time that earlier steps took to check and return the iterate.
    guess : InitialGuess or Solution, optional
        Guess of the first plan.
    solver : InteriorPoint, optional
        Solver of the steps. The default has a tolerance of 1e-4 and a first barrier of 1e-3. A smaller barrier takes
        more iterations near the last solution, since limits become active or inactive from step to step.

    Raises
    ------
    InputError
        The problem has several phases, its start is not fixed, or its ends cannot change without a new program.
    NoSolutionFound
        The first plan was not found.

    Notes
    -----
    Limits hold at the collocation points and, for speeds and positions, between them. Distances hold there between the
    shapes that were nearest along the last plan (``transcription.clearance.plane_rows``). A step proves nothing; a
    feedback controller must correct the remaining errors. Source: Diehl, Bock, Schloeder, A real-time iteration scheme
    for nonlinear optimization in optimal feedback control, SIAM J. Control Optim. 43 (2005).
    """

    def __init__(
        self,
        problem: Problem | Phase,
        mesh: Mesh | None = None,
        *,
        deadline: float | None = None,
        guess: InitialGuess | Solution | None = None,
        solver: InteriorPoint | None = None,
    ) -> None:
        phases = problem.phases if isinstance(problem, Problem) else (problem,)
        if len(phases) != 1:
            raise InputError(f"A Replanner plans one phase, but the problem has {len(phases)}.")
        if deadline is not None and not deadline > 0.0:
            raise InputError(f"Replanner(deadline) must be above 0 s, got {deadline!r}.")
        if solver is not None and not isinstance(solver, InteriorPoint):
            raise InputError(f"Replanner(solver) must be an rt.InteriorPoint, got {solver!r}.")
        self.deadline = deadline
        self._solver = solver or InteriorPoint(tolerance=1e-4, initial_barrier=1e-3)
        self.first: Solution = plan(
            problem,
            mesh=mesh or Mesh(INTERVALS, HermiteSimpson()),
            guess=guess,
            solver=InteriorPoint(fallback=None),
            keep_program=True,
        )
        """The plan that was solved when the replanner was made."""
        origin, self._planes = origin_of(self.first.multipliers), None
        if any(isinstance(each, CollisionFree) for each in phases[0].constraints):
            self._planes, origin = _with_planes(self.first)
        if origin is None:
            raise InputError(
                "A Replanner needs the program of rt.InteriorPoint, which solved this problem without one. Give "
                "another mesh or scheme."
            )
        self._phase = self.first.phases[0].phase
        self._compiled = origin.compiled
        self._numbers = StepNumbers(origin.formulation.nlp)
        self._program = parametric(origin.formulation, self._numbers.columns, self._numbers.scalars)
        self._w, self._lam = np.array(origin.w), np.array(origin.lam)
        self._plan = self.first.phases[0]
        start = origin.formulation.start(origin.w)
        program = origin.formulation.program
        self._returning = 0.0
        self._barrier = self._solver.initial_barrier or first_barrier(origin.formulation)
        self._scale = of_program(origin.compiled.native, start, program, self._barrier, origin.nlp)

    def step(
        self,
        t: float,
        start: State,
        end: State | None = None,
        parameters: Mapping[str, float] | None = None,
        obstacles: Sequence[Obstacle] | None = None,
        *,
        guess: InitialGuess | Solution | None = None,
    ) -> Replan:
        """Plan from a measured state.

        Parameters
        ----------
        t : float
            Time of the measurement [s], on a clock of the caller's choice. It is ``point.t`` at the start of the plan.
        start : State
            The measured state. Measurement errors may move it beyond its limits.
        end : State, optional
            The new end, which fixes the same values as that of the problem; the last one by default.
        parameters : mapping of str to float, optional
            New values of fixed parameters of the problem; the last ones by default.
        obstacles : sequence of Obstacle, optional
            The obstacles of ``rt.CollisionFree`` at their measured poses, in the number and order of the problem; the
            last ones by default. Obstacles that are functions of time follow the clock of the caller.
        guess : InitialGuess or Solution, optional
            Where the solver starts, such as a plan of a library; at the last iterate by default. Its multipliers are
            those of the last step.

        Returns
        -------
        Replan
            ``replan.at(t)`` samples it on the same clock.

        Raises
        ------
        InputError
            A state leaves values open that the problem fixes, a parameter is unknown, the number of obstacles differs,
            or a number is not finite.
        """
        began = time.perf_counter()
        if obstacles is not None:
            if self._planes is None:
                raise InputError("step(obstacles=) moves obstacles of rt.CollisionFree, but the problem has none.")
            self._planes.place_obstacles(obstacles)
        formulation = self._program.at(self._numbers.values(t, start, end, parameters or {}))
        start_of_solver = as_guess(guess)
        if start_of_solver is not None:
            self._w = started_at(formulation.nlp, start_of_solver).guess
        if self._planes is not None:
            formulation = with_constants(formulation, self._planes.constants(formulation.nlp, self._w))
        with self._compiled.alone:
            refresh(self._compiled.native, formulation.program)
            left = np.inf if self.deadline is None else self.deadline - self._returning
            found = self._compiled.native.solve(
                formulation.start(self._w),
                formulation.program.lower,
                formulation.program.upper,
                self._options,
                objective_scale=self._scale,
                callback=None,
                time_limit=max(0.0, left - (time.perf_counter() - began)),
                lam=self._lam,
            )
        status = STATUSES.get(found.status, Status.SOLVER_ERROR)
        solved = time.perf_counter()
        w = formulation.columns(found.y)
        outputs = formulation.nlp.outputs(w)
        violation = _violation(formulation, w, outputs)
        fresh = violation <= FEASIBLE
        if fresh or (status in UNFINISHED and np.isfinite(violation)):
            # The next step continues from an unfinished iterate. From the earlier one it would not finish either.
            self._w, self._lam = w, found.lam
        if fresh:
            trajectory = extract(formulation.nlp, w, outputs)[0]
            self._plan = PhaseSolution(self._phase, self.first.phases[0].mesh, trajectory)
        ended = time.perf_counter()
        self._returning = max(ended - solved, FORGOTTEN * self._returning)
        return Replan(float(t), self._plan, fresh, status, violation, found.iterations, ended - began)

    @property
    def phase(self) -> Phase:
        """The phase that is planned, with the numbers of the first plan."""
        return self._phase

    @property
    def _options(self) -> Options:
        options: Options = load_native().Options(
            tolerance=self._solver.tolerance,
            max_iterations=self._solver.max_iterations,
            initial_barrier=self._barrier,
            barrier_factor=self._solver.barrier_factor or 100.0,
            elimination_tolerance=1e-10,
            bound_relaxation=1e-10,
        )
        return options


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


def _violation(formulation: Formulation, w: Array, outputs: Sequence[Array]) -> float:
    """Return the largest violation of a scaled row or bound, NaN for an iterate that is no number."""
    nlp = formulation.nlp
    rows, variables = nlp.rows, nlp.variables
    values = nlp.values(w, outputs)
    of_rows = np.maximum(rows.lower - values, values - rows.upper) * nlp.row_scale
    of_bounds = np.maximum(variables.lower - w, w - variables.upper) / nlp.scale
    return max(0.0, float(np.max(of_rows, initial=0.0)), float(np.max(of_bounds, initial=0.0)))
