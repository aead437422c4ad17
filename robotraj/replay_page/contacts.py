"""Contact forces, friction cones, impulses and the times during which each contact is held."""

from __future__ import annotations

import numpy as np

from robotraj._util.arrays import Array
from robotraj.problem.links.touchdown import impulse_names
from robotraj.replay_page.footholds import Foothold, contact_names, footholds, numbers
from robotraj.robot.robot import Robot
from robotraj.solution.cycles.gait_cycles import GaitCycles

IMPULSE_TIME = 0.1
"""Time [s] in which a constant force of the drawn length produces an impulse."""


def weight_of(robot: Robot) -> float:
    """Return the weight of the moving bodies [N]."""
    model = robot.model
    mass = sum(float(inertia.mass) for inertia in model.inertias[1:])
    return mass * float(np.linalg.norm(model.gravity.linear))


def contact_scene(cycles: GaitCycles, robot: Robot, stature: float) -> dict[str, object] | None:
    """Return forces, cones and impulses for the page's script, or None without contacts with the ground.

    Parameters
    ----------
    cycles : GaitCycles
    robot : Robot
    stature : float
        Size of the robot [m]. An arrow of a third of it represents the robot's weight.
    """
    holds = [hold for cycle_phase in cycles.phases for hold in footholds(cycle_phase)]
    if not holds:
        return None
    names = contact_names(cycles)
    greatest = max(float(np.linalg.norm(hold.track[2], axis=1).max()) for hold in holds)
    return {
        "names": names,
        "unit": weight_of(robot) or greatest or 1.0,
        "weight": weight_of(robot) > 0.0,
        "length": round(stature / 3.0, 4),
        "impulseTime": IMPULSE_TIME,
        "forces": [_force(hold, names.index(hold.name)) for hold in holds],
        "cones": [cone for hold in holds for cone in _cones(hold, names.index(hold.name))],
        "impacts": _impacts(cycles, names),
    }


def held(cycles: GaitCycles) -> list[dict[str, object]]:
    """Return the name of each contact and the spans [start, end] [s] during which it is held.

    Spans that follow one another without a gap are joined.
    """
    spans: dict[str, list[list[float]]] = {name: [] for name in contact_names(cycles)}
    for cycle_phase in cycles.phases:
        for hold in footholds(cycle_phase):
            row = spans[hold.name]
            for start, end in hold.spans:
                if row and abs(row[-1][1] - start) < 1e-9 * max(1.0, cycles.duration):
                    row[-1][1] = end
                else:
                    row.append([start, end])
    return [{"label": name, "spans": row} for name, row in spans.items()]


def _force(hold: Foothold, foot: int) -> dict[str, object]:
    times, places, forces = hold.track
    return {"foot": foot, "t": _rounded(times, 8), "p": _rounded(places, 5), "f": _rounded(forces, 5)}


def _cones(hold: Foothold, foot: int) -> list[dict[str, object]]:
    shape = {
        "apex": _rounded(hold.place, 6),
        "normal": _rounded(hold.normal, 6),
        "angle": hold.angle,
        "sole": _rounded(hold.sole, 6),
    }
    return [{"foot": foot, "start": start, "end": end, "stays": hold.stays} | shape for start, end in hold.spans]


def _impacts(cycles: GaitCycles, names: list[str]) -> list[dict[str, object]]:
    """Return the impulses with their times, places [m] and world components [N s]."""
    found = []
    for impact in cycles.impacts:
        for hold in footholds(impact.after):
            if hold.stays and hold.name in names:
                impulse = numbers(hold.contact.vector([impact.impulses[name] for name in impulse_names(hold.contact)]))
                turned = hold.cycle_phase.forces(impulse[:3])
                place = _rounded(hold.place, 6)
                found.append(
                    {"foot": names.index(hold.name), "t": impact.t, "p": place, "impulse": _rounded(turned, 5)}
                )
    return found


def _rounded(values: Array, digits: int) -> list[float]:
    """Round to significant digits and flatten row by row."""
    return [float(f"{value:.{digits}g}") for value in np.ravel(values)]
