"""What the ends of a motion need: the torques that hold a robot still there, beside the limits of its motors.

A robot may pass through a pose that its motors cannot hold: it arrives while gravity slows it down. What is found here
is a suspicion, which names the cause where a solve fails, and no refusal.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.values import dataclass
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.limits import Limits


@dataclass(frozen=True)
class Unheld:
    """A pose at rest that a motor cannot hold.

    Attributes
    ----------
    phase : str
        Name of the phase.
    end : str
        ``"start"`` or ``"end"``.
    joint : str
    needed, limit : float
        Torque or force that holds the pose, and what the motor has [N m, N].
    unit : str
    """

    phase: str
    end: str
    joint: str
    needed: float
    limit: float
    unit: str

    def __str__(self) -> str:
        return (
            f"holding the {self.end} of {self.phase!r} needs {self.needed:.4g} {self.unit} of {self.joint}, "
            f"its limit is {self.limit:.4g}"
        )


def unheld_ends(problem: Problem) -> tuple[Unheld, ...]:
    """List the fixed ends at rest whose gravity torques exceed the motors, tau = g(q), the largest excess first.

    Looks at robots on a fixed root without contacts and design parameters; other ends are held by forces that are
    unknowns of the plan.
    """
    found = [entry for phase in problem.phases for end in ("start", "end") for entry in _unheld(phase, end)]
    return tuple(sorted(found, key=lambda entry: entry.limit - entry.needed))


def _unheld(phase: Phase, end: str) -> list[Unheld]:
    robot, limits = phase.robot, phase.limits
    if robot is None or not isinstance(limits, Limits) or robot.root != "fixed" or phase.contacts or phase.design:
        return []
    bounds = phase.start_bounds if end == "start" else phase.end_bounds
    size = robot.nq + robot.nv
    lower, upper = bounds.lower[:size], bounds.upper[:size]
    if not np.array_equal(lower, upper) or np.any(lower[robot.nq :]):
        return []
    torques = pin.computeGeneralizedGravity(robot.model, robot.model.createData(), lower[: robot.nq])
    entries = []
    for i, (joint, unit) in enumerate(zip(robot.velocity_names, robot.units, strict=True)):
        # Dry friction holds a joint that rests.
        needed = max(abs(float(torques[i])) - float(robot.friction[i]), 0.0)
        limit = float(limits.effort[i]) if joint in robot.actuated else np.inf
        if needed > limit * (1 + 1e-9):
            entries.append(Unheld(phase.name, end, joint, needed, limit, "N m" if unit == "rad" else "N"))
    return entries
