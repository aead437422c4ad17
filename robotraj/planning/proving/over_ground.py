"""Plans whose links stay above the ground on which the feet stand: rows are added only where a plan goes below it.

A plan is made with rows for its feet alone. Where another link is below the ground along it, the points of this link
that are lowest get rows, and the plan is the guess of the next one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj.dynamics.contacts.point_on_frame import Spot
from robotraj.dynamics.terrain.base import Ground
from robotraj.fixed_mesh.warm_start import PATIENCE
from robotraj.planning.proving.correction import PlanAttempt, short_of
from robotraj.planning.proving.kept_apart import KeptApart
from robotraj.planning.proving.own_overlaps import in_time
from robotraj.problem.clearance.link_parts import link_parts
from robotraj.problem.clearance.swinging_feet import lowest_ground
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.problem import Problem
from robotraj.robot.collision.placements import placements
from robotraj.robot.size.reach import reach
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.settings import Restarts, Settings
from robotraj.solution.solution import Solution
from robotraj.solution.violation import Violation

if TYPE_CHECKING:
    from robotraj.witness.contacts.links_over_ground import LinkDepth

ROUNDS = 4
"""Largest number of plans with further points; a link that turns rolls onto others."""
SAMPLES = 9
"""Points of every interval at which heights are compared."""
NEAR = 0.02
"""Height of a link over the ground, relative to the robot's reach, up to which its lowest points get rows."""


class AboveGround:
    """The links of a robot below its ground, from plan to plan.

    Parameters
    ----------
    settings : Settings
    apart : KeptApart
        What keeps the links apart from each other.
    """

    def __init__(self, settings: Settings, apart: KeptApart) -> None:
        # Rows move a motion of several phases far enough that a coarse mesh is the faster start.
        self._near = replace(settings, restarts=Restarts(0), solver=settings.solver.at_most(2 * PATIENCE))
        self._apart = apart
        self._round = 0

    def next_attempt(self, found: Solution, dropped: Solution | None) -> PlanAttempt | None:
        """Return the plan with rows for the lowest points of links below the ground; None where there are none."""
        self._round += 1
        low = [] if dropped is not None or self._round > ROUNDS else _below(found)
        if not low:
            return None
        lacked, why = "links below the ground", "rows for their lowest points"
        return PlanAttempt(_raised(found, low), found, self._near, self._apart.surfaces, lacked, why)

    def accepts(self, again: Solution) -> bool:
        """Whether a plan is proved."""
        return again.proof is not None and again.proof.holds

    def allows(self, again: Solution) -> bool:
        """Whether no link is below the ground; before its own turn, rows for low links are still to come."""
        return self._round == 0 or not _below(again)

    def judged(self, found: Solution) -> Solution:
        """Return a solution whose proof does not hold where links are below the ground."""
        low = _below(found)
        if not low or found.proof is None:
            return found
        deepest = max(each.depth for each in low)
        violations = [
            Violation(each.phase, "ground clearance", each.link, each.time, each.depth, "m", 0.0, "under", 1.0)
            for each in low
        ]
        return short_of(found, deepest, violations)


def _below(found: Solution) -> list[LinkDepth]:
    """Return the links of a proved plan that are further below the ground than ``rt.validate`` allows."""
    if found.proof is None or not found.proof.holds:
        return []
    if lowest_ground(found.problem.phases) is None:
        return []
    from robotraj.witness.contacts.ground import swings_of
    from robotraj.witness.contacts.links_over_ground import link_depths_of
    from robotraj.witness.figures import Tolerances

    allowed = Tolerances().ground
    if allowed is None:
        return []
    depths, _ = link_depths_of(found, swings_of(found, SAMPLES), SAMPLES)
    return [each for each in depths if each.part > allowed]


def _raised(found: Solution, low: Sequence[LinkDepth]) -> Problem:
    """Return the problem with rows for the lowest points of links."""
    phases = list(found.problem.phases)
    ground = lowest_ground(phases)
    assert ground is not None
    for number, part in enumerate(found.phases):
        rows = [
            GroundClearance(points, -each.lowered, ground)
            for each in low
            if each.phase == part.phase.name and (points := _lowest_points(part, each, ground))
        ]
        phases[number] = replace(phases[number], constraints=[*phases[number].constraints, *rows])
    return Problem(phases, found.problem.links)


def _lowest_points(part: PhaseSolution, low: LinkDepth, ground: Ground) -> list[Spot]:
    """Return the points and balls of a link that come near the ground as its lowest ones, no two close together."""
    robot = part.phase.robot
    assert robot is not None
    times = np.linspace(part.knots[0], part.knots[-1], SAMPLES * len(part.knots))
    rotations, origins = placements(robot, in_time(part)(times))
    near = NEAR * reach(robot.model)
    frame = robot.model.frames[robot.frame(low.link)].placement
    chosen: list[tuple[NDArray[np.float64], float]] = []
    for shape in link_parts(robot, part.phase.constraints):
        place = rotations[:, shape.joint], origins[:, shape.joint]
        is_near = shape.heights(*place, ground) + low.lowered < near
        if shape.link != low.link or not is_near.any():
            continue
        points, radius = shape.lowest(place[0][is_near], place[1][is_near], ground)
        for point in points:
            if all(np.linalg.norm(point - other) > near for other, _ in chosen):
                chosen.append((point, radius))
    return [Spot(low.link, tuple(frame.actInv(point).tolist()), radius) for point, radius in chosen]
