"""Continuation from smooth dry friction to Coulomb's law.

Where the robot's own v_s leaves out more than a small share of the objective (``friction_left_out``), or a machine
with Coulomb's friction does not follow the plan, the plan is the guess of the next one, with a smaller v_s. This is so
for motions that are slow beside the joints' limits. From a distant guess such a plan takes thousands of iterations or
ends in a poor optimum; from the softer one it takes tens (``soft_friction`` has the part of the continuation before the
robot's own friction).
"""

from __future__ import annotations

from dataclasses import replace

from robotraj.fixed_mesh.warm_start import PATIENCE
from robotraj.planning.loop.run import run
from robotraj.planning.proving.friction_left_out import friction_left_out
from robotraj.planning.proving.kept_apart import KeptApart
from robotraj.planning.proving.soft_friction import has_friction
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.proof import FRICTION
from robotraj.solution.records import with_effort_of
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Progress
from robotraj.solvers.status import Status

LEAST, MOST = 0.3, 0.5
"""Bounds on the factor of v_s from one plan to the next; after a plan that fails, the lower one becomes its root."""
AIM = 0.7
"""Part of the allowed share that plans aim at: the share is of first order in v_s, and plans leave out more."""
GENTLEST = 0.8
"""Factor above which a further plan would hardly differ."""
STEPS = 8
"""Largest number of plans with a smaller v_s."""


def sharpened(found: Solution, settings: Settings, progress: Progress | None, apart: KeptApart) -> Solution:
    """Return a proved plan by nearly Coulomb's law, whose proof has the share of friction that is left out.

    Where a next plan is not proved, or links overlap along it, the plan before is kept. Its machine may follow it by
    Coulomb's law already; if not, v_s falls by less.

    Parameters
    ----------
    found : Solution
        A plan with the robots' own v_s.
    settings : Settings
    progress : callable, optional
    apart : KeptApart
    """
    factor = LEAST
    for step in range(STEPS + 1):
        if found.proof is None or not any(map(has_friction, found.problem.phases)):
            return found
        missing = friction_left_out(found)
        proof = replace(found.proof, friction=missing.objective)
        found = replace(found, proof=proof)
        if not proof.holds or step == STEPS:
            return found
        if missing.objective <= AIM * FRICTION and (missing.impulse <= FRICTION or is_followed(found)):
            return found
        wanted = min(AIM * FRICTION / max(missing.objective, FRICTION), MOST)
        sharper = _scaled(found.problem, max(factor, wanted))
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
            found = with_effort_of(found, again)
            continue
        found, factor = with_effort_of(again, found), factor**0.5
        if factor > GENTLEST or is_followed(found):
            return found
    return found


def is_followed(found: Solution) -> bool:
    """Whether a machine with Coulomb's friction stays within what ``rt.validate`` allows."""
    from robotraj.witness.figures import Tolerances
    from robotraj.witness.simulation.coulomb import coulomb_drift

    allowed, drift = Tolerances().friction, coulomb_drift(found)
    return drift is None or isinstance(drift, str) or (allowed is not None and drift.worst.relative <= allowed)


def _scaled(problem: Problem, factor: float) -> Problem:
    """Return the problem of robots whose dry friction is as many times as wide."""
    return Problem([_of_phase(phase, factor) for phase in problem.phases], problem.links)


def _of_phase(phase: Phase, factor: float) -> Phase:
    robot = phase.robot
    if robot is None or not has_friction(phase):
        return phase
    return replace(phase, subject=replace(robot, friction_speed=factor * robot.friction_speed))
