"""Plan again from measured states, within a deadline, without building the program again."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping, Sequence

from robotraj._util.errors import InputError
from robotraj.applications.replanning.deadline import Deadline
from robotraj.applications.replanning.gait_loop import GaitLoop
from robotraj.applications.replanning.gait_ticks import repeats
from robotraj.applications.replanning.horizon import Horizon
from robotraj.applications.replanning.replan import Replan
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.gait.checks import positive
from robotraj.guess.default import as_guess
from robotraj.planning.plan import plan
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.solution.solution import Solution
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh

INTERVALS = 50
"""Number of intervals of the default mesh."""
MOST_ITERATIONS = 30
"""Iterations after which a step of a gait ends by default: the next measured state is better than the rest of them."""
PERIOD = 0.02
"""Default time between the steps of a gait [s]."""


class Replanner:
    """One problem, solved again and again from measured states.

    The first plan is solved when the replanner is made, which builds and compiles the program. A step changes the fixed
    values of the ends, starts the interior-point method at the last iterate with its multipliers, and stops at the
    deadline. An iterate that meets the rows is the new plan, converged or not. Otherwise the earlier plan is kept, and
    the next step continues from the iterate.

    Of a gait that repeats, the horizon moves: it is the rest of the current phase and ``ahead`` phases after it. A
    program is made for every instant of the gait at which a step may be. Each starts from its own solution of one cycle
    before.

    Parameters
    ----------
    problem : Phase or Problem
        One phase whose start is fixed. A step may change the fixed values of its ends, fixed parameters and the time of
        its start. A moving goal is a parameter or a function of ``point.t``. Obstacles of ``rt.CollisionFree`` are
        functions of time, or are given with every step. Or a gait that repeats on level ground, as of
        ``rt.gait.trot``: each step plans it from a measured state alone, with its speed and heading. Its places along
        the ground follow the robot.
    mesh : Mesh, optional
        50 Hermite-Simpson intervals by default. For a gait, 4 in its longest phase.
    deadline : float, optional
        Wall-clock seconds of a step; none by default. The solver stops before an iteration that would end too late if
        it took as long as the one before. It leaves the time that earlier steps took to check and return the iterate.
    guess : InitialGuess or Solution, optional
        Guess of the first plan; of a gait its solution, which is then not planned again.
    solver : InteriorPoint, optional
        Solver of the steps. The default has a tolerance of 1e-4 and a first barrier of 1e-3. A smaller barrier takes
        more iterations near the last solution, since limits become active or inactive from step to step. That of a gait
        has a tolerance of 1e-2, ends after 30 iterations, and its barrier follows the violation at the start.
    period : float
        About the time between the steps of a gait [s].
    ahead : int
        Number of phases after the current one in the horizon of a gait.

    Raises
    ------
    InputError
        The problem has several phases and does not repeat, its start is not fixed, or its ends cannot change without a
        new program.
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
        period: float = PERIOD,
        ahead: int = 2,
    ) -> None:
        if deadline is not None and not deadline > 0.0:
            raise InputError(f"Replanner(deadline) must be a number above 0 s, got {deadline!r}.")
        if solver is not None and not isinstance(solver, InteriorPoint):
            raise InputError(f"Replanner(solver) must be an rt.InteriorPoint, got {solver!r}.")
        self._deadline = Deadline(deadline)
        self._gait: GaitLoop | None = None
        if isinstance(problem, Problem) and repeats(problem):
            every = positive(period, PERIOD, "Replanner(period)")
            own = solver or InteriorPoint(tolerance=1e-2, max_iterations=MOST_ITERATIONS)
            self._gait = GaitLoop(problem, mesh, guess, own, every, ahead, deadline)
            self.first: Solution = self._gait.gait
            """The plan that was solved when the replanner was made; the gait, if it repeats."""
            return
        phases = problem.phases if isinstance(problem, Problem) else (problem,)
        if len(phases) != 1:
            raise InputError(
                f"A Replanner plans one phase, or a gait that repeats; this problem has {len(phases)} phases, and no "
                "rt.Periodic or rt.Mirror closes it."
            )
        self.first = plan(
            problem,
            mesh=mesh or Mesh(INTERVALS, HermiteSimpson()),
            guess=guess,
            solver=InteriorPoint(fallback=None),
            keep_program=True,
        )
        solver = solver or InteriorPoint(tolerance=1e-4, initial_barrier=1e-3)
        self._horizon = Horizon(self.first, solver, of_gait=False)
        self._plan = self.first.phases[0]

    def step(
        self,
        t: float,
        start: State,
        end: State | None = None,
        parameters: Mapping[str, float] | None = None,
        obstacles: Sequence[Obstacle] | None = None,
        *,
        guess: InitialGuess | Solution | None = None,
        contacts: Collection[str] | None = None,
    ) -> Replan:
        """Plan from a measured state.

        Parameters
        ----------
        t : float
            Time of the measurement [s], on a clock of the caller's choice. It is ``point.t`` at the start of the plan.
            A gait begins its first cycle at 0.
        start : State
            The measured state. Measurement errors may move it beyond its limits. Of a gait, standing feet are put on
            the ground, and at rest.
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
        contacts : collection of str, optional
            Of a gait, the frames of the feet that were measured on the ground. The gait goes on to its next phase when
            its feet land early, and waits for feet that land late. By default the clock alone decides.

        Returns
        -------
        Replan
            ``replan.at(t)`` samples it on the same clock.

        Raises
        ------
        InputError
            A state leaves values open that the problem fixes, a parameter is unknown, the number of obstacles differs,
            or a number is not finite. A gait is given more than contacts, or another problem contacts.
        """
        if self._gait is not None:
            if end is not None or parameters or obstacles is not None or guess is not None:
                raise InputError("A step of a gait takes its time, start and contacts alone.")
            return self._gait.step(float(t), start, contacts)
        if contacts is not None:
            raise InputError("step(contacts=) is of a gait that repeats; the contacts of one phase do not change.")
        began, horizon = time.perf_counter(), self._horizon
        if obstacles is not None:
            if horizon.planes is None:
                raise InputError("step(obstacles=) moves obstacles of rt.CollisionFree, but the problem has none.")
            horizon.planes.place_obstacles(obstacles)
        values = horizon.numbers.values(t, start, end, parameters or {})
        found = horizon.solve(values, self._deadline.left(began), as_guess(guess))
        solved = time.perf_counter()
        if found.fresh:
            self._plan = horizon.motion(found)[0]
        ended = self._deadline.returned(solved)
        return Replan(float(t), self._plan, found.fresh, found.status, found.violation, found.iterations, ended - began)

    @property
    def phase(self) -> Phase:
        """The phase that is planned, with the numbers of the first plan; of a gait its first phase."""
        return self.first.phases[0].phase
