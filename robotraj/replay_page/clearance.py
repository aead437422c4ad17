"""The height that ``GroundClearance`` requires, along the paths of its points."""

from __future__ import annotations

from typing import cast

import casadi as ca
import numpy as np

from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.terrain.function import as_ground
from robotraj.problem.augmentation import free_of
from robotraj.problem.constraints.base import symbols_of
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.constraints.clearance_geometry import spots_of
from robotraj.solution.cycles.gait_cycles import CyclePhase, GaitCycles

SAMPLES = 61
"""Samples of a required height over a phase."""


def clearance_scene(cycles: GaitCycles) -> list[dict[str, object]]:
    """Return curves for the page's script: start and end [s], and points x, y, z of the required height [m].

    ``ground`` is the height [m] of the ground below each point. A constraint that holds at one end of a phase only
    has no curve.
    """
    curves = []
    for cycle_phase in cycles.phases:
        for constraint in cycle_phase.phase.constraints:
            if isinstance(constraint, GroundClearance) and _is_drawn(constraint):
                curves += _curves(cycle_phase, constraint)
    return curves


def _is_drawn(constraint: GroundClearance) -> bool:
    """Whether a clearance requires heights above the ground; the distance from a wall has no curve."""
    return constraint.height is not None and as_ground(constraint.ground).below


def _curves(cycle_phase: CyclePhase, constraint: GroundClearance) -> list[dict[str, object]]:
    """Return one curve for each point, at the highest of its required heights."""
    planned, phase = cycle_phase.planned, cycle_phase.phase
    body, names = free_of(phase.body), phase.parameter_names
    held = phase.rows.of(constraint)
    spots = spots_of(constraint.frames, cycle_phase.robot)
    point = symbols_of(body, names)
    ground = as_ground(constraint.ground)
    values = phase.rows.column(held, point)
    places = ca.vertcat(*(ca.vertcat(*spot.position(cast("FramePoint", point))) for spot in spots))
    variables = [point.t, *(ca.vertcat(*group.values()) for group in (point.x, point.z, point.u, point.p))]
    evaluate = ca.Function("clearance", variables, [values, places])
    times = np.linspace(planned.t0, planned.t0 + planned.duration, SAMPLES)
    sample = planned.at(times)
    columns = [
        np.array([np.broadcast_to(np.asarray(group[name], dtype=float), times.shape) for name in known])
        for group, known in (
            (sample.x, point.x),
            (sample.z, point.z),
            (sample.u, point.u),
            (planned.parameters, point.p),
        )
    ]
    rows, xyz = (np.array(part) for part in evaluate(times[None, :], *(c.reshape(-1, len(times)) for c in columns)))
    found = []
    for k, spot in enumerate(spots):
        x, y, z = xyz[3 * k : 3 * k + 3]
        mine = [i for i, row in enumerate(held) if row.joint == spot.label]
        # The value of a row minus its bound is the distance above the required height.
        spare = np.min([rows[i] - held[i].lower for i in mine], axis=0)
        below = np.asarray(ground.height(x, y), dtype=float)
        required = cycle_phase.points(np.column_stack([x, y, z - spare]))
        floor = cycle_phase.points(np.column_stack([x, y, below]))
        found.append(
            {
                "start": cycle_phase.t0,
                "end": cycle_phase.t0 + cycle_phase.duration,
                "points": [float(f"{v:.5g}") for v in required.ravel()],
                "ground": [float(f"{v:.5g}") for v in floor[:, 2]],
            }
        )
    return found
