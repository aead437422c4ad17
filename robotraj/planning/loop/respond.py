"""What follows from what a solve lacks: the next state of a plan, or its end.

A first, coarse mesh approximates the motion, and a second one finds its optimum. The order of the scheme predicts the
mesh that is needed, from the errors of the intervals and from the change of the objective. Where a finer mesh is not
solved, a first one takes iterations without end, or errors stagnate, controls of systems become lines. Where that does
not help either, and the solution on the coarse mesh is no motion, the plan begins again from its guess. A motion that
is proved gets knots where bounded rates jump, smoother controls where they alternate, and is solved once more from
itself where the solver stopped early. Nothing is solved here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from robotraj.fixed_mesh.between.clearing import ROUGH_SHORTFALL
from robotraj.guess.paths.scene import RESOLUTION
from robotraj.planning.loop.gauss_sums import summed
from robotraj.planning.loop.local_optimum import can_be_solved_again
from robotraj.planning.loop.measures import LEAST_GROWTH, largest_roughness
from robotraj.planning.loop.state import Found, MeasuredMotion, Meshes, PlanEnd, PlanState, Task
from robotraj.planning.loop.to_tolerance import SPENT, after_errors
from robotraj.planning.loop.tolerance_state import ToleranceState
from robotraj.planning.proving.soft_friction import factor_of, nearer
from robotraj.solution.claims.objective_size import objective_size, size_for
from robotraj.solution.conflict import are_clear
from robotraj.solution.solution import Solution
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.solvers.status import Status
from robotraj.transcription.refinement.equidistribution import evenly_finer
from robotraj.transcription.refinement.linear_controls import HARDLY, on_lines
from robotraj.transcription.refinement.switches import switches, with_knots_at

MOST_MESHES = 8
"""Largest number of meshes of a plan."""
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
SMOOTHER = 6.0
"""Factor on the weight of smooth torques where they alternate with the mesh nevertheless."""


def respond(state: PlanState | ToleranceState, found: Found) -> PlanState | ToleranceState | PlanEnd:
    """Return the state that follows from what a solve found, or the end of the plan."""
    if isinstance(state, ToleranceState):
        return after_errors(state, found)
    return _RESPONSES[state.task](state, found)


def is_enough(state: PlanState) -> bool:
    """Whether the next mesh is the last one for a motion whose objective alone has not settled."""
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
    lines, first = on_lines(state.problem, state.coarsest), state.approximates
    # Free controls may exploit the program of a coarse mesh.
    endless = failed.iterations >= InteriorPoint.max_iterations and lines != state.coarsest
    if (not first or endless) and failed.status not in SPENT:
        calmer = on_lines(state.problem, state.meshes)
        if calmer != state.meshes:
            return replace(state, meshes=calmer, why="controls as lines")
    ended = state.afresh or failed.status in (SPENT if endless else LIMITS_OF_THE_USER)
    if not ended and state.best is not None and not state.best.holds:
        # A finer mesh has no solution near that of a coarse one, which is no motion.
        return _afresh(
            state, tuple(evenly_finer(mesh, LEAST_GROWTH) for mesh in (lines if endless else state.coarsest))
        )
    if not first or failed.status in LIMITS_OF_THE_USER or are_clear(failed.conflicts):
        return PlanEnd(state, failed.status.value)
    meshes = tuple(evenly_finer(mesh, max(state.second, LEAST_GROWTH)) for mesh in state.meshes)
    return replace(state, meshes=meshes, why=_counted(meshes))


def _afresh(state: PlanState, meshes: Meshes) -> PlanState:
    """Return the state that begins again from the guess of the plan."""
    why = f"begin again from the guess on {_counted(meshes)}"
    return replace(state, best=None, first=None, afresh=True, meshes=meshes, why=why)


def _finer(state: PlanState) -> PlanState | PlanEnd:
    """Return a state with the meshes that the measures of the best motion need; the end where they need no others."""
    best, refinement, first = state.best, state.settings.refinement, state.approximates
    assert best is not None and refinement is not None
    proof, measures = best.proof, best.measures
    if measures.rounded > proof.goals.objective and state.problem is not state.sharp:
        return replace(state, problem=state.sharp, meshes=best.meshes, why="kinks without rounding")
    if any(phase.path is not None for phase in state.problem.phases) and proof.shortfall > RESOLUTION:
        return PlanEnd(state, "a moving obstacle is met on the path, which no finer mesh changes")
    if proof.motion_holds and proof.is_settled and not first:
        return PlanEnd(state, "")
    if first and proof.shortfall > ROUGH_SHORTFALL:
        # A motion that jumps over a shape between the points of a coarse mesh passes it on no finer one.
        return _afresh(state, tuple(evenly_finer(mesh, state.second) for mesh in state.coarsest))
    if is_enough(state) and best.holds and (state.traits.sticking_powers or not measures.settles):
        return PlanEnd(state, "enough meshes")
    phase = measures.stagnant
    stagnant = 0 if phase is None else state.stagnant + 1
    least, missed = state.second if first else 1.0, LEAST_GROWTH if stagnant else 1.0
    finer = measures.next_meshes(best.solution.phases, refinement, max(least, measures.growth), missed)
    if stagnant == 1 or measures.wanders or finer == best.meshes:
        # Where errors hardly fall, free controls may alternate.
        lines = on_lines(state.problem, finer)
        finer = tuple(lines[k] if k == phase or phase is None else each for k, each in enumerate(finer))
    if stagnant > 1 or finer == best.meshes:
        return PlanEnd(state, "errors stagnate")
    return replace(state, meshes=finer, stagnant=stagnant, why=_change(best.meshes, finer))


def _concluded(end: PlanEnd) -> PlanState | PlanEnd:
    """Return the solve that a plan still needs where its meshes end; without one, the end."""
    state = end.state
    assert isinstance(state, PlanState)
    best = state.best
    if best is None:
        return end
    if best.holds:
        return _polished(state, Task.SWITCHES, end.why)
    if not best.limited:
        return replace(state, task=Task.LIMITS, meshes=best.meshes, why=Task.LIMITS.value)
    return end


def _after_limits(state: PlanState, found: Found) -> PlanEnd:
    """Keep a solution with limits between its points in place of the one without."""
    motion = found.motion
    if motion is not None:
        state = replace(state, best=motion, steps=(*state.steps[:-1], motion.step))
    return PlanEnd(state, "")


def _polished(state: PlanState, task: Task, why: str = "") -> PlanState | PlanEnd:
    """Return the state of the first of the last solves, from a task on, that a proved motion needs; else the end."""
    best = state.best
    assert best is not None
    if task is Task.SWITCHES:
        parts = best.solution.phases
        meshes = tuple(with_knots_at(part.mesh, switches(part.phase, part.trajectory)) for part in parts)
        if meshes == best.meshes:
            return _polished(state, Task.SMOOTHER, why)
    elif task is Task.SMOOTHER:
        meshes, smoothing = best.meshes, state.settings.smoothing
        if best.measures.proof.is_smooth or not smoothing:
            return _polished(state, Task.AGAIN, why)
        state = replace(state, settings=replace(state.settings, smoothing=min(1.0, SMOOTHER * smoothing)))
    else:
        first, meshes = state.first, best.meshes
        repeatable = first is not None and can_be_solved_again(first.solution)
        if not (repeatable and best.stopped_early and best.proof.holds) or best.measures.before is None:
            return PlanEnd(state, why)
    return replace(state, task=task, meshes=meshes, why=task.value)


def _after_switches(state: PlanState, found: Found) -> PlanState | PlanEnd:
    best, motion = state.best, found.motion
    assert best is not None
    if motion is not None and motion.solution.objective < best.solution.objective:
        state = _replaced(state, best, motion)
    if state.best is best or state.number == MOST_MESHES - 1:
        return _polished(state, Task.SMOOTHER)
    # With knots at some jumps, the rate is constant beside others.
    return _polished(replace(state, number=state.number + 1), Task.SWITCHES)


def _after_smoother(state: PlanState, found: Found) -> PlanState | PlanEnd:
    best, motion = state.best, found.motion
    assert best is not None
    before, goals = best.solution.objective, best.proof.goals
    if motion is not None and motion.solution.objective <= before + goals.objective * abs(before):
        rougher = largest_roughness(motion.solution.phases) >= best.measures.proof.roughness
        state = state if rougher else _replaced(state, best, motion)
    # Where a finer mesh has not helped, another one does not either.
    known = best.measures.proof.roughness
    finer = _refined_at_teeth(state, known) if state.best is not best or state.meshes == best.meshes else None
    return finer or _polished(state, Task.AGAIN)


def _refined_at_teeth(state: PlanState, before: float) -> PlanState | None:
    """Return the state with a mesh that is finer where a control has teeth; None without such a mesh.

    Where the last solve has hardly changed their height, free controls become lines.
    """
    best, refinement = state.best, state.settings.refinement
    assert best is not None and refinement is not None
    proof = best.measures.proof
    if proof.is_smooth or state.number == MOST_MESHES - 1:
        return None
    meshes = best.measures.next_meshes(best.solution.phases, refinement, 1.0)
    if state.meshes == best.meshes and before > proof.roughness > HARDLY * before:
        meshes = on_lines(state.problem, meshes)
    finer = replace(state, meshes=meshes, number=state.number + 1, why=_change(best.meshes, meshes))
    return None if meshes == best.meshes else finer


def _replaced(state: PlanState, best: MeasuredMotion, motion: MeasuredMotion) -> PlanState:
    """Take a proved motion on other meshes for the best one, unless more may be left to gain than before."""
    before, known, goal = best.solution.objective, best.measures.proof.unsettled, best.proof.goals.objective
    # What is left to gain is no more than before, apart from what the motion lost.
    lost = max(0.0, motion.solution.objective - before)
    left = lost / size_for(lost, goal, motion.solution.phases, before) + min(motion.proof.unsettled, known)
    if not motion.holds or left > max(known, goal):
        return state
    return replace(state, best=motion.with_unsettled(left), steps=(*state.steps, motion.step))


def _after_again(state: PlanState, found: Found) -> PlanState | PlanEnd:
    """Solve a gain of the first mesh on the meshes of the plan, too: a coarse mesh may only gain between its points."""
    if not found.lacks:
        return PlanEnd(state, "")
    return replace(state, task=Task.BETTER, start=found.solution, gained=found.gained, why=Task.BETTER.value)


def _after_better(state: PlanState, found: Found) -> PlanEnd:
    """Take the better motion, if it is one. Where it is not found, the objective has not settled."""
    best, motion, coarse = state.best, found.motion, state.start
    assert best is not None and coarse is not None
    size = objective_size(best.solution.phases, best.solution.objective)
    if motion is None:
        return PlanEnd(replace(state, best=best.with_unsettled(state.gained)), "")
    if best.solution.objective - motion.solution.objective > best.proof.goals.objective * size and motion.holds:
        left = max(best.proof.unsettled, (motion.solution.objective - coarse.objective) / size)
        state = replace(state, best=motion.with_unsettled(left), steps=(*state.steps, motion.step))
    return PlanEnd(state, "")


def _change(before: Meshes, meshes: Meshes) -> str:
    schemes = [mesh.given for mesh in before] != [mesh.given for mesh in meshes]
    return _counted(meshes) + (", controls as lines" if schemes else "")


def _counted(meshes: Meshes) -> str:
    return f"{sum(mesh.count for mesh in meshes)} intervals"


_RESPONSES: Mapping[Task, Callable[[PlanState, Found], PlanState | PlanEnd]] = {
    Task.SOFTER: _after_softer,
    Task.MESH: _after_mesh,
    Task.LIMITS: _after_limits,
    Task.SWITCHES: _after_switches,
    Task.SMOOTHER: _after_smoother,
    Task.AGAIN: _after_again,
    Task.BETTER: _after_better,
}
