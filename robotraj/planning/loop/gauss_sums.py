"""Gauss's rule for the objective, where Simpson's misses the integral that it should minimise.

Along a motion that is exact between its points (``exact_motion``) accelerations have degree 2 on an interval, and the
squares of torques degree 4 and more. Simpson's rule integrates degree 3: as soon as inertias vary over an interval,
light joints that swing between the points lower the sum of large torques elsewhere, on every finer mesh anew. Gauss's
rule with three points integrates degree 5. Joined at the knots, its motions are those of Hermite-Simpson.
"""

from __future__ import annotations

from dataclasses import replace

from robotraj.fixed_mesh.between.clearing import ROUGH_SHORTFALL
from robotraj.planning.loop.state import MeasuredMotion, PlanState
from robotraj.problem.problem import Problem
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.refinement.equidistribution import evenly_finer
from robotraj.transcription.schemes.gauss import GaussLegendre
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh

JOINED = GaussLegendre(3, joined=True)
"""Three points of Gauss's rule, with accelerations that are continuous at the knots."""
FAR = 5e-2
"""Share of the objective by which the sum on the first mesh misses the integral, above which it is no guide."""
PLACES = len(JOINED.nodes) / len(HermiteSimpson().nodes[1:])
"""Points of an interval in terms of those of Hermite-Simpson, which share the knots."""


def by_gauss(problem: Problem, meshes: tuple[Mesh, ...]) -> tuple[Mesh, ...]:
    """Replace Hermite-Simpson by ``JOINED`` with as many points, on phases whose motions are exact."""
    return tuple(
        replace(evenly_finer(mesh, 1.0 / PLACES), scheme=JOINED)
        if mesh.given == (HermiteSimpson(),) and is_exact(phase, mesh.given)
        else mesh
        for phase, mesh in zip(problem.phases, meshes, strict=True)
    )


def summed(state: PlanState, motion: MeasuredMotion) -> PlanState | None:
    """Return the state with other first meshes, whose sum is the integral that a motion has missed; it is the guess.

    None where the sum is near, on later meshes, and where the motion jumps over a shape and is left for the guess.
    """
    meshes, proof = by_gauss(state.problem, motion.meshes), motion.proof
    if not state.approximates or proof.quadrature <= FAR or proof.shortfall > ROUGH_SHORTFALL:
        return None
    if meshes == motion.meshes:
        return None
    settings = replace(state.settings, mesh=meshes)
    return replace(state, settings=settings, guess=motion.solution, meshes=meshes, why="Gauss's rule for the objective")
