"""A plan's controls without feedback: through all phases, and through each phase from its own first state."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.values import dataclass
from robotraj.witness import drift as drifts
from robotraj.witness.drift import Drift, DriftRow, drift_of
from robotraj.witness.integration import Motion, integrate
from robotraj.witness.plant import Landing, Plant, plant_of
from robotraj.witness.protocols import Array, SolutionLike


@dataclass(frozen=True)
class OpenLoop:
    """What became of a plan that was simulated without feedback.

    Attributes
    ----------
    drift : Drift
        Through all phases from the plan's first state.
    restarted : Drift or None
        Each phase from its own planned first state; None where no phase has contacts.
    failure : str or None
        Why and when the simulation stopped before the end.
    landings : tuple of Landing
        Where the simulation through all phases set its contacts down.
    stiff : float or None
        Time [s] of the first interval that was too stiff for DOP853.
    """

    drift: Drift
    restarted: Drift | None
    failure: str | None
    landings: tuple[Landing, ...]
    stiff: float | None


def open_loop(solution: SolutionLike, rtol: float, atol: float, samples: int) -> OpenLoop:
    """Simulate a plan under its controls alone.

    The simulated state is handed on where the next phase has the same states, so that a jump of the plan between phases
    shows as drift. Where a link lets states jump, the planned jump is added; where contacts take hold, an impact of the
    simulation's own brings them to rest where they are. A phase with other states, and one that sees the end of the
    last displaced or mirrored, starts from its own plan.
    """
    through: list[tuple[DriftRow, ...]] = []
    restarted: list[tuple[DriftRow, ...]] = []
    landings: list[Landing] = []
    failure: str | None = None
    stiff: list[float] = []
    before: tuple[Plant, Array, Array] | None = None
    in_contact = any(p.phase.robot is not None and p.phase.bound_contacts for p in solution.phases)
    for i, planned in enumerate(solution.phases):
        plant = plant_of(planned)
        knots = np.asarray(planned.knots, dtype=float)
        own = plant.states(knots[:1], 0)[0]

        def run(x: Array, plant: Plant = plant, knots: Array = knots) -> Motion:
            motion = integrate(
                plant.rates, x, knots, rtol=rtol, atol=atol, samples_per_interval=samples, settle=plant.settle
            )
            stiff.extend([] if motion.stiff is None else [motion.stiff])
            return motion

        if failure is None:
            x, landed = plant.begin(_handed_on(solution, i, plant, own, before))
            motion = run(x)
            landings += plant.watched(landed, motion.states)
            through.append(drift_of(plant, motion, planned.phase.name))
            if motion.failure is not None:
                failure = f"phase {planned.phase.name!r}, t = {motion.stopped:.4g} s: {motion.failure}"
            before = plant, motion.states[-1], plant.states(knots[-1:], len(knots) - 2)[0]
        if in_contact:
            alone = through[0] if i == 0 else drift_of(plant, run(plant.begin(own)[0]), planned.phase.name)
            restarted.append(alone)
    alone_too = drifts.merge(restarted) if in_contact else None
    return OpenLoop(drifts.merge(through), alone_too, failure, tuple(landings), min(stiff, default=None))


def _handed_on(
    solution: SolutionLike, phase: int, plant: Plant, own: Array, before: tuple[Plant, Array, Array] | None
) -> Array:
    """First state of a phase: what the phase before ended with, and planned jumps; or its own plan's."""
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
        held |= set(_velocities(plant.names))
    return reached + np.where([name in held for name in plant.names], 0.0, own - planned)


def _velocities(names: Sequence[str]) -> list[str]:
    return [name for name in names if name.startswith("v.")]
