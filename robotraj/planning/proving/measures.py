"""Measures of a plan between its collocation points, and the next meshes that follow from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from robotraj._util.values import dataclass
from robotraj.problem.objectives.base import Integral
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.proof import Goals, Proof
from robotraj.solution.solution import Solution
from robotraj.transcription.interval_limits.interval_violations import variable_violations
from robotraj.transcription.refinement.assess import errors_of
from robotraj.transcription.refinement.objective_quadrature import quadrature_errors
from robotraj.transcription.refinement.path_violations import broken_rows
from robotraj.transcription.refinement.strategy import Assessment, Refinement
from robotraj.transcription.refinement.unresolved_controls import unresolved
from robotraj.transcription.schemes.mesh import Mesh

Array = NDArray[np.float64]

ORDER, ORDER_OF_ENDS = 2.0, 1.5
"""Powers of the number of intervals by which an objective nears its optimum: with integrals, and of the ends alone.

Least time leaves controls at their limits, with switches inside intervals. Compared with meshes four times as fine,
what is left of least times of arms falls with a power between 1 and 2, of integrals of squared torques above 2.
"""
SMALL = 1e-2
"""Objectives below this settle to the goal times this, not to the goal times themselves."""
LEAST_GROWTH, MOST_GROWTH = 1.5, 4.0
"""How many times as many intervals the next mesh has, for the sake of the objective."""
CLEARLY = 1.4
"""Ratio of the numbers of intervals of two meshes whose objectives are compared."""
SAFETY = 1.1
"""Factor on the growth that the order of the objective predicts."""


@dataclass(frozen=True, eq=False)
class Measured:
    """A proof with what the next mesh needs of it.

    Attributes
    ----------
    proof : Proof
    objective : float
        Value of the objective along the motion, its integrals by Gauss's rule.
    intervals : int
        Of the phase with most intervals.
    before : Measured or None
        Of the mesh before.
    errors, broken : tuple of ndarray
        For each phase, of every interval (K,): the larger of its relative error and of the error of its part of the
        objective's integral, scaled to the same goal; relative violation of path rows.
    coarse: float
        What the controls' highest degree contributes to the objective, relative; 0 where it is not measured.
    order : float
        Power of the number of intervals by which the objective nears its optimum.
    """

    proof: Proof
    objective: float
    intervals: int
    before: Measured | None
    errors: tuple[Array, ...]
    broken: tuple[Array, ...]
    coarse: float
    order: float

    def next_meshes(self, parts: Sequence[PhaseSolution], refinement: Refinement, growth: float) -> tuple[Mesh, ...]:
        """Refine the mesh of every phase so that the goals should hold, by at least ``growth``."""
        seen = zip(parts, self.errors, self.broken, strict=True)
        return tuple(
            refinement.refine(part.mesh, _assessment(errors, broken, growth), self.proof.goals.error)
            for part, errors, broken in seen
        )

    def with_violations(self, solution: Solution) -> Measured:
        """Return the measures with the excess over limits that a solution of the same motion lists."""
        between = (*solution.interval_violations, *solution.control_interval_violations)
        excess = [violation.relative for violation in between if violation.name != "clearance"]
        shortfall = max((violation.amount for violation in between if violation.name == "clearance"), default=0.0)
        excess += [float(rows.max()) for rows in self.broken]
        return replace(self, proof=replace(self.proof, excess=max(0.0, *excess), shortfall=shortfall))

    @property
    def growth(self) -> float:
        """Factor by which the number of intervals must grow for the objective to settle; 1 where it has settled."""
        proof = self.proof
        left = max(proof.quadrature, proof.unsettled) / proof.goals.objective
        if left <= 1.0:
            return 1.0
        if not np.isfinite(left):
            return LEAST_GROWTH
        if self.coarse:
            # Intervals are added where the controls bend, and only as many elsewhere as a comparison needs.
            return CLEARLY
        return float(np.clip(SAFETY * left ** (1.0 / self.order), LEAST_GROWTH, MOST_GROWTH))


def measured(solution: Solution, before: Measured | None, goals: Goals, bending: bool = False) -> Measured:
    """Measure a solution between its collocation points, and its objective against that of meshes before.

    Parameters
    ----------
    solution : Solution
    before : Measured or None
    goals : Goals
    bending : bool
        Whether controls bend sharply in a few intervals, as torques do where joints stick and slide. The next mesh then
        has its intervals where their highest degree contributes to the objective.
    """
    parts = solution.phases
    count = max(part.mesh.count for part in parts)
    left = [quadrature_errors(p.phase, p.trajectory, p.mesh.schemes, p.inputs) for p in parts]
    true = solution.objective - float(sum(errors.sum() for errors in left))
    size = max(abs(true), SMALL)
    bends = tuple(
        unresolved(p.phase, p.trajectory, p.mesh.schemes, p.inputs) if bending else np.zeros(p.mesh.count)
        for p in parts
    )
    coarse = float(sum(each.sum() for each in bends)) / size
    terms = (term for part in parts if part.phase.objective for _, term in part.phase.objective.terms)
    order = ORDER if any(isinstance(term, Integral) for term in terms) else ORDER_OF_ENDS
    unsettled = np.inf
    coarser = before if bending else _coarser(before, count)
    if coarser is not None:
        gained = abs(coarser.objective - true) / size
        finer = max((count / coarser.intervals) ** order, coarser.coarse / coarse if coarse else 0.0)
        unsettled = gained / (finer - 1.0)
    errors = tuple(errors_of(p.phase, p.trajectory, p.mesh) for p in parts)
    # An interval's share of what the objective may err by counts as much as its error may.
    share = goals.error / (goals.objective * size) * sum(part.mesh.count for part in parts)
    needs = tuple(
        np.maximum(own, share * np.maximum(np.abs(of_objective), of_bends))
        for own, of_objective, of_bends in zip(errors, left, bends, strict=True)
    )
    broken = tuple(
        np.maximum(broken_rows(p.phase, p.trajectory, p.inputs), _beyond_limits(p, i)) for i, p in enumerate(parts)
    )
    quadrature = abs(solution.objective - true) / size
    proof = Proof(max(float(e.max()) for e in errors), 0.0, quadrature, unsettled, goals)
    return Measured(proof, true, count, before, needs, broken, coarse, order).with_violations(solution)


def _beyond_limits(part: PhaseSolution, index: int) -> Array:
    """Return the relative excess over limits of controls and accelerations on every interval, (K,)."""
    excess = np.zeros(part.mesh.count)
    for violation in variable_violations(part.phase, index, part.trajectory, part.inputs):
        excess[violation.interval] = max(excess[violation.interval], violation.amount / violation.row.size)
    return excess


def _coarser(before: Measured | None, count: int) -> Measured | None:
    """Return the last measures on a mesh so much coarser that the change of the objective bounds what is left of it.

    Where no mesh is, those of the coarsest.
    """
    while before is not None and before.before is not None and CLEARLY * before.intervals > count:
        before = before.before
    return before if before is not None and before.intervals < count else None


def _assessment(errors: Array, broken: Array, growth: float) -> Assessment:
    nothing = np.zeros(len(errors))
    return Assessment(errors, nothing, nothing, broken, True, nothing, growth)
