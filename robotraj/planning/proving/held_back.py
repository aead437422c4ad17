"""What rows between links, fixed along an earlier motion, cost the solution that they end at."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from robotraj.planning.proving.own_overlaps import motion_of
from robotraj.robot.collision.own_body import OwnBody
from robotraj.solution.solution import Solution

CLEARANCE = "clearance"
SMALL = 1e-4
"""Share of all multipliers below which a row counts as not active."""


def held_back(solution: Solution, bodies: Sequence[OwnBody | None]) -> float:
    """Return what the objective may gain where rows between links are fixed anew along the solution.

    A row keeps points of two links apart by less than these have left, unless it was fixed where they are now. For a
    convex program the gain is at most the sum of multipliers times what is left [of the objective's unit]. Source:
    Boyd & Vandenberghe, Convex Optimization (2004), section 5.6.
    """
    multipliers = solution.multipliers
    if multipliers is None or multipliers.origin is None:
        return 0.0
    rows, prices = multipliers.origin.nlp.rows, np.abs(multipliers.rows)
    gain = 0.0
    for number, (part, body) in enumerate(zip(solution.phases, bodies, strict=True)):
        if body is None or part.phase.robot is None:
            continue
        pairs = {body.label(pair): pair for pair in range(len(body.pairs))}
        known = [
            pairs.get(each.label, -1) if each.phase == number and each.name == CLEARANCE else -1
            for each in rows.entries
        ]
        pair = np.array(known, dtype=int)[rows.meaning]
        own = pair >= 0
        active = np.flatnonzero(own & (prices > SMALL * prices[own].sum()))
        joined: dict[tuple[int, float], list[int]] = defaultdict(list)
        for row in active.tolist():
            joined[int(pair[row]), float(rows.fraction[row])].append(row)
        motion = motion_of(part)
        for (which, fraction), at in joined.items():
            q = motion(np.array([fraction]))[0]
            slack = body.distance(part.phase.robot, q, which) - rows.lower[at]
            gain += float(prices[at] @ np.maximum(slack, 0.0))
    return gain
