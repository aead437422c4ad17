"""A rail in several phases, whose least time is known by its closed form."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin

import robotraj as rt

Judge = Callable[[rt.Solution], str]
"""Returns what is wrong with a solution, empty where nothing is."""
Array = np.ndarray

GRAVITY = 9.81
ROOM = 3.0
"""Bound of the positions [rad, m]."""


def rails(rng: np.random.Generator) -> tuple[rt.Problem, float]:
    """Least times of a mass on a vertical rail, at rest between two to four phases, and their sum by closed forms.

    With u = F / m - g, w = F / m + g in the direction of the motion, a phase of length d without the limit V of speed
    takes sqrt(2 d (1 / u + 1 / w)); with it, d / V + V (1 / u + 1 / w) / 2.
    """
    mass, speed = 10.0 ** rng.uniform(-2, 3), float(rng.uniform(0.3, 6.0))
    force = mass * GRAVITY * rng.uniform(1.2, 4.0)
    model = pin.Model()
    limits = (np.array([each]) for each in (force, speed, -2.0 * ROOM, 2.0 * ROOM))
    joint = model.addJoint(0, pin.JointModelPZ(), pin.SE3.Identity(), "lift", *limits)
    model.appendBodyToJoint(joint, pin.Inertia(mass, np.zeros(3), mass * np.eye(3)), pin.SE3.Identity())
    model.lowerEffortLimit = -model.upperEffortLimit
    robot = rt.load(model)
    steps = rng.uniform(0.1, 0.8, int(rng.integers(2, 5)))
    places = np.cumsum(np.append(0.0, steps * rng.choice([-1.0, 1.0], len(steps))))
    slow = 1.0 / (force / mass - GRAVITY) + 1.0 / (force / mass + GRAVITY)
    times = [
        np.sqrt(2.0 * d * slow) if 2.0 * d < speed**2 * slow else d / speed + 0.5 * speed * slow
        for d in np.abs(np.diff(places))
    ]
    ends = [rt.State(q=[each], v=0) for each in places]
    phases = [rt.Phase(robot, (1e-3, 60), *pair, rt.Duration()) for pair in zip(ends, ends[1:], strict=False)]
    return rt.Problem(phases, [rt.Continuity(k, k + 1) for k in range(len(phases) - 1)]), float(sum(times))
