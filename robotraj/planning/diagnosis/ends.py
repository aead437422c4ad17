"""Ends of a motion at rest that the motors cannot hold: static torques beyond their limits.

A robot can pass through such a pose, and even reach it while gravity slows it down. The ends are therefore not refused;
they are reported as a likely cause where a solve fails.
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
        Torque or force that holds the pose, and the limit of the motor [N m, N].
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
    """Return the fixed ends at rest whose gravity torques tau = g(q) exceed the motors, the largest excess first.

    Robots have a fixed root and neither contacts nor design parameters; other poses are held by forces that are
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
        # Dry friction supports a joint at rest.
        needed = max(abs(float(torques[i])) - float(robot.friction[i]), 0.0)
        limit = float(limits.effort[i]) if joint in robot.actuated else np.inf
        if needed > limit * (1 + 1e-9):
            entries.append(Unheld(phase.name, end, joint, needed, limit, "N m" if unit == "rad" else "N"))
    return entries
