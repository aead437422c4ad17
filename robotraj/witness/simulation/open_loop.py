"""Simulation of all phases of a plan under its controls, without feedback."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.witness.plants.of_phase import plant_of
from robotraj.witness.plants.plant import Landing, Plant
from robotraj.witness.plants.sizes import sizes_of
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.simulation import drift as drifts
from robotraj.witness.simulation.drift import Drift, DriftRow, drift_of
from robotraj.witness.simulation.spans import Span, spans_of
from robotraj.witness.simulation.steps import march

FALLEN, LOST = 1.0, 10.0
"""Distance of a position from the plan [m, rad] at which the simulation of a robot ends, with a free root and without.

The motion afterwards is no measure of the plan. Its simulation takes most of the time, since limbs swing fast.
"""


@dataclass(frozen=True)
class OpenLoop:
    """The result of a simulation without feedback.

    Attributes
    ----------
    drift : Drift
        Drift through all phases from the plan's first state.
    failure : str or None
        Reason and time of an early stop of the simulation.
    landings : tuple of Landing
        Places at which the simulation set its contacts down.
    stiff : float or None
        Time [s] of the first interval that was simulated by implicit steps.
    """

    drift: Drift
    failure: str | None
    landings: tuple[Landing, ...]
    stiff: float | None


def open_loop(solution: SolutionLike, rtol: float, atol: float, clock: Callable[[], None]) -> OpenLoop:
    """Simulate a plan under its controls alone.

    A phase with the same states as the phase before starts from the simulated state. A jump of the plan between phases
    is then drift. Jumps that a link permits are added. Where contacts begin to hold, a simulated impact stops them. A
    phase with other states, or after a displaced or mirrored end, starts from its planned state. The simulation of a
    robot with a free root ends where it has fallen, ``FALLEN`` from the plan; that of another robot where a position is
    ``LOST`` from it.
    """
    rows: list[tuple[DriftRow, ...]] = []
    landings: list[Landing] = []
    failure: str | None = None
    stiff: list[float] = []
    before: tuple[Plant, Array, Array] | None = None
    sizes = sizes_of(solution)
    for i, planned in enumerate(solution.phases):
        plant = plant_of(planned)
        knots = np.asarray(planned.knots, dtype=float)
        own = plant.states(knots[:1], 0)[0]
        x, landed = plant.begin(handed_on(solution, i, plant, own, before))
        ended = None if planned.phase.robot is None else partial(_lost, plant)
        spans, own_sizes = spans_of(knots), plant.spread(sizes[i])
        motion = march(plant, x, spans, own_sizes, rtol=rtol, atol=atol, settle=plant.settle, ended=ended, clock=clock)
        stiff += [] if motion.stiff is None else [motion.stiff]
        landings += plant.watched(landed, motion.states)
        rows.append(drift_of(plant, motion, planned.phase.name, sizes[i]))
        if motion.failure is not None:
            failure = f"phase {planned.phase.name!r}, t = {motion.stopped:.4g} s: {motion.failure}"
            break
        before = plant, motion.states[-1], plant.states(knots[-1:], len(knots) - 2)[0]
    return OpenLoop(drifts.merge(rows), failure, tuple(landings), min(stiff, default=None))


def _lost(plant: Plant, x: Array, span: Span) -> str | None:
    """Return the position that is farthest from the plan if the robot has fallen or lost the plan."""
    gaps = np.abs(plant.gaps(x[None, :], plant.states(np.array([span.end]), span.interval)))[0]
    positions = [i for i, name in enumerate(plant.gap_names) if name.startswith("q.")]
    worst = max(positions, key=lambda i: float(gaps[i]))
    has_free_root = "q.root_x" in plant.gap_names
    if not gaps[worst] > (FALLEN if has_free_root else LOST):
        return None
    what = "the robot has fallen" if has_free_root else "the motion has left the plan"
    return f"{what}, {plant.gap_names[worst]} is {gaps[worst]:.2g} {plant.gap_units[worst]} off"


def handed_on(
    solution: SolutionLike, phase: int, plant: Plant, own: Array, before: tuple[Plant, Array, Array] | None
) -> Array:
    """Return the first state of a phase: the last one of the phase before with planned jumps, or its planned one."""
    if before is None or before[0].names != plant.names:
        return own
    _, reached, planned = before
    links = [link for link in solution.problem.bound_links if tuple(link.phases) == (phase - 1, phase)]
    if not links:
        return reached
    rows = [(row.name, row.joint) for link in links for row in link.rows]
    impact = any(name == "impact" for name, _ in rows)
    if impact and ("continuity", "time") not in rows:
        return own
    held = {joint for name, joint in rows if name == "continuity"}
    if impact:
        held |= {name for name in plant.names if name.startswith("v.")}
    return reached + np.where([name in held for name in plant.names], 0.0, own - planned)
