"""One solve on one mesh: pose, solve from one start or several, evaluate every row again, limit between the points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from robotraj.fixed_mesh.at_points import AtPoints, solved_once
from robotraj.fixed_mesh.between.limits_between import limited_between
from robotraj.fixed_mesh.warm_start import PATIENCE, separated_form
from robotraj.fixed_mesh.watched import watched_attempt
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status
from robotraj.transcription.clearance.surface_rows import NearSurfaces


def solve(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
    surfaces: Sequence[NearSurfaces | None] = (),
) -> Solution:
    """Solve a problem on a mesh, with limits between its points, and check the solution outside the solver.

    Added rows of a guess are kept on the intervals that both meshes have. Rows that are still violated between the
    points are in ``interval_violations``.

    Parameters
    ----------
    problem : Problem
    guess : InitialGuess, Solution or None
    settings : Settings
    progress : callable, optional
        Called once an iteration; a ``PlanLimits`` also before the solve.
    surfaces : sequence of NearSurfaces or None
        For each phase, links of the robot that rows keep apart.
    """
    return limited_between(solved_at_points(problem, guess, settings, progress, surfaces), settings, progress)


def solved_at_points(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None = None,
    surfaces: Sequence[NearSurfaces | None] = (),
) -> AtPoints:
    """Solve a problem on a mesh without limits between its points; the parameters are those of ``solve``.

    A problem that cannot be solved from its guess is solved from other ones (``restarts``). A problem in compressed
    form starts from the solution of its separated form (``warm_start``). With dry friction of light joints, the rows of
    the compressed form are so steep that a solver may not converge from the solution itself. The separated form, which
    is the same motion, is then the solution.
    """
    form = separated_form(problem, settings.mesh, guess)
    if form is None:
        return _from_starts(problem, guess, settings, progress, surfaces)
    problem, meshes = form
    first = _from_starts(problem, guess, replace(settings, mesh=meshes), progress, surfaces)
    if not first.solution.success:
        return first
    near = replace(settings, solver=settings.solver.from_nearby().at_most(PATIENCE), restarts=Restarts(0))
    try:
        found = solved_once(problem, first.solution, near, progress, surfaces)
    except KeyboardInterrupt:
        # Ctrl-C or a limit between two solves: the solution of the separated form is kept.
        return first.changed(status=Status.INTERRUPTED)
    if found.solution.success or found.solution.status is Status.INTERRUPTED:
        return found.after(first.solution)
    return first.after(found.solution)


def _from_starts(
    problem: Problem,
    guess: InitialGuess | Solution | None,
    settings: Settings,
    progress: Progress | None,
    surfaces: Sequence[NearSurfaces | None],
) -> AtPoints:
    found = watched_attempt(problem, guess, settings, progress, surfaces)
    if found.solution.success or found.solution.conflicts or not settings.restarts.count:
        return found
    from robotraj.fixed_mesh.restarts import restarted

    try:
        return restarted(found, guess, settings, progress)
    except KeyboardInterrupt:
        # Ctrl-C between two solves: the last solution is kept.
        return found.changed(status=Status.INTERRUPTED)
