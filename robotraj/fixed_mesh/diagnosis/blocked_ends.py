"""Ends whose configurations all touch something: a pose inside an obstacle, or beside one that the arm cannot avoid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj.fixed_mesh.diagnosis.self_collision import SIZE
from robotraj.guess.reaching.branches import nodes_of
from robotraj.guess.reaching.open_end import OpenEnd
from robotraj.problem.clearance.end_checks import clearances_of, distances_at_rest
from robotraj.problem.problem import Problem
from robotraj.solution.conflict import Conflict


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
