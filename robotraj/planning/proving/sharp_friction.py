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
from robotraj.planning.proving.correction import PlanAttempt
from robotraj.planning.proving.friction_left_out import friction_left_out
from robotraj.planning.proving.kept_apart import KeptApart
from robotraj.planning.proving.soft_friction import FALL, SMALLEST_FALL, has_friction
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.proof import FRICTION
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status

LEAST, MOST = 1.0 / FALL, 0.5
"""Bounds on the factor of v_s from one plan to the next; after a plan that fails, the lower one becomes its root."""
AIM = 0.7
"""Part of what is allowed that plans aim at: shares and deviations are of first order in v_s, and plans leave out more.
"""
STEPS = 8
"""Largest number of plans with a smaller v_s."""


class SharpFriction:
    """Plans by nearly Coulomb's law, from plan to plan.

    Where a next plan is not proved, the plan before is kept. Its machine may follow it by Coulomb's law already; if
    not, v_s falls by less. Robots with a free root keep their v_s: a mesh that resolves every reversal of their joints
    takes ten times as long to solve. The witness still lets their machine follow by Coulomb's law.

    Parameters
    ----------
    settings : Settings
    apart : KeptApart
        What keeps the links apart from each other.
    """

    def __init__(self, settings: Settings, apart: KeptApart) -> None:
        self._settings, self._apart = settings, apart
        self._factor, self._step = LEAST, 0
        self._known: tuple[object, float] = None, 0.0

    def next_attempt(self, found: Solution, dropped: Solution | None) -> PlanAttempt | None:
        """Return the plan with a smaller v_s where the law of a proved plan leaves out too much friction."""
        if found.proof is None or not found.proof.holds or self._step == STEPS or not _has_friction(found):
            return None
        if dropped is not None:
            self._factor **= 0.5
            if self._factor * SMALLEST_FALL > 1.0 or self._deviation(found) <= 1.0:
                return None
        missing = friction_left_out(found)
        over = missing.objective / (AIM * FRICTION)
        if over <= 1.0:
            deviation = 0.0 if missing.impulse <= FRICTION else self._deviation(found)
            if deviation <= 1.0:
                return None
            over = deviation / AIM
        self._step += 1
        wanted = min(1.0 / over, MOST)
        meshes = tuple(part.mesh for part in found.phases)
        solver = self._settings.solver.at_most(PATIENCE)
        near = replace(self._settings, mesh=meshes, restarts=Restarts(0), solver=solver)
        factor = max(self._factor, wanted)
        lacked, why = "friction that the smooth law leaves out", f"sharper friction, {factor:.2g} times"
        return PlanAttempt(_scaled(found.problem, factor), found, near, self._apart.surfaces, lacked, why)

    def accepts(self, again: Solution) -> bool:
        """Whether a plan is proved."""
        return again.proof is not None and again.proof.holds

    def allows(self, again: Solution) -> bool:
        """Whether a plan of another correction is as good: v_s is the last thing to fall."""
        return True

    def judged(self, found: Solution) -> Solution:
        """Return a solution whose proof has the share of friction that is left out.

        Where that is not little, the proof holds only if a machine with Coulomb's friction follows the plan.
        """
        if found.proof is None or not _has_friction(found):
            return found
        missing = friction_left_out(found)
        proof = replace(found.proof, friction=missing.objective)
        if proof.holds and max(missing.objective, missing.impulse) > FRICTION:
            proof = replace(proof, deviation=self._deviation(found))
        refused = found.status is Status.SOLVED and proof.deviation > 1.0
        return replace(found, proof=proof, status=Status.NOT_PROVED if refused else found.status)

    def _deviation(self, found: Solution) -> float:
        """Return ``deviation_of`` a solution, which is simulated once."""
        if self._known[0] is not found.phases:
            self._known = found.phases, deviation_of(found)
        return self._known[1]


def _has_friction(found: Solution) -> bool:
    return any(map(has_friction, found.problem.phases))


def deviation_of(found: Solution) -> float:
    """Return how far a machine with Coulomb's friction leaves a plan, relative to what ``rt.validate`` allows."""
    from robotraj.witness.figures import Tolerances
    from robotraj.witness.simulation.coulomb import coulomb_drift

    allowed, drift = Tolerances().friction, coulomb_drift(found)
    return 0.0 if drift is None or isinstance(drift, str) or allowed is None else drift.worst.relative / allowed


def _scaled(problem: Problem, factor: float) -> Problem:
    """Return the problem of robots whose dry friction is as many times as wide."""
    return Problem([_of_phase(phase, factor) for phase in problem.phases], problem.links)


def _of_phase(phase: Phase, factor: float) -> Phase:
    robot = phase.robot
    if robot is None or not has_friction(phase):
        return phase
    return replace(phase, subject=replace(robot, friction_speed=factor * robot.friction_speed))
