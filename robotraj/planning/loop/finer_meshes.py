"""The next meshes of a plan that is refined to a tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.precision import ROUND_OFF
from robotraj.planning.loop.tolerance_state import Errors
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution
from robotraj.transcription.refinement.base import Assessment, Refinement
from robotraj.transcription.refinement.equidistribution import LEAST_GROWTH, SAFETY
from robotraj.transcription.schemes.collocation import Collocation
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.schemes.onestep import OneStep

ROOM = 0.1
"""Largest relative change of the length of a moving interval from one mesh to the next."""


def finer_meshes(solution: Solution, errors: Errors, refinement: Refinement, barely_grown: bool) -> list[Mesh]:
    """Return the mesh of every phase that follows the mesh of a solution.

    While the objective changes, errors must be smaller than the tolerance. Where the meshes barely grow, the goal falls
    until they do: with an interval or two more, errors would stay the same for mesh after mesh. If the errors are small
    enough but ``refinement`` returns no finer mesh, the goal falls to round-off. Last, every interval whose knots are
    fixed is halved.
    """
    meshes, tolerance = [part.mesh for part in solution.phases], errors.tolerance
    is_met = errors.worst <= tolerance
    goal = max(SAFETY * errors.worst, ROUND_OFF) if is_met else tolerance
    while True:
        finer = _refined_to(solution, errors.assessments, refinement, tolerance, goal)
        enough = _has_grown(meshes, finer) if barely_grown else not is_met or _is_finer(meshes, finer)
        if enough or goal <= ROUND_OFF:
            break
        goal = max(SAFETY * goal, ROUND_OFF)
    if is_met and not _is_finer(meshes, finer):
        finer = [b if isinstance(b, MovingMesh) else _halved(a) for a, b in zip(meshes, finer, strict=True)]
    return finer


def split_where_broken(
    solution: Solution, assessments: Sequence[Assessment], refinement: Refinement, tolerance: float
) -> list[Mesh]:
    """Return meshes whose intervals are split where path rows are violated, as long as an objective changes."""
    rough = [replace(each, settled=False) for each in assessments]
    return _refined_to(solution, rough, refinement, tolerance, tolerance)


def _is_finer(before: Sequence[Mesh], after: Sequence[Mesh]) -> bool:
    """Whether meshes have more points and none has fewer; meshes whose knots move are ignored."""
    pairs = [(a, b) for a, b in zip(before, after, strict=True) if not isinstance(a, MovingMesh)]
    more = [_points(b) - _points(a) for a, b in pairs]
    return not more or (min(more) >= 0 and max(more) > 0)


def _has_grown(before: Sequence[Mesh], after: Sequence[Mesh]) -> bool:
    """Whether meshes have ``LEAST_GROWTH`` times as many points; true where all knots move."""
    pairs = [(a, b) for a, b in zip(before, after, strict=True) if not isinstance(a, MovingMesh)]
    return sum(_points(b) for _, b in pairs) >= LEAST_GROWTH * sum(_points(a) for a, _ in pairs)


def _points(mesh: Mesh) -> int:
    return sum(len(scheme.nodes) if isinstance(scheme, Collocation) else 1 for scheme in mesh.schemes)


def _halved(mesh: Mesh) -> Mesh:
    """Halve every interval, where errors are round-off and the objective has not settled.

    The residual does not measure the effect of control polynomials, Bernstein bounds and quadrature on the objective.
    """
    knots = np.interp(np.arange(2 * mesh.count + 1) / 2, np.arange(mesh.count + 1), mesh.knots)
    return Mesh(tuple(knots.tolist()), tuple(scheme for scheme in mesh.schemes for _ in range(2)))


def _is_integrated(part: PhaseSolution) -> bool:
    """Whether a scheme of one step integrates the phase; its intervals are split until the objective settles."""
    return any(isinstance(scheme, OneStep) for scheme in part.mesh.schemes)


def _refined_to(
    solution: Solution, assessments: Sequence[Assessment], refinement: Refinement, tolerance: float, goal: float
) -> list[Mesh]:
    """Refine the mesh of every phase to a goal, and meshes of schemes of one step to the tolerance."""
    pairs = zip(solution.phases, assessments, strict=True)
    return [_refined(part, own, refinement, tolerance if _is_integrated(part) else goal) for part, own in pairs]


def _refined(part: PhaseSolution, assessment: Assessment, refinement: Refinement, tolerance: float) -> Mesh:
    """Refine the mesh of a phase; moving knots start from their last places."""
    mesh = part.mesh
    if not isinstance(mesh, MovingMesh):
        return refinement.refine(mesh, assessment, tolerance)
    inner = (part.knots[1:-1] - part.t0) / part.duration
    refined = refinement.refine(Mesh((0.0, *inner, 1.0), mesh.schemes), assessment, tolerance)
    # Knots are near the switches by now and need little room.
    return MovingMesh(refined.intervals, refined.scheme, max(mesh.least, 1 - ROOM), min(mesh.most, 1 + ROOM))
