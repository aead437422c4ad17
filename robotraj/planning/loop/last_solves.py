"""The last solves of a motion that is proved: knots at switches, smoother controls, and a solve from the plan itself.

Each replaces the motion before it only where it is better, and is left out where a motion does not need it.
"""

from __future__ import annotations

from dataclasses import replace

from robotraj.planning.loop.local_optimum import can_be_solved_again
from robotraj.planning.loop.measures import largest_roughness
from robotraj.planning.loop.state import Found, MeasuredMotion, Meshes, PlanEnd, PlanState, Task
from robotraj.solution.claims.objective_size import objective_size, size_for
from robotraj.transcription.refinement.linear_controls import HARDLY, on_lines
from robotraj.transcription.refinement.switches import switches, with_knots_at

MOST_MESHES = 8
"""Largest number of meshes of a plan."""
SMOOTHER = 6.0
"""Factor on the weight of smooth torques where they alternate with the mesh nevertheless."""


def next_last_solve(state: PlanState, task: Task, why: str = "") -> PlanState | PlanEnd:
    """Return the state of the first of the last solves, from a task on, that a proved motion needs; else the end."""
    best = state.best
    assert best is not None
    if task is Task.SWITCHES:
        parts = best.solution.phases
        meshes = tuple(with_knots_at(part.mesh, switches(part.phase, part.trajectory)) for part in parts)
        if meshes == best.meshes:
            return next_last_solve(state, Task.SMOOTHER, why)
    elif task is Task.SMOOTHER:
        meshes, smoothing = best.meshes, state.settings.smoothing
        if best.measures.proof.is_smooth or not smoothing:
            return next_last_solve(state, Task.AGAIN, why)
        state = replace(state, settings=replace(state.settings, smoothing=min(1.0, SMOOTHER * smoothing)))
    else:
        first, meshes = state.first, best.meshes
        repeatable = first is not None and can_be_solved_again(first.solution)
        if not (repeatable and best.stopped_early and best.proof.holds) or best.measures.before is None:
            return PlanEnd(state, why)
    return replace(state, task=task, meshes=meshes, why=task.value)


def after_switches(state: PlanState, found: Found) -> PlanState | PlanEnd:
    """Take the motion with knots at the switches where it is better, and move them again while that helps."""
    best, motion = state.best, found.motion
    assert best is not None
    if motion is not None and motion.solution.objective < best.solution.objective:
        state = _replaced(state, best, motion)
    if state.best is best or state.number == MOST_MESHES - 1:
        return next_last_solve(state, Task.SMOOTHER)
    # With knots at some jumps, the rate is constant beside others.
    return next_last_solve(replace(state, number=state.number + 1), Task.SWITCHES)


def after_smoother(state: PlanState, found: Found) -> PlanState | PlanEnd:
    """Take the smoother motion where it costs no more than the goal; else refine the mesh where controls have teeth."""
    best, motion = state.best, found.motion
    assert best is not None
    before, goals = best.solution.objective, best.proof.goals
    if motion is not None and motion.solution.objective <= before + goals.objective * abs(before):
        rougher = largest_roughness(motion.solution.phases) >= best.measures.proof.roughness
        state = state if rougher else _replaced(state, best, motion)
    # Where a finer mesh has not helped, another one does not either.
    known = best.measures.proof.roughness
    finer = _refined_at_teeth(state, known) if state.best is not best or state.meshes == best.meshes else None
    return finer or next_last_solve(state, Task.AGAIN)


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
    finer = replace(state, meshes=meshes, number=state.number + 1, why=changed(best.meshes, meshes))
    return None if meshes == best.meshes else finer


def _replaced(state: PlanState, best: MeasuredMotion, motion: MeasuredMotion) -> PlanState:
    """Take a proved motion on other meshes for the best one, unless more may be left to gain than before."""
    before, known, goal = best.solution.objective, best.measures.proof.unsettled, best.proof.goals.objective
    # What is left to gain is no more than before, apart from what the motion lost.
    lost = max(0.0, motion.solution.objective - before)
    left = lost / size_for(lost, goal, motion.solution.phases, before) + min(motion.proof.unsettled, known)
    if not motion.motion_holds or left > max(known, goal):
        return state
    return replace(state, best=motion.with_unsettled(left), steps=(*state.steps, motion.step))


def after_again(state: PlanState, found: Found) -> PlanState | PlanEnd:
    """Solve a gain of the first mesh on the meshes of the plan, too: a coarse mesh may only gain between its points."""
    if not found.lacks:
        return PlanEnd(state, "")
    return replace(state, task=Task.BETTER, start=found.solution, gained=found.gained, why=Task.BETTER.value)


def after_better(state: PlanState, found: Found) -> PlanEnd:
    """Take the better motion, if it is one. Where it is not found, the objective has not settled."""
    best, motion, coarse = state.best, found.motion, state.start
    assert best is not None and coarse is not None
    size = objective_size(best.solution.phases, best.solution.objective)
    if motion is None:
        return PlanEnd(replace(state, best=best.with_unsettled(state.gained)), "")
    if best.solution.objective - motion.solution.objective > best.proof.goals.objective * size and motion.motion_holds:
        left = max(best.proof.unsettled, (motion.solution.objective - coarse.objective) / size)
        state = replace(state, best=motion.with_unsettled(left), steps=(*state.steps, motion.step))
    return PlanEnd(state, "")


def changed(before: Meshes, meshes: Meshes) -> str:
    """Return how meshes differ from those before, for the history."""
    schemes = [mesh.given for mesh in before] != [mesh.given for mesh in meshes]
    return counted(meshes) + (", controls as lines" if schemes else "")


def counted(meshes: Meshes) -> str:
    """Return the number of intervals of all phases, for the history."""
    return f"{sum(mesh.count for mesh in meshes)} intervals"
