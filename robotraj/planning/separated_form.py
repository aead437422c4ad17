"""The separated form of phases in compressed form, which is solved first: it has the same solutions.

In compressed form the dynamics are composed with themselves. From a distant guess a solver takes hundreds of
iterations for an arm, or does not converge. The states at mid-points are unknowns of the separated form, and its rows
are less nonlinear. Its solution and the multipliers of its limits are the start of the compressed form.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from robotraj.guess.base import InitialGuess
from robotraj.problem.problem import Problem
from robotraj.solution.records import added_times
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.schemes.compressed import CompressedHermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.shooting.problem import explicit

PATIENCE = 150
"""Largest number of iterations of a solve that starts from the solution of the separated form."""


def separated_form(
    problem: Problem, mesh: Mesh | Sequence[Mesh], guess: InitialGuess | Solution | None
) -> tuple[Problem, tuple[Mesh, ...]] | None:
    """Return the problem and the meshes of the separated form.

    Returns
    -------
    (Problem, tuple of Mesh) or None
        None without a phase in compressed form, or if the guess is a solution on the same meshes.
    """
    meshes = (mesh,) * len(problem.phases) if isinstance(mesh, Mesh) else tuple(mesh)
    if not any(isinstance(scheme, CompressedHermiteSimpson) for own in meshes for scheme in own.given):
        return None
    if isinstance(guess, Solution) and tuple(part.mesh for part in guess.phases) == meshes:
        return None
    return explicit(problem, meshes), tuple(map(_separated, meshes))


def _separated(mesh: Mesh) -> Mesh:
    schemes = [scheme.separated if isinstance(scheme, CompressedHermiteSimpson) else scheme for scheme in mesh.given]
    return replace(mesh, scheme=schemes[0] if len(schemes) == 1 else tuple(schemes))


def from_separated_form(
    settings: Settings,
    solve_separated: Callable[[Settings], Solution],
    solve_compressed: Callable[[Solution, Settings], Solution],
) -> Solution:
    """Solve the separated form, then the compressed form from its solution.

    Rows between the points are steep functions in compressed form if joints have dry friction. Where the solver does
    not converge with those of the separated form, the problem is solved without them. They are then listed as
    violated between the points.

    Parameters
    ----------
    settings : Settings
        Settings of the compressed form.
    solve_separated : callable
        ``solve_separated(settings)`` returns the solution of the separated form.
    solve_compressed : callable
        ``solve_compressed(first, settings)`` solves the compressed form from a solution of the separated form.

    Returns
    -------
    Solution
        The failed solution of the separated form if that is not solved, since both forms have the same solutions.
    """
    first = solve_separated(settings)
    if not first.success:
        return first
    solver = settings.solver.from_nearby().at_most(PATIENCE)
    near = replace(settings, solver=solver, restarts=Restarts(0))
    found = _counted(first, solve_compressed(first, near))
    if not found.success and found.status is not Status.INTERRUPTED and first.added_rows:
        few = replace(settings.interval_limits, rounds=0)
        first = _counted(found, solve_separated(replace(settings, interval_limits=few)))
        patient = replace(near, interval_limits=few, solver=settings.solver.from_nearby())
        found = _counted(first, solve_compressed(first, patient)) if first.success else found
    return found


def _counted(before: Solution, after: Solution) -> Solution:
    """Add the times and iterations of an earlier solve."""
    times, iterations = added_times(before.times, after.times), before.iterations + after.iterations
    return replace(after, times=times, iterations=iterations)
