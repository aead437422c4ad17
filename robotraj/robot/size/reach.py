"""How far the masses of a robot reach from its joints."""

from __future__ import annotations

import math

import pinocchio as pin


def reach(model: pin.Model) -> float:
    """Return a bound on the distance of the bodies' masses from the first joint [m], by their radii of gyration."""
    farthest = reaches(model)
    return max((farthest[i] for i in range(1, model.njoints) if int(model.parents[i]) == 0), default=0.0)


def reaches(model: pin.Model) -> list[float]:
    """Return a bound on the distance of the masses that each joint moves from that joint [m], the universe first."""
    farthest = [
        math.hypot(*body.lever) + math.sqrt(max(body.inertia.trace() / (2.0 * body.mass), 0.0)) if body.mass else 0.0
        for body in model.inertias.tolist()
    ]
    placements, parents = model.jointPlacements.tolist(), [int(parent) for parent in model.parents]
    for i in range(model.njoints - 1, 0, -1):
        farthest[parents[i]] = max(farthest[parents[i]], math.hypot(*placements[i].translation) + farthest[i])
    return farthest
