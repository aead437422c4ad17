"""Why a plan failed: the conflicts of its limits.

The cheapest check comes first: slopes that are too steep and motions that are too fast for the friction, budgets below
the work that the ends take, zones that a state must cross, ends without a configuration. Then comes the relaxed problem
on a coarse mesh with the torques that hold the ends. Where that has a motion but the plan has none, a finer mesh
decides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj.dynamics.rigid_body import RigidBody
from robotraj.fixed_mesh.coarse import CoarseSolves
from robotraj.fixed_mesh.diagnosis.elastic import (
    ALONE,
    TOGETHER,
    relaxed_again,
    relaxed_motion,
    sufficient_durations,
)
from robotraj.fixed_mesh.diagnosis.exclusions.convexity import excluded_on_finer_mesh
from robotraj.fixed_mesh.diagnosis.exclusions.crossed_zones import crossed_zones
from robotraj.fixed_mesh.diagnosis.exclusions.rest_to_rest import slipping_motions
from robotraj.fixed_mesh.diagnosis.exclusions.slipping import slipping_contacts
from robotraj.fixed_mesh.diagnosis.exclusions.work_budgets import exceeded_budgets
from robotraj.fixed_mesh.diagnosis.rate_limits import wider_rates
from robotraj.fixed_mesh.diagnosis.relaxation.stated_values import sufficient
from robotraj.fixed_mesh.diagnosis.self_collision import SIZE
from robotraj.fixed_mesh.diagnosis.undefined import undefined_expression
from robotraj.fixed_mesh.diagnosis.unheld_ends import unheld_ends
from robotraj.fixed_mesh.diagnosis.unreached_ends import unreached_ends
from robotraj.guess.reaching.branches import nodes_of
from robotraj.guess.reaching.open_end import OpenEnd
from robotraj.problem.clearance.end_checks import clearances_of, distances_at_rest
from robotraj.problem.constraints.base import Where
from robotraj.problem.phase_row import Kind
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict, are_certain, are_clear
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.extract import PhaseTrajectory

UNEXPLAINED = (Status.INFEASIBLE, Status.STALLED, Status.ROWS_VIOLATED, Status.ITERATION_LIMIT, Status.DIVERGED)
"""Statuses for which the relaxed problem is solved."""


def against_balances(problem: Problem) -> tuple[Conflict, ...]:
    """Return the friction and the work that the balances of momentum and energy alone exclude, without a solve."""
    return slipping_contacts(problem) or slipping_motions(problem) or exceeded_budgets(problem)


def excluded(problem: Problem, near: Sequence[PhaseTrajectory] = ()) -> tuple[Conflict, ...]:
    """Return what balances, continuity and the ends exclude, without a solve; see ``unreached_ends`` for ``near``."""
    return against_balances(problem) or crossed_zones(problem) or unreached_ends(problem, near)


def completed(
    problem: Problem, conflicts: tuple[Conflict, ...], motion: Solution | None, coarse: CoarseSolves
) -> tuple[Conflict, ...]:
    """Add the durations that suffice, and prefer a limit of jerks or of rates of torques that must give less.

    Without a motion, the relaxed problem was not solved. Longer durations may suffice where no limit in conflict is
    one of positions alone.
    """
    if motion is not None and not conflicts:
        return ()
    rates, wider = wider_rates(problem, coarse, motion)
    if rates and all(rates[0].relative < conflict.relative for conflict in conflicts[:1]):
        conflicts, motion = rates, wider
    if motion is None:
        # Where the equations have no motion within the duration, no limit gives way.
        return conflicts or sufficient_durations(problem, coarse, None)
    if not all(_depends_on_rates(problem, conflict) for conflict in conflicts):
        return conflicts
    return (*conflicts, *sufficient_durations(problem, coarse, motion))


def _depends_on_rates(problem: Problem, conflict: Conflict) -> bool:
    """Whether a row in conflict holds along the motion and reads more than positions, as those of speeds do."""
    phase = next((each for each in problem.phases if each.name == conflict.phase), None)
    row = next((row for row in phase.rows if row.label == conflict.name), None) if phase is not None else None
    if phase is None or row is None or row.where in (Where.START, Where.END):
        return False
    if row.kind is Kind.RATE or not isinstance(phase.body, RigidBody):
        return True
    table = phase.rows
    positions = ca.vertcat(table.symbols[0], table.symbols[1][: phase.body.position_count], table.symbols[4])
    others = [symbol for symbol in ca.symvar(table.expressions((row,))[0]) if not ca.depends_on(positions, symbol)]
    return bool(others)


def explained(solution: Solution, coarse: CoarseSolves) -> Solution:
    """Return a failed solution with its cause: an undefined expression, conflicts of limits, or its mesh.

    A mesh may have no motion where the problem has one. The solver then finds it infeasible, and a motion of the
    relaxed problem meets every row on another mesh. That of a coarse mesh may be none between its points, so that
    limits are in conflict where a finer mesh has to relax them.

    The status is ``Status.INFEASIBLE`` only where conflicts exclude every motion. A local minimum of the relaxed
    problem does not: its rows are named as what may have to give, with ``Status.NOT_FOUND``.

    The stated values are those with which a brief solve finds a motion; see ``stated_values``.
    """
    if solution.success:
        return solution
    undefined = "" if are_certain(solution.conflicts) else undefined_expression(solution)
    if undefined:
        return replace(solution, message=f"{undefined} ({solution.message})", status=Status.INVALID_NUMBER)
    if solution.status is Status.NOT_PROVED:
        conflicts = crossed_zones(solution.problem)
        return replace(solution, conflicts=conflicts, status=Status.INFEASIBLE if conflicts else solution.status)
    if solution.status not in UNEXPLAINED:
        return solution
    found = solution if solution.conflicts else _with_cause(solution, coarse)
    excluded = _is_excluded(found, coarse)
    conflicts = _with_enough_time(found.conflicts, found.problem, coarse)
    status = Status.NOT_FOUND if found.status is Status.INFEASIBLE else found.status
    conflicts = sufficient(conflicts, found.problem, coarse, excluded)
    return replace(found, conflicts=conflicts, status=Status.INFEASIBLE if excluded else status)


def _with_enough_time(conflicts: tuple[Conflict, ...], problem: Problem, coarse: CoarseSolves) -> tuple[Conflict, ...]:
    """Replace durations that mean speeds exclude, and those speeds, by durations with which a motion was found."""
    of_ends = [each for each in conflicts if each.name == "duration" and each.reason not in (ALONE, TOGETHER)]
    if not of_ends:
        return conflicts
    longer = sufficient_durations(problem, coarse, None)
    return tuple(replace(each, certain=True) for each in longer) or conflicts


def _with_cause(solution: Solution, coarse: CoarseSolves) -> Solution:
    """Return a failed solution with conflicts of limits, or with a status that blames its mesh."""
    conflicts, motion = _searched(solution.problem, coarse, solution)
    conflicts = conflicts or blocked_ends(solution.problem) or unheld_ends(solution.problem)
    on_this_mesh = solution.status is Status.INFEASIBLE and motion is not None and not conflicts
    if on_this_mesh:
        _, finer = relaxed_motion(solution.problem, coarse.on_finer, motion)
        conflicts = finer if are_clear(finer) else ()
    status = Status.NOT_ON_THIS_MESH if on_this_mesh and not conflicts else solution.status
    return replace(solution, conflicts=conflicts, status=status)


def _is_excluded(failed: Solution, coarse: CoarseSolves) -> bool:
    """Whether a theorem excludes every motion: one about a conflict, or about the whole problem."""
    conflicts = failed.conflicts
    if are_certain(conflicts):
        return True
    return are_clear(conflicts) and excluded_on_finer_mesh(failed.problem, coarse.on_finer, failed)


def conflicts_of(problem: Problem, coarse: CoarseSolves, near: Sequence[PhaseTrajectory] = ()) -> tuple[Conflict, ...]:
    """Return conflicts that two searches agree on: at the ends, of torques that hold them, or of relaxed rows.

    The first search of the ends starts from those of ``near``, the iterate of a solver.
    """
    found = excluded(problem, near)
    if are_certain(found):
        return found
    motion, conflicts = relaxed_motion(problem, coarse)
    if not are_clear(conflicts):
        return ()
    assert motion is not None
    finer = unheld_ends(problem) or relaxed_again(problem, coarse.on_finer, motion)
    return finer if are_clear(finer) else ()


def _searched(problem: Problem, coarse: CoarseSolves, start: Solution) -> tuple[tuple[Conflict, ...], Solution | None]:
    """Return the first conflicts, and a motion of the relaxed problem that meets every row; None without one."""
    found = excluded(problem, [part.trajectory for part in start.phases])
    if are_certain(found):
        return found, None
    motion, conflicts = relaxed_motion(problem, coarse, start)
    if motion is not None and not conflicts:
        # The relaxed problem has no rows on distances.
        kept_clear = any(each.avoids_collisions for phase in problem.phases for each in phase.constraints)
        return (), motion if motion.success and not kept_clear else None
    return found or unheld_ends(problem) or completed(problem, conflicts, motion, coarse), None


def blocked_ends(problem: Problem) -> tuple[Conflict, ...]:
    """Return the distance that must give at each end that no configuration was found to reach clear of obstacles.

    Inverse kinematics starts from seeded configurations, so that such ends are likely, not certain, to be blocked.
    """
    if not any(each.avoids_collisions for phase in problem.phases for each in phase.constraints):
        return ()
    nodes, starts, _ = nodes_of(problem)
    found = []
    for number, node in enumerate(nodes):
        if not isinstance(node, OpenEnd):
            continue
        robot = node.parts[0][0].robot
        assert robot is not None
        reached = node.reached(robot.neutral)
        if not len(reached) or node.clearance(reached).max() >= 0.0:
            continue
        best = reached[[int(np.argmax(node.clearance(reached)))]]
        which = "start" if number in starts else "end"
        found.append(_conflict(node, best, f"at the {which}, in the best of {len(reached)} configurations found"))
    return tuple(found)


def _conflict(node: OpenEnd, best: NDArray[np.float64], reason: str) -> Conflict:
    """Describe the pair that is farthest below its margin."""
    worst = []
    for phase, _ in node.parts:
        for pairs in clearances_of(phase.constraints, phase.robot):
            distances = distances_at_rest(pairs, best)[0]
            pair = int(np.argmin(distances))
            worst.append((float(distances[pair]) - pairs.margin, phase.name, pairs.label(pair), pairs.margin))
    left, name, label, margin = min(worst)
    relative = -left / max(margin, SIZE)
    return Conflict(name, f"clearance, {label}", node.time, margin, margin + left, "m", relative, False, reason)
