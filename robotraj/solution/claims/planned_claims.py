"""The claims of a plan before its validation: what the planner's own measures show, and what is not judged yet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.curves.teeth import SMOOTH
from robotraj.problem.phase import Phase
from robotraj.robot.collision.unguarded import not_every_link, unguarded_links
from robotraj.robot.limits import Limits
from robotraj.solution.claims.claim import Claim, Judgement
from robotraj.solution.planned import Planned
from robotraj.solution.proof import Proof

PLANNER = "the planner's own measures between the collocation points"
LATER = "rt.validate(solution) judges it."


def planned_claims(solution: Planned, proof: Proof | None) -> tuple[Claim, ...]:
    """Return the claims that apply to a plan, in the order of a validation's."""
    phases = [part.phase for part in solution.phases]
    robots = [phase for phase in phases if phase.robot is not None]
    found = [_measured("motion", proof, "error")]
    if robots:
        found.append(_later("torques"))
    if any(map(_has_limited_controls, phases)):
        found.append(_measured("smoothness", proof, "roughness"))
    if robots:
        found.append(_later("tracking"))
    found.append(_measured("limits and constraints", proof, "excess"))
    if any(phase.contacts for phase in robots):
        found.append(_later("ground and contacts"))
    if robots:
        found.append(_later("own body"))
    avoiding = [phase for phase in robots if any(each.avoids_collisions for each in phase.constraints)]
    if avoiding:
        found.append(_distances(proof, avoiding))
    found += [_measured("objective", proof, "quadrature"), _measured("optimum", proof, "unsettled")]
    return tuple(found)


def _has_limited_controls(phase: Phase) -> bool:
    """Whether a control has limits on both sides."""
    if phase.robot is None:
        lower, upper = phase.rows.limits_of(phase.dae.controls)
        return bool(np.isfinite(np.maximum(np.abs(lower), np.abs(upper))).any())
    if not isinstance(phase.limits, Limits):
        return False
    efforts = dict(zip(phase.robot.velocity_names, phase.limits.largest("effort"), strict=True))
    return any(np.isfinite(efforts[joint]) for joint in phase.robot.actuated)


def _later(name: str) -> Claim:
    return Claim(name, Judgement.NOT_JUDGED, "", "", "", notes=(LATER,))


def _measured(name: str, proof: Proof | None, measure: str) -> Claim:
    """Return the claim on one measure of the proof; a missed goal of the objective is not judged, not a failure."""
    if proof is None:
        return _later(name)
    value = float(getattr(proof, measure))
    goals = {"error": proof.goals.error, "excess": proof.goals.excess, "roughness": SMOOTH}
    goal = float(goals.get(measure, proof.goals.objective))
    missed = Judgement.NOT_JUDGED if measure == "unsettled" else Judgement.FAILS
    judgement = Judgement.HOLDS if value <= goal else missed
    return Claim(name, judgement, PLANNER, "", "", value, goal)


def _distances(proof: Proof | None, phases: Sequence[Phase]) -> Claim:
    if proof is None:
        return _later("obstacles")
    unguarded = {f"{link}: {why}" for phase in phases if phase.robot for link, why in unguarded_links(phase.robot)}
    notes = (not_every_link(tuple(sorted(unguarded))),) if unguarded and proof.shortfall <= 0.0 else ()
    judgement = Judgement.NOT_JUDGED if notes else Judgement.HOLDS if proof.shortfall <= 0.0 else Judgement.FAILS
    return Claim("obstacles", judgement, PLANNER, "", "", proof.shortfall, 0.0, "m", notes)
