"""Measures of a plan between its collocation points, and the next meshes that follow from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.teeth import SMOOTH
from robotraj._util.values import dataclass
from robotraj.fixed_mesh.sizes.shares import shares_of
from robotraj.problem.initial_guess import InitialGuess
from robotraj.solution.claims.objective_size import size_for
from robotraj.solution.phase_solution import PhaseSolution, alike
from robotraj.solution.proof import Goals, Proof
from robotraj.solution.solution import Solution
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.refinement.assess import control_jumps, errors_of, path_bends
from robotraj.transcription.refinement.base import Assessment, Refinement
from robotraj.transcription.refinement.equidistribution import Equidistribute
from robotraj.transcription.refinement.linear_controls import HARDLY
from robotraj.transcription.refinement.objective_quadrature import quadrature_errors, surplus
from robotraj.transcription.refinement.path_violations import beyond_limits, broken_rows
from robotraj.transcription.refinement.unresolved_controls import unresolved
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.smoothness.roughness import rough_intervals, roughness

ORDER, ORDER_OF_ENDS, ORDER_OF_SWITCHES = 2.0, 1.5, 1.0
"""Orders of convergence of an objective in the number of intervals: with integrals, and of the ends alone.

In least time controls stay at their limits and switch inside intervals. The first two orders were measured with arms,
against meshes four times as fine: between 1 and 2 for least times, above 2 for integrals of squared torques. The last
is that of systems whose controls are unknowns of their own, where a switch costs a share of its interval.
"""
SAFETY = 1.5
"""Factor on the growth that the order of the objective predicts.

