"""Compares the status of a plan of a random problem with the planned motion."""

from __future__ import annotations

import time

import numpy as np
from random_problems import Case

import robotraj as rt

SECONDS = 20.0
ALLOWED_STATES, ALLOWED_CONTROLS = 1e-3, 1.1e-2
"""Excess of a limit, relative to it, above which a plan must list a violation."""
ENDS = 1e-5
SAME = 1e-5
"""Relative difference of two objectives that are one optimum."""


def verdict(solution: rt.Solution, seconds: float) -> str:
    """Return solved, unsolved, late, false (an end or a point is missed) or silent (a breach that no list has)."""
    if seconds > 2.0 * SECONDS:
        return "late"
    if not solution.success:
        return "unsolved"
    (part,) = solution.phases
    phase = part.phase
    grid = np.linspace(part.t0, part.t0 + part.duration, 20 * part.mesh.count + 1)
    sample = part.at(grid)
    if phase.robot is not None:
        x = np.column_stack([sample.q, sample.v])
        u, limits = sample.tau, phase.limits
        chosen = [phase.robot.velocity_names.index(joint) for joint in phase.robot.actuated]
        bound_u = limits.effort[chosen]
        bounds_x = [(np.r_[limits.position_lower, -limits.velocity], np.r_[limits.position_upper, limits.velocity])]
        wanted = [np.concatenate([np.ravel(end.q), np.broadcast_to(end.v, phase.robot.nv)])
                  for end in (phase.start, phase.end)]  # fmt: skip
        bounds_u = (-bound_u, bound_u)
    else:
        names = [[v.name for v in group] for group in (phase.system.states, phase.system.controls)]
        x = np.column_stack([sample.x[n] for n in names[0]])
        u = np.column_stack([sample.u[n] for n in names[1]])
        bounds_x = [tuple(np.array([getattr(phase.states[n], side) for n in names[0]]) for side in ("lower", "upper"))]
        bounds_u = tuple(np.array([getattr(phase.controls[n], side) for n in names[1]]) for side in ("lower", "upper"))
        wanted = [np.array([end[n] for n in names[0]]) for end in (phase.start.values, phase.end.values)]
    if not (np.isfinite(x).all() and np.isfinite(u).all()):
        return "false"
    for there, target in zip((x[0], x[-1]), wanted, strict=True):
        if np.max(np.abs(there - target) / (1 + np.abs(target))) > ENDS:
            return "false"
    of_states = x, bounds_x[0], ALLOWED_STATES, solution.interval_violations
    of_controls = u, bounds_u, ALLOWED_CONTROLS, solution.control_interval_violations
    for values, (low, high), allowed, listed in (of_states, of_controls):
        over = np.maximum(values - high, low - values) / (1e-6 + np.maximum(np.abs(low), np.abs(high)))
        if np.nanmax(over) > allowed and not listed:
            return "silent"
    return "solved"


def planned(
    case: Case,
    solver: rt.solvers.Solver | None = None,
    phase: rt.Phase | None = None,
    guess: rt.Solution | None = None,
    limits: rt.interval_limits.ConstraintGeneration | None = None,
) -> tuple[rt.Solution, float]:
    """Plan on the mesh of a case; also return the processor time [s]."""
    began = time.process_time()
    solution = rt.plan(
        phase or case.phase,
        case.mesh,
        guess,
        solver,
        interval_limits=limits,
        check=False,
        time_limit=SECONDS,
        progress=False,
    )
    return solution, time.process_time() - began


def compared(case: Case) -> dict[str, str]:
    """Compare the optimum with that of IPOPT and of forward dynamics, with limits at the same places.

    Returns
    -------
    dict
        For each of both: agrees, unsolved, other or differs. With "other" each solver stays at the optimum of the other
        one, which is lower or higher. With "differs" a solver leaves the optimum of the other one.
    """
    same = rt.interval_limits.ConstraintGeneration(rounds=0)
    first, _ = planned(case, rt.InteriorPoint(fallback=None), limits=same)
    if not first.success:
        return {}
    others: dict[str, tuple[rt.solvers.Solver, rt.Phase]] = {"ipopt": (rt.Ipopt(), case.phase)}
    if case.phase.robot is not None:
        forward = case.phase.with_(dynamics=rt.dynamics.ForwardDynamics())
        others["forward dynamics"] = rt.InteriorPoint(fallback=None), forward
    found = {}
    for name, (solver, phase) in others.items():
        second, _ = planned(case, solver, phase, limits=same)
        if not second.success:
            found[name] = "unsolved"
        elif _agree(first, second):
            found[name] = "agrees"
        else:
            # The better start for one solver is the other one's optimum: it stays there where that is an optimum.
            there, _ = planned(case, solver, phase, first, same)
            here, _ = planned(case, rt.InteriorPoint(fallback=None), case.phase, second, same)
            stays = _agree(first, there) or _agree(second, here)
            found[name] = "other" if there.success and here.success and stays else "differs"
    return found


def _agree(first: rt.Solution, second: rt.Solution) -> bool:
    return abs(first.objective - second.objective) <= SAME * (1e-6 + abs(first.objective))
