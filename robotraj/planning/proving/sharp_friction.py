"""Continuation from smooth dry friction to Coulomb's law.

The friction F tanh(v / v_s) is less than Coulomb's F sign(v) where a joint moves more slowly than v_s. What is missing
over a phase, relative to what the joint's motion takes,

    max_i integral F_i (1 - |tanh(v_i / v_s)|) [v_i moves] dt / max(integral |M a|_i dt, ``SHARE`` integral |tau_i| dt),

falls in proportion to v_s. A proved plan is the guess of the next one, with a smaller v_s, until this share is small.
From a distant guess such a plan takes thousands of iterations or ends in a poor optimum; from the softer one it takes
tens (``soft_friction`` has the part of the continuation before the robot's own friction).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin

from robotraj._util.polynomials import gauss
from robotraj.planning.loop.run import run
from robotraj.planning.proving.kept_apart import KeptApart
from robotraj.planning.proving.soft_friction import has_friction
from robotraj.planning.warm_start import PATIENCE
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.proof import FRICTION
from robotraj.solution.records import with_effort_of
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status

SHARE = 0.1
"""Least size of a joint's impulse relative to that of its motor: a slow joint has hardly any inertia."""
STILL = 3e-3
"""Speed below which a joint rests, relative to its largest: its friction takes any value up to F."""
LEAST, MOST = 0.3, 0.5
"""Bounds on the factor of v_s from one plan to the next; after a plan that fails, the lower one becomes its root."""
AIM = 0.7
"""Part of the allowed share that the next plan aims at."""
GENTLEST = 0.8
"""Factor above which a further plan would hardly differ."""
STEPS = 8
"""Largest number of plans with a smaller v_s."""
PLACES, WEIGHTS = 0.5 * (gauss(8)[0] + 1.0), 0.5 * gauss(8)[1]
"""Gauss's rule on an interval."""


def sharpened(
    problem: Problem, found: Solution, settings: Settings, progress: Progress | None, apart: KeptApart
) -> Solution:
    """Return a proved plan by nearly Coulomb's law, whose proof has the share of friction that is left out.

    Where a next plan is not proved, or links overlap along it, the plan before is kept. Its machine may follow it by
    Coulomb's law already; if not, v_s falls by less.
    """
    factor = LEAST
    for step in range(STEPS + 1):
        if found.proof is None or not any(map(has_friction, problem.phases)):
            return found
        missing = max(missing_friction(part) for part in found.phases)
        proof = replace(found.proof, friction=missing)
        found = replace(found, proof=proof)
        if missing <= FRICTION or not proof.holds or step == STEPS:
            return found
        sharper = _sharper(problem, max(factor, min(AIM * FRICTION / missing, MOST)))
        near = replace(
            settings,
            mesh=tuple(part.mesh for part in found.phases),
            restarts=Restarts(0),
            solver=settings.solver.at_most(PATIENCE),
        )
        again = run(sharper, found, near, progress, apart.surfaces, is_brief=True)
        if again.status is Status.INTERRUPTED:
            return replace(with_effort_of(again, found), status=again.status)
        if again.proof is not None and again.proof.holds and apart.is_free(again):
            problem, found = sharper, with_effort_of(found, again)
            continue
        found, factor = with_effort_of(again, found), factor**0.5
        if factor > GENTLEST or is_followed(found):
            return found
    return found


def is_followed(found: Solution) -> bool:
    """Whether a machine with Coulomb's friction stays within half of what ``rt.validate`` allows."""
    from robotraj.witness.figures import Tolerances
    from robotraj.witness.simulation.coulomb import coulomb_drift

    allowed, drift = Tolerances().friction, coulomb_drift(found)
    return drift is None or isinstance(drift, str) or (allowed is not None and drift.worst.relative <= 0.5 * allowed)


def missing_friction(part: PhaseSolution) -> float:
    """Return the share of Coulomb's friction that the smooth law of a phase leaves out."""
    robot = part.phase.robot
    if robot is None or not has_friction(part.phase):
        return 0.0
    joints = np.flatnonzero(robot.friction)
    knots = np.asarray(part.knots, dtype=float)
    lengths = np.diff(knots)
    times = (knots[:-1, None] + lengths[:, None] * PLACES).ravel()
    weights = (lengths[:, None] * WEIGHTS).ravel()
    sample = part.at(times)
    speeds = np.abs(sample.v[:, joints])
    lacking = robot.friction[joints] * (1.0 - np.tanh(speeds / robot.friction_speed))
    missing = weights @ np.where(speeds > STILL * speeds.max(axis=0), lacking, 0.0)
    data, still = robot.model.createData(), np.zeros(robot.nv)
    inertia = np.array(
        [
            pin.rnea(robot.model, data, q, still, a) - pin.rnea(robot.model, data, q, still, still)
            for q, a in zip(sample.q, sample.a, strict=True)
        ]
    )
    motors = np.abs(sample.tau) @ np.abs(np.asarray(robot.actuation, dtype=float)).T
    size = np.maximum(weights @ np.abs(inertia[:, joints]), SHARE * (weights @ motors[:, joints]))
    return float(np.max(np.divide(missing, size, out=np.zeros_like(missing), where=size > 0.0)))


def _sharper(problem: Problem, factor: float) -> Problem:
    """Return the problem of robots whose dry friction is less smooth."""
    return Problem([_of_phase(phase, factor) for phase in problem.phases], problem.links)


def _of_phase(phase: Phase, factor: float) -> Phase:
    robot = phase.robot
    if robot is None or not has_friction(phase):
        return phase
    return replace(phase, subject=replace(robot, friction_speed=factor * robot.friction_speed))
