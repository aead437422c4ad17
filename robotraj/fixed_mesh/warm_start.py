"""Where a solve starts: data of an earlier solution, and the separated form of phases in compressed form.

Data of a solution are its program, its rows between the points and its multipliers.

In compressed form the dynamics are composed with themselves. From a distant guess a solver takes hundreds of
iterations for an arm, or does not converge. The states at mid-points are unknowns of the separated form, and its rows
are less nonlinear. Both have the same solutions, so that of the separated form and the multipliers of its limits are
the start of the compressed form.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from robotraj.fixed_mesh.starts import Start
from robotraj.native.engines.base import Engine
from robotraj.problem.initial_guess import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.solution import Solution
from robotraj.solvers.base import LazyMultipliers, Multipliers
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.interval_limits.row_places import AddedRow
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.reuse import transcribed_again
from robotraj.transcription.schemes.compressed import CompressedHermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.shooting.explicit_dynamics import explicit
from robotraj.transcription.transcribe import meshes_of

NEAR = 0.1
"""Largest violation of a scaled row at a point that is near a motion, so that its multipliers are used."""
PATIENCE = 150
"""Iterations of a solve that can only improve an objective or the guess of another solve."""


def earlier_program(
    problem: Problem,
    mesh: Mesh | Sequence[Mesh],
    guess: InitialGuess | Solution | None,
    engine: Engine | None,
    interval_limits: ConstraintGeneration,
    smoothing: float,
) -> Nlp | None:
    """Return the NLP of an earlier solution or of earlier starts, with the numbers of this problem.

    None is returned if the NLP has another structure, or further rows on distances or between its points.
    """
    if isinstance(guess, Start):
        return guess.shared.transcribed(problem, mesh, guess, engine, interval_limits, smoothing)
    if (
        not isinstance(guess, Solution)
        or guess.added_rows
        or guess.multipliers is None
        or guess.multipliers.origin is None
    ):
        return None
    origin = guess.multipliers.origin
    if origin.nlp.keeps_clear:
        return None
    return transcribed_again(origin.nlp, problem, mesh, engine, interval_limits, smoothing, origin.w)


def earlier_rows(
    problem: Problem, mesh: Mesh | Sequence[Mesh], guess: InitialGuess | Solution | None
) -> tuple[list[AddedRow], bool]:
    """Return the added rows of an earlier solution that this problem has as well, and whether these are all of them.

    On another mesh, rows are kept on the intervals that begin and end as before, whatever their schemes. The second
    value is False then.
    """
    if not isinstance(guess, Solution) or not guess.added_rows or len(guess.phases) != len(problem.phases):
        return [], False
    meshes = meshes_of(problem, mesh)

    def rows(phase: Phase) -> list[tuple[str, str | None]]:
        return [(row.name, row.joint) for row in phase.rows]

    pairs = list(zip(guess.phases, problem.phases, strict=True))
    if not all(rows(part.phase) == rows(phase) for part, phase in pairs):
        return [], False
    # A row of the same name may hold at another time, or depend on variables that are unknown between the points.
    of_state = [{row.number for row in phase.rows.of_state} for phase in problem.phases]
    added = [each for each in guess.added_rows if each.row in of_state[each.phase]]
    if all(part.mesh == here for part, here in zip(guess.phases, meshes, strict=True)):
        return added, len(added) == len(guess.added_rows)
    kept = [_kept_intervals(part.mesh, here) for part, here in zip(guess.phases, meshes, strict=True)]
    return [
        replace(each, interval=kept[each.phase][each.interval]) for each in added if each.interval in kept[each.phase]
    ], False


def _kept_intervals(before: Mesh, after: Mesh) -> dict[int, int]:
    """Map the intervals of a mesh to the same intervals of another mesh, by number; empty where knots move."""
    if isinstance(before, MovingMesh) or isinstance(after, MovingMesh):
        return {}
    numbers = {ends: k for k, ends in enumerate(_ends(after))}
    return {k: numbers[ends] for k, ends in enumerate(_ends(before)) if ends in numbers}


def _ends(mesh: Mesh) -> Iterator[tuple[float, float]]:
    knots = [round(float(knot), 12) for knot in mesh.knots]
    return zip(knots[:-1], knots[1:], strict=True)


def _broken_by(nlp: Nlp) -> float:
    """Return the largest violation of a scaled row at the guess."""
    values = nlp.values(nlp.guess)
    return float(np.max(np.maximum(nlp.rows.lower - values, values - nlp.rows.upper) * nlp.row_scale, initial=0.0))


def earlier_multipliers(guess: InitialGuess | Solution | None, nlp: Nlp, extended: bool) -> Multipliers | None:
    """Return multipliers of an earlier solution of the same NLP, or of one nearby; those of added rows are zero.

    Far from the earlier problem, its multipliers and their small barrier take more iterations than a cold start.
    """
    if not isinstance(guess, Solution) or guess.multipliers is None or not guess.success:
        return None
    same = guess.problem is nlp.problem
    if not same and _broken_by(nlp) > NEAR:
        return None
    known, sizes = guess.multipliers, (len(nlp.rows), len(nlp.variables))
    more = sizes[0] - known.sizes[0], sizes[1] - known.sizes[1]
    if min(more) >= 0 and (extended or more == (0, 0)):
        return lengthened(known, nlp)
    if not same:
        return None
    from robotraj.solution.costates.multiplier_transfer import transfer

    estimated = transfer(guess.duals, nlp)
    if estimated is None:
        # The solver that keeps its program interpolates the multipliers of limits itself.
        return known if known.origin is not None else None
    return LazyMultipliers(lambda: estimated.plain, (len(nlp.rows), len(nlp.variables)), known.origin)


def lengthened(known: Multipliers, nlp: Nlp) -> Multipliers:
    """Return multipliers with zeros for the rows and columns that were added last.

    They are computed when they are first read. Not every solver reads them, and they may take a further solve. Those of
    a larger NLP stay as they are.
    """
    if known.sizes[0] > len(nlp.rows) or known.sizes[1] > len(nlp.variables):
        return known
    return LazyMultipliers(partial(_extended, known, nlp), (len(nlp.rows), len(nlp.variables)), known.origin)


def _extended(known: Multipliers, nlp: Nlp) -> Multipliers:
    """Add zeros for the rows and columns that came last."""
    rows, bounds = np.zeros(len(nlp.rows)), np.zeros(len(nlp.variables))
    rows[: len(known.rows)], bounds[: len(known.bounds)] = known.rows, known.bounds
    return Multipliers(rows, bounds)


def separated_form(
    problem: Problem, mesh: Mesh | Sequence[Mesh], guess: InitialGuess | Solution | None
) -> tuple[Problem, tuple[Mesh, ...]] | None:
    """Return the problem and the meshes of the separated form.

    Returns
    -------
    (Problem, tuple of Mesh) or None
        None without a phase in compressed form, or if the guess is a solution on the same meshes.

    Raises
    ------
    InputError
        The problem is none for the compressed form.
    """
    meshes = meshes_of(problem, mesh)
    if not any(isinstance(scheme, CompressedHermiteSimpson) for own in meshes for scheme in own.given):
        return None
    if isinstance(guess, Solution) and tuple(part.mesh for part in guess.phases) == meshes:
        return None
    explicit(problem, meshes)  # raises before the first solve
    return problem, tuple(map(_separated, meshes))


def _separated(mesh: Mesh) -> Mesh:
    schemes = [scheme.separated if isinstance(scheme, CompressedHermiteSimpson) else scheme for scheme in mesh.given]
    return replace(mesh, scheme=schemes[0] if len(schemes) == 1 else tuple(schemes))
