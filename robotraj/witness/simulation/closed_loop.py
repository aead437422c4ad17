"""Simulation of a plan with its own feedback, ``solution.gains``.

The simulation starts on the plan, where any feedback is nearly silent, even one of the wrong sign. What it does to a
deviation is therefore read from the linearised plant: feedback of the wrong sign drives a joint away about as fast as
the right one draws it back.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.solution.feedback.gains import PhaseGains
from robotraj.witness.plants.robot_plant import RobotPlant
from robotraj.witness.plants.sizes import sizes_of
from robotraj.witness.protocols import PhaseSolutionLike, SolutionLike
from robotraj.witness.simulation import drift as drifts
from robotraj.witness.simulation.drift import Drift, DriftRow, drift_of
from robotraj.witness.simulation.open_loop import handed_on
from robotraj.witness.simulation.spans import spans_of
from robotraj.witness.simulation.steps import march

PLACES = (np.arange(9) + 0.5) / 9
"""Fractions of a phase at which the plant is linearised."""


@dataclass(frozen=True)
class ClosedLoop(OneLine):
    """The simulated motion under the planned torques and ``solution.gains``.

    Attributes
    ----------
    error : Drift or None
        By state: final and largest distance from the plan; None where there is no simulation.
    growth : float or None
        Largest factor by which a small deviation grows along the plan without feedback.
    reason : str or None
        Reason why there is no simulation, or why it stopped early.
    divergence : float
        Rate at which feedback makes a small deviation grow, above that without feedback, in the phase with most [1/s].
    """

    error: Drift | None
    growth: float | None
    reason: str | None = None
    divergence: float = 0.0


def closed_loop_of(
    solution: SolutionLike,
    rtol: float,
    atol: float,
    clock: Callable[[], None],
) -> ClosedLoop:
    """Simulate a plan from its first state through all phases with its own feedback."""
    if any(planned.phase.robot is None for planned in solution.phases):
        return ClosedLoop(None, None, "a phase moves a System, and feedback is computed for robots only")
    if not all(realised(planned).actuated for planned in solution.phases):
        return ClosedLoop(None, None, "the robot has no motors")
    if any(not contact.holds for planned in solution.phases for contact in planned.phase.bound_contacts):
        return ClosedLoop(None, None, "contacts are implicit, and their forces on a deviating robot are not known")
    clock()
    try:
        gains = solution.gains
    except InputError as error:
        return ClosedLoop(None, None, str(error))
    rows: list[tuple[DriftRow, ...]] = []
    before: tuple[RobotPlant, Array, Array] | None = None
    sizes = sizes_of(solution)
    divergence = max(map(_divergence, solution.phases, gains.phases))
    for i, (planned, feedback) in enumerate(zip(solution.phases, gains.phases, strict=True)):
        plant = RobotPlant(planned, feedback.at)
        knots = np.asarray(planned.knots, dtype=float)
        own = plant.states(knots[:1], 0)[0]
        x, _ = plant.begin(handed_on(solution, i, plant, own, before))
        own_sizes = plant.spread(sizes[i])
        motion = march(plant, x, spans_of(knots), own_sizes, rtol=rtol, atol=atol, settle=plant.settle, clock=clock)
        rows.append(drift_of(plant, motion, planned.phase.name, sizes[i]))
        if motion.failure is not None:
            reason = f"phase {planned.phase.name!r}, t = {motion.stopped:.4g} s: {motion.failure}"
            return ClosedLoop(drifts.merge(rows), gains.growth, reason, divergence)
        before = plant, motion.states[-1], plant.states(knots[-1:], len(knots) - 2)[0]
    return ClosedLoop(drifts.merge(rows), gains.growth, divergence=divergence)


def _divergence(planned: PhaseSolutionLike, feedback: PhaseGains) -> float:
    """Return how much faster deviations grow with feedback than without, by the plant's eigenvalues [1/s].

    It is the mean along the phase: where few motors move many joints, right feedback may push some of them away for an
    instant, and one of the wrong sign does so all the time.
    """
    knots = np.asarray(planned.knots, dtype=float)
    times = knots[0] + (knots[-1] - knots[0]) * PLACES
    alone, fed = (
        np.array([_fastest(plant.jacobian(t, x, given)) for t, x, given in zip(times, states, inputs, strict=True)])
        for plant in (RobotPlant(planned), RobotPlant(planned, feedback.at))
        for states, inputs in [(plant.states(times), plant.given(times))]
    )
    return float(np.mean(fed - np.maximum(alone, 0.0)))


def _fastest(rates: Array) -> float:
    """Return the largest real part of the eigenvalues; infinite where an entry is no number."""
    return float(np.linalg.eigvals(rates).real.max()) if np.isfinite(rates).all() else np.inf
