"""What follows from what a solve lacks: the next state of a plan, or its end.

A first, coarse mesh approximates the motion, and a second one finds its optimum. The order of the scheme predicts the
mesh that is needed, from the errors of the intervals and from the change of the objective. Where a finer mesh is not
solved, a first one takes iterations without end, or errors stagnate, controls of systems become lines. Where that does
not help either, and the solution on the coarse mesh is no motion, the plan begins again from its guess. A motion that
is proved gets knots where bounded rates jump, smoother controls where they alternate, and is solved once more from
itself where the solver stopped early. Nothing is solved here.

The words of each response stand in ``solution.history``: "less soft friction" and "the robot's own friction" before the
first mesh, "48 intervals" for the next one, "kinks without rounding", "begin again from the guess", and those of
``Task`` for the last solves.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from robotraj.fixed_mesh.between.clearing import ROUGH_SHORTFALL
from robotraj.guess.paths.scene import RESOLUTION
from robotraj.planning.loop.gauss_sums import summed
from robotraj.planning.loop.last_solves import (
    MOST_MESHES,
    after_again,
    after_better,
    after_smoother,
    after_switches,
    changed,
    counted,
    next_last_solve,
)
from robotraj.planning.loop.measures import LEAST_GROWTH
from robotraj.planning.loop.state import Found, Meshes, PlanEnd, PlanState, Task
from robotraj.planning.loop.to_tolerance import SPENT, after_errors
from robotraj.planning.loop.tolerance_state import ToleranceState
from robotraj.planning.proving.soft_friction import factor_of, nearer
from robotraj.solution.conflict import are_clear
from robotraj.solution.solution import Solution
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.equidistribution import evenly_finer
from robotraj.transcription.refinement.linear_controls import on_lines

ENOUGH = 4
"""Meshes after which a proved motion whose objective has not settled gets a finer one only where the last one settled
it further, unless joints stick and slide."""
ENOUGH_OF_POWERS = 3
"""The same where joints stick and slide and the objective has kinks. It does not settle on some motions, whatever the
mesh, and limits between the points are imposed from the second mesh on."""
LIMITS_OF_THE_USER = (Status.ITERATION_LIMIT, *SPENT)
"""Statuses after which no finer mesh is tried."""
SOFTER = 1.25
"""Least growth of the number of intervals from one soft friction to the next, less soft one."""


def respond(state: PlanState | ToleranceState, found: Found) -> PlanState | ToleranceState | PlanEnd:
    """Return the state that follows from what a solve found, or the end of the plan."""
    if isinstance(state, ToleranceState):
        return after_errors(state, found)
    return _RESPONSES[state.task](state, found)


def is_enough(state: PlanState) -> bool:
    """Whether the mesh of a state is the last one for a motion whose objective alone has not settled."""
    most = ENOUGH_OF_POWERS if state.traits.sticking_powers else ENOUGH
    return state.number >= most - 1 and not state.traits.patient


def is_limited(state: PlanState) -> bool:
    """Whether limits are imposed between the points of the next mesh, however far from settled its solution is."""
    if state.task is not Task.MESH:
        return True
    powers = state.traits.sticking_powers and state.best is not None
    return powers or is_enough(state) or state.number == MOST_MESHES - 1


def own_friction(state: PlanState) -> PlanState:
    """Return the state whose robots have their own friction, on the meshes of the last softer one."""
    return replace(state, task=Task.MESH, softening=(), why="the robot's own friction")


def _after_softer(state: PlanState, found: Found) -> PlanState | PlanEnd:
    soft, refinement = found.solution, state.settings.refinement
    if found.lacks:
        # Links overlap: ``prove`` looks for a way around itself first, and plans from there.
        return PlanEnd(replace(state, failed=soft), "")
    between = None if soft.success else nearer(state.softening[0], state.guess)
    if between is not None:
        return replace(state, softening=(between, *state.softening), why="a smaller step to less soft friction")
    if found.measures is not None and refinement is not None:
        # Torques bend more sharply with less soft friction.
        meshes = found.measures.next_meshes(soft.phases, refinement, SOFTER)
        state = replace(state, guess=soft, meshes=meshes, second=LEAST_GROWTH)
    # Where the smallest step from a solution fails, the next one, from the same solution, has failed or is larger.
    is_over = found.measures is None and (are_clear(soft.conflicts) or factor_of(state.guess) > 0.0)
    left = () if is_over else state.softening[1:]
    return replace(state, softening=left, why="less soft friction") if left else own_friction(state)


def _after_mesh(state: PlanState, found: Found) -> PlanState | PlanEnd:
    motion = found.motion
    if motion is None:
        state = replace(state, failed=found.solution)
        following = _after_failure(state, found.solution)
    else:
        steps = (*state.steps, motion.step)
        on_gauss = summed(replace(state, steps=steps), motion)
        if on_gauss is not None:
            return on_gauss
        following = _finer(replace(state, best=motion, first=state.first or motion, steps=steps))
    if isinstance(following, PlanEnd):
        return _concluded(following)
    if following.number == MOST_MESHES - 1:
        return _concluded(PlanEnd(following, f"{MOST_MESHES} meshes"))
    return replace(following, number=following.number + 1)


def _after_failure(state: PlanState, failed: Solution) -> PlanState | PlanEnd:
    """Return a state with the meshes to try after some that could not be solved; the end where none would help."""
    if state.is_brief:
        return PlanEnd(state, failed.status.value)
    lines, approximates = on_lines(state.problem, state.coarsest), state.approximates
    # Free controls may exploit the program of a coarse mesh.
    endless = failed.iterations >= InteriorPoint.max_iterations and lines != state.coarsest
    if (not approximates or endless) and failed.status not in SPENT:
        calmer = on_lines(state.problem, state.meshes)
        if calmer != state.meshes:
            return replace(state, meshes=calmer, why="controls as lines")
    final = SPENT if endless else LIMITS_OF_THE_USER
    may_begin_again = not state.afresh and failed.status not in final
    if may_begin_again and state.best is not None and not state.best.motion_holds:
        # A finer mesh has no solution near that of a coarse one, which is no motion.
        return _afresh(
            state, tuple(evenly_finer(mesh, LEAST_GROWTH) for mesh in (lines if endless else state.coarsest))
        )
    if not approximates or failed.status in LIMITS_OF_THE_USER or are_clear(failed.conflicts):
        return PlanEnd(state, failed.status.value)
    meshes = tuple(evenly_finer(mesh, max(state.second, LEAST_GROWTH)) for mesh in state.meshes)
    return replace(state, meshes=meshes, why=counted(meshes))


def _afresh(state: PlanState, meshes: Meshes) -> PlanState:
    """Return the state that begins again from the guess of the plan."""
    why = f"begin again from the guess on {counted(meshes)}"
    return replace(state, best=None, first=None, afresh=True, meshes=meshes, why=why)


def _finer(state: PlanState) -> PlanState | PlanEnd:
    """Return a state with the meshes that the measures of the best motion need; the end where they need no others."""
    best, refinement, approximates = state.best, state.settings.refinement, state.approximates
    assert best is not None and refinement is not None
    proof, measures = best.proof, best.measures
    if measures.rounded > proof.goals.objective and state.problem is not state.sharp:
        return replace(state, problem=state.sharp, meshes=best.meshes, why="kinks without rounding")
    if any(phase.path is not None for phase in state.problem.phases) and proof.shortfall > RESOLUTION:
        return PlanEnd(state, "a moving obstacle is met on the path, which no finer mesh changes")
    if best.motion_holds and proof.is_settled and not approximates:
        return PlanEnd(state, "")
    if approximates and proof.shortfall > ROUGH_SHORTFALL:
        # A motion that jumps over a shape between the points of a coarse mesh passes it on no finer one.
        return _afresh(state, tuple(evenly_finer(mesh, state.second) for mesh in state.coarsest))
    if is_enough(state) and best.motion_holds and (state.traits.sticking_powers or not measures.settles):
        return PlanEnd(state, "enough meshes")
    phase = measures.stagnant
    stagnant = 0 if phase is None else state.stagnant + 1
    least, missed = state.second if approximates else 1.0, LEAST_GROWTH if stagnant else 1.0
    finer = measures.next_meshes(best.solution.phases, refinement, max(least, measures.growth), missed)
    if stagnant == 1 or measures.wanders or finer == best.meshes:
        # Where errors hardly fall, free controls may alternate.
        lines = on_lines(state.problem, finer)
        finer = tuple(lines[k] if k == phase or phase is None else each for k, each in enumerate(finer))
    if stagnant > 1 or finer == best.meshes:
        return PlanEnd(state, "errors stagnate")
    return replace(state, meshes=finer, stagnant=stagnant, why=changed(best.meshes, finer))


def _concluded(end: PlanEnd) -> PlanState | PlanEnd:
    """Return the solve that a plan still needs where its meshes end; without one, the end."""
    state = end.state
    assert isinstance(state, PlanState)
    best = state.best
    if best is None:
        return end
    if best.motion_holds:
        return next_last_solve(state, Task.SWITCHES, end.why)
    if not best.limited:
        return replace(state, task=Task.LIMITS, meshes=best.meshes, why=Task.LIMITS.value)
    return end


def _after_limits(state: PlanState, found: Found) -> PlanEnd:
    """Keep a solution with limits between its points in place of the one without."""
    motion = found.motion
    if motion is not None:
        state = replace(state, best=motion, steps=(*state.steps[:-1], motion.step))
    return PlanEnd(state, "")


_RESPONSES: Mapping[Task, Callable[[PlanState, Found], PlanState | PlanEnd]] = {
    Task.SOFTER: _after_softer,
    Task.MESH: _after_mesh,
    Task.LIMITS: _after_limits,
    Task.SWITCHES: after_switches,
    Task.SMOOTHER: after_smoother,
    Task.AGAIN: after_again,
    Task.BETTER: after_better,
}
