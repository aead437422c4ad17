"""Disturbances of a plan: wrong masses and friction, pushes, noise of sensors, delay."""

from __future__ import annotations

import copy
from dataclasses import fields, replace
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.checks import is_finite
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass

if TYPE_CHECKING:
    import mujoco

PUSH_TIME = 0.02
"""Duration of a push [s]."""


@dataclass(frozen=True)
class Disturbances(OneLine):
    """Standard deviations of independent normal disturbances; 0 switches one off.

    Parameters
    ----------
    position, velocity : float
        Standard deviation of the first state of every joint [rad, m], [rad/s, m/s].
    mass : float
        Relative standard deviation of the mass and inertia of every body.
    friction : float
        Relative standard deviation of damping and dry friction of every joint.
    position_noise, velocity_noise : float
        Standard deviation of every measurement [rad, m], [rad/s, m/s].
    push : float
        Standard deviation of each component of one impulse [N s]. It acts within 20 ms at the centre of mass of a
        random body, at a random time.
    delay : float
        Time from a measurement to the torque that depends on it [s]; the same in every run.

    Raises
    ------
    InputError
        A value is negative or not finite.
    """

    position: float = 0.01
    velocity: float = 0.0
    mass: float = 0.05
    friction: float = 0.2
    position_noise: float = 1e-4
    velocity_noise: float = 1e-2
    push: float = 0.1
    delay: float = 1e-3

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            if not (is_finite(value) and value >= 0.0):
                raise InputError(f"Disturbances({entry.name}) is {value!r}; give 0 or a positive number.")

    def scaled(self, factor: float) -> Disturbances:
        """Return disturbances of ``factor`` times the size, the delay included."""
        return replace(self, **{entry.name: factor * getattr(self, entry.name) for entry in fields(self)})

    def of_model(self, mujoco: ModuleType, model: mujoco.MjModel, rng: np.random.Generator) -> mujoco.MjModel:
        """Return a copy of a MuJoCo model with other masses, inertias and friction."""
        other = copy.copy(model)
        factors = np.exp(self.mass * rng.standard_normal(model.nbody))
        other.body_mass[:] = model.body_mass * factors
        other.body_inertia[:] = model.body_inertia * factors[:, None]
        rubs = np.exp(self.friction * rng.standard_normal(model.nv))
        other.dof_damping[:], other.dof_frictionloss[:] = model.dof_damping * rubs, model.dof_frictionloss * rubs
        mujoco.mj_setConst(other, mujoco.MjData(other))
        return other

    def push_of(self, bodies: int, duration: float, rng: np.random.Generator) -> tuple[int, float, np.ndarray]:
        """Return the body, the beginning [s] and the force (3,) [N] of a push."""
        body, begin = int(rng.integers(1, bodies)), float(rng.uniform(0.0, max(0.0, duration - PUSH_TIME)))
        return body, begin, self.push * rng.standard_normal(3) / PUSH_TIME