With 1.1 least times mostly missed their goal by little and needed a fourth mesh: arms took up to half as long again.
"""
LEAST_GROWTH = SAFETY
"""Least growth, also that of a mesh that could not be solved, and of phases where an error stagnates."""


@dataclass(frozen=True, eq=False)
class Measured:
    """Measures of a solution, from which the proof and the next mesh follow.

    Attributes
    ----------
    proof : Proof
    objective : float
        Value of the objective along the motion, its integrals by Gauss's rule.
    meshes : tuple of Mesh
    local : tuple of ndarray (K,)
        For each phase, the relative error of every interval.
    before : Measured or None
        Measures on the mesh before.
    errors : tuple of ndarray (K,)
        For each phase, the largest of the relative error of every interval, that of the objective's integral and the
        teeth of its controls, scaled to the same goal.
    broken : tuple of ndarray (K,)
        For each phase, the relative violation of path rows on every interval.
    coarse : float
        Relative contribution of the controls' highest degree to the objective; 0 where it is not measured.
    order : float
        Order of convergence of the objective in the number of intervals.
    rounded : float
        Share of the objective that the sum at the points leaves out where kinks are rounded.
    """

    proof: Proof
    objective: float
    meshes: tuple[Mesh, ...]
    local: tuple[Array, ...]
    before: Measured | None
    errors: tuple[Array, ...]
    broken: tuple[Array, ...]
    coarse: float
    order: float
    rounded: float = 0.0

    def next_meshes(
        self, parts: Sequence[PhaseSolution], refinement: Refinement, growth: float, missed: float = 1.0
    ) -> tuple[Mesh, ...]:
        """Refine the mesh of every phase to the goals, with at least ``growth`` times as many intervals.

        Phases that miss a goal get at least ``missed`` times as many.
        """
        goal = self.proof.goals.error
        return tuple(
            refinement.refine(
                part.mesh,
                _assessment(part, errors, broken, max(growth, missed) if errors.max() > goal else growth),
                goal,
            )
            for part, errors, broken in zip(parts, self.errors, self.broken, strict=True)
        )

    def with_violations(self, solution: Solution) -> Measured:
        """Return the measures with the excess over limits that a solution of the same motion has."""
        between = (*solution.interval_violations, *solution.control_interval_violations)
        excess = [violation.relative for violation in between if violation.name != "clearance"]
        shortfall = max((violation.amount for violation in between if violation.name == "clearance"), default=0.0)
        excess += [float(rows.max()) for rows in self.broken]
        return replace(self, proof=replace(self.proof, excess=max(0.0, *excess), shortfall=shortfall))

    @property
    def only_unsettled(self) -> bool:
        """Whether the motion is proved on a second mesh or a later one, and only its objective may not have settled."""
        return self.before is not None and self.proof.motion_holds

    @property
    def intervals(self) -> int:
        """Number of intervals of the phase with most of them."""
        return max(mesh.count for mesh in self.meshes)

    @property
    def stagnant(self) -> int | None:
        """Phase whose largest error exceeds its goal, as the one at its place did before, and hardly fell.

        Where a motion changes from mesh to mesh, its errors move: the largest one may fall fivefold and still exceed
        the one that was at its place before.
        """
        goal, phase = self.proof.goals.error, int(np.argmax([errors.max() for errors in self.local]))
        if self.before is None or self.local[phase].max() <= goal:
            return None
        worst = int(np.argmax(self.local[phase]))
        begin, end = self.meshes[phase].knots[worst : worst + 2]
        knots = self.before.meshes[phase].knots
        before, now = self.before.local[phase], self.local[phase][worst]
        there = before[(knots[:-1] < end) & (knots[1:] > begin)].max()
        return phase if there > goal and now > HARDLY * before.max() else None

    @property
    def settles(self) -> bool:
        """Whether what the objective may still gain fell clearly on the last mesh."""
        return self.before is not None and self.proof.unsettled < HARDLY * self.before.proof.unsettled

    @property
    def wanders(self) -> bool:
        """Whether the largest error exceeds its goal and hardly fell on two meshes in a row, wherever it is."""
        before = self.before
        if before is None or before.before is None or self.proof.error <= self.proof.goals.error:
            return False
        last, first = before.proof.error, before.before.proof.error
        return self.proof.error > HARDLY * last and last > HARDLY * first

    @property
    def growth(self) -> float:
        """Factor by which the number of intervals must grow for the objective to settle; 1 where it has settled."""
        proof = self.proof
        left = max(proof.quadrature, proof.unsettled) / proof.goals.objective
        if left <= 1.0:
            return 1.0
        # Where the next mesh adds its intervals where controls bend, the comparison of objectives needs few others.
        if self.coarse or not np.isfinite(left):
            return LEAST_GROWTH
        return float(np.clip(SAFETY * left ** (1.0 / self.order), LEAST_GROWTH, Equidistribute.most))


def measured(
    solution: Solution, before: Measured | None, goals: Goals, bending: bool = False, expected: float = np.inf
) -> Measured:
    """Measure a solution between its collocation points, and compare its objective with those of meshes before.

    Parameters
    ----------
    solution : Solution
    before : Measured or None
        Measures on the mesh before.
    goals : Goals
    bending : bool
        Whether controls bend sharply in a few intervals, as torques do where joints stick and slide. The next mesh then
        has its intervals where their highest degree contributes to the objective. Motions on a path always bend so.
    expected : float
        Relative decrease of the objective to expect on finer meshes, if there is no coarser mesh to compare with.

    Returns
    -------
    Measured
    """
    parts = solution.phases
    count = max(part.mesh.count for part in parts)
    left = [quadrature_errors(p.phase, p.trajectory, p.mesh.schemes, p.inputs) for p in parts]
    true = solution.objective - float(sum(errors.sum() for errors in left))
    bends = tuple(_bends(part, bending) for part in parts)
    on_paths = all(part.phase.path is not None for part in parts)
    bending = bending or on_paths
    bent = float(sum(each.sum() for each in bends)) if bending else 0.0
    order = _order(solution)
    coarser, alike_meshes = (before, ()) if bending else _coarser(before, count, order)
    left_out = max(abs(solution.objective - true), bent, 0.0 if coarser is None else abs(coarser.objective - true))
    size = size_for(left_out, goals.objective, parts, true)
    coarse = bent / size
    unsettled = expected
    if coarser is not None:
        # A motion on another mesh as fine may show that more is to gain.
        best = min([true, *(each.objective for each in alike_meshes if each.proof.motion_holds)])
        gained = abs(coarser.objective - best) / size
        finer = max((count / coarser.intervals) ** order, coarser.coarse / coarse if coarse else 0.0)
        # The gain on finer meshes is unknown where this one is no finer than the last.
        unsettled = gained / (finer - 1.0) + (true - best) / size if finer > 1.0 else expected
    if on_paths:
        # The time that lines lose is estimated from this mesh alone, too.
        unsettled = max(unsettled, coarse)
    whole = sum(part.duration for part in parts)
    errors = tuple(errors_of(p.phase, p.trajectory, p.mesh, whole, _alike(p, parts)) for p in parts)
    # The error of the integral on an interval is scaled so that its goal is the same as that of the relative error.
    share = goals.error / (goals.objective * size) * sum(part.mesh.count for part in parts)
    # So are teeth, where the mesh is too coarse for controls that change fast.
    rough = [goals.error / SMOOTH * rough_intervals(p.phase, p.trajectory, p.inputs) for p in parts]
    needs = tuple(
        np.maximum.reduce([own, share * np.abs(of_objective), share * of_bends, of_teeth])
        for own, of_objective, of_bends, of_teeth in zip(errors, left, bends, rough, strict=True)
    )
    broken = tuple(
        np.maximum(
            *(measure(p.phase, p.trajectory, p.inputs, alike(p, parts)) for measure in (broken_rows, beyond_limits))
        )
        for p in parts
    )
    quadrature = abs(solution.objective - true) / size
    proof = Proof(
        max(float(e.max()) for e in errors), 0.0, quadrature, unsettled, goals, roughness=largest_roughness(parts)
    )
    meshes = tuple(part.mesh for part in parts)
    rounded = max(0.0, -sum(surplus(p.phase, p.trajectory, p.mesh.schemes) for p in parts)) / size
    found = Measured(proof, true, meshes, errors, before, needs, broken, coarse, order, rounded)
    return found.with_violations(solution)


def _alike(part: PhaseSolution, parts: Sequence[PhaseSolution]) -> list[PhaseTrajectory]:
    """Return the trajectories of all phases with the states of one."""
    states = part.phase.dae.states
    return [other.trajectory for other in parts if other.phase.dae.states == states]


def _order(solution: Solution) -> float:
    """Return the order of convergence of the objective in the number of intervals, between those of its terms."""
    of_ends = ORDER_OF_ENDS if all(part.exact for part in solution.phases) else ORDER_OF_SWITCHES
    return ORDER + (of_ends - ORDER) * shares_of(solution.problem).ends


def largest_roughness(parts: Sequence[PhaseSolution]) -> float:
    """Return the largest roughness of a control of any phase."""
    return max(float(roughness(part.phase, part.trajectory, part.inputs).max(initial=0.0)) for part in parts)


def proof_on(guess: InitialGuess | Solution | None, meshes: tuple[Mesh, ...]) -> Proof | None:
    """Return the proof of a solution on these meshes; None for any other guess."""
    if not isinstance(guess, Solution) or guess.proof is None or not guess.proof.holds:
        return None
    return guess.proof if tuple(part.mesh for part in guess.phases) == meshes else None


def _bends(part: PhaseSolution, bending: bool) -> Array:
    """Return the contribution to the objective of controls that the mesh does not resolve, (K,)."""
    if part.phase.path is not None:
        return path_bends(part.phase, part.trajectory)
    if not bending:
        return np.zeros(part.mesh.count)
    return unresolved(part.phase, part.trajectory, part.mesh.schemes, part.inputs)


def _coarser(before: Measured | None, count: int, order: float) -> tuple[Measured | None, tuple[Measured, ...]]:
    """Return the last measures on a mesh whose error is clearly larger, and those on meshes since, about as fine.

    Without one they are those on the coarsest mesh. The change of the objective from there bounds its remaining error.
    """
    since: tuple[Measured, ...] = ()
    while before is not None and before.before is not None and (before.intervals / count) ** order > HARDLY:
        before, since = before.before, (*since, before)
    return (before if before is not None and before.intervals < count else None), since


def _assessment(part: PhaseSolution, errors: Array, broken: Array, growth: float) -> Assessment:
    nothing = np.zeros(len(errors))
    # Errors of exact motions are those of the objective's integral, which do not depend on jumps of the torques.
    jumps = nothing if part.exact else control_jumps(part.trajectory)
    return Assessment(errors, jumps, nothing, broken, True, nothing, growth)
