"""Robots whose answer is known: chains of joints in other units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

import robotraj as rt

Judge = Callable[[rt.Solution], str]
"""Returns what is wrong with a solution, empty where nothing is."""
Array = np.ndarray

GRAVITY = 9.81
UNITS = ((1e3, 1e3), (1e6, 1.0), (1.0, 1e-9), (1e-3, 1e3))
"""Numbers of units in a metre and in a kilogram: mm and g, um and kg, m and a unit of 1e9 kg, km and g."""
ALIKE = 1e-3
"""Relative difference of two objectives in other units that is wrong."""
ROOM = 3.0
"""Bound of the positions [rad, m]."""


@dataclass(frozen=True)
class Chain:
    """A chain of joints in SI units, with drawn ends and limits."""

    turns: Array
    axes: Array
    places: Array
    masses: Array
    centres: Array
    inertias: Array
    ends: Array
    speeds: Array
    strength: float
    damping: float
    duration: float | None

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Chain:
        """Draw one to three joints, which turn, slide or do both; the latter move in least time."""
        count, kind = int(rng.integers(1, 4)), int(rng.integers(3))
        turns = np.full(count, kind == 0) if kind < 2 else rng.random(count) < 0.5
        effort = bool(turns.all() or not turns.any()) and rng.random() < 0.5
        return cls(
            turns,
            rng.integers(3, size=count),
            rng.uniform(-0.4, 0.4, (count, 3)),
            rng.uniform(0.5, 4.0, count),
            rng.uniform(-0.3, 0.3, (count, 3)),
            rng.uniform(0.01, 0.05, count),
            rng.uniform(-0.8, 0.8, (2, count)),
            rng.uniform(2.0, 6.0, count),
            float(rng.uniform(1.3, 3.0)),
            float(rng.choice([0.0, 0.3])),
            float(rng.uniform(2.0, 10.0)) if effort else None,
        )

    def phase(self, metre: float, kilogram: float) -> tuple[rt.Phase, float]:
        """Return the motion in units of which a metre and a kilogram have so many, and the unit of its objective."""
        model, parent = pin.Model(), 0
        model.gravity.linear = np.array([0.0, 0.0, -GRAVITY * metre])
        position = np.where(self.turns, 1.0, metre)
        effort = kilogram * metre * np.where(self.turns, metre, 1.0)
        # Twice the weight of all that is moved, at the reach of the chain, holds any joint.
        needed = 2.0 * GRAVITY * self.masses.sum() * effort * self.strength
        for i in range(len(self.turns)):
            axis = np.eye(3)[self.axes[i]]
            joint = pin.JointModelRevoluteUnaligned(axis) if self.turns[i] else pin.JointModelPrismaticUnaligned(axis)
            limits = (
                np.array([each]) for each in (needed[i], self.speeds[i] * position[i], *(ROOM * position[i] * SIGNS))
            )
            parent = model.addJoint(
                parent, joint, pin.SE3(np.eye(3), (i > 0) * metre * self.places[i]), f"joint {i}", *limits
            )
            inertia = self.inertias[i] * kilogram * metre**2 * np.eye(3)
            body = pin.Inertia(self.masses[i] * kilogram, self.centres[i] * metre, inertia)
            model.appendBodyToJoint(parent, body, pin.SE3.Identity())
        model.lowerEffortLimit = -model.upperEffortLimit
        model.damping = self.damping * effort / position
        first, last = (rt.State(q=each * position, v=0) for each in self.ends)
        robot = rt.load(model)
        if self.duration is None:
            return rt.Phase(robot, (0.05, 60), first, last, rt.Duration(), name="chain"), 1.0
        return rt.Phase(robot, self.duration, first, last, rt.Effort(), name="chain"), float(effort[0] ** 2)


SIGNS = np.array([-1.0, 1.0])


def other_units(rng: np.random.Generator) -> tuple[rt.Phase, Judge]:
    """A chain of joints in other units: a plan in SI units that starts from it has its objective, or its own there."""
    chain = Chain.drawn(rng)
    metre, kilogram = UNITS[int(rng.integers(len(UNITS)))]
    phase, unit = chain.phase(metre, kilogram)

    def planned_from(found: rt.Solution, scale: tuple[float, float], other: rt.Phase) -> rt.Solution:
        times = np.linspace(0.0, found.duration, 101)
        q = found.at(times).q * np.where(chain.turns, 1.0, scale[1] / scale[0])
        return rt.plan(other, guess=rt.Guess(times, q=q), check=False, progress=False)

    def judge(solution: rt.Solution) -> str:
        known = planned_from(solution, (metre, 1.0), chain.phase(1.0, 1.0)[0])
        if known.proof is None or not known.proof.holds:
            return "the same problem in SI units is not proved"
        if abs(solution.objective / unit - known.objective) > ALIKE * abs(known.objective):
            # A guess may lead to another optimum; the units must not matter there either.
            back = planned_from(known, (1.0, metre), phase)
            if abs(back.objective / unit - known.objective) > ALIKE * abs(known.objective):
                return f"objective {back.objective / unit:.8g} in SI units, where it is {known.objective:.8g}"
        return ""

    return phase, judge
