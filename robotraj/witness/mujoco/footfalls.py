"""Forces, slip, sink and touchdowns of each foot during a simulation in MuJoCo."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array
from robotraj.witness.mujoco.feet import Foot
from robotraj.witness.mujoco.package import load_mujoco
from robotraj.witness.mujoco.report import FootReport

if TYPE_CHECKING:
    import mujoco

LEAST = 1e-3
"""Force, relative to the weight, below which a foot is off the ground."""

BOUNCE = 0.01
"""Shortest time [s] without load that ends a stance."""


class Footfalls:
    """Records the feet at every step.

    Parameters
    ----------
    model : mujoco.MjModel
    feet : sequence of Foot
    """

    def __init__(self, model: mujoco.MjModel, feet: Sequence[Foot]) -> None:
        self._mujoco, self._model = load_mujoco(), model
        self._feet = tuple(feet)
        self._of_geom = {model.geom(foot.name).id: i for i, foot in enumerate(feet)}
        gravity = float(np.linalg.norm(model.opt.gravity))
        self._least = LEAST * max(gravity * float(model.body_mass.sum()), 1e-9)
        count = len(feet)
        self._impulse, self._slid = np.zeros((count, 3)), np.zeros((count, 3))
        self._slip, self._sink, self._loaded = np.zeros(count), np.zeros(count), np.zeros(count)
        self._now = np.zeros(count)
        self._stances, self._off, self._time = np.zeros(count, dtype=int), np.full(count, np.inf), 0.0

    def watch(self, data: mujoco.MjData, duration: float) -> None:
        """Add a step of that duration [s] with the contacts and forces in ``data``."""
        self._time += duration
        count = len(self._feet)
        force, normal, motion = np.zeros((count, 3)), np.zeros(count), np.zeros((count, 3))
        for c in range(data.ncon):
            contact = data.contact[c]
            # Planes and height fields are MuJoCo's first geom: the second is the foot, and the force acts on it.
            foot = self._of_geom[int(contact.geom[1])]
            self._sink[foot] = max(self._sink[foot], -float(contact.dist))
            axes, parts = contact.frame.reshape(3, 3), np.zeros(6)
            self._mujoco.mj_contactForce(self._model, data, c, parts)
            force[foot] += axes.T @ parts[:3]
            normal[foot] += parts[0]
            motion[foot] += parts[0] * self._sliding(data, contact, axes)
        self._now = normal
        for i in range(count):
            if normal[i] <= self._least:
                self._off[i] += duration
                continue
            if self._off[i] > BOUNCE:
                self._stances[i] += 1
                self._slid[i] = 0.0
            self._off[i] = 0.0
            self._loaded[i] += duration
            self._impulse[i] += force[i] * duration
            # The slip of a foot with several contact points is the mean, weighted by load.
            self._slid[i] += motion[i] / normal[i] * duration
            self._slip[i] = max(self._slip[i], float(np.linalg.norm(self._slid[i])))

    def carry(self, names: Sequence[str]) -> bool:
        """Whether any of these feet carries load."""
        return any(self._now[i] > self._least for i, foot in enumerate(self._feet) if foot.name in names)

    def _sliding(self, data: mujoco.MjData, contact: mujoco.MjContact, axes: Array) -> Array:
        """Return the velocity (3,) of the foot's surface along the ground [m/s], zero for rolling."""
        geom, twist = int(contact.geom[1]), np.zeros(6)
        self._mujoco.mj_objectVelocity(self._model, data, self._mujoco.mjtObj.mjOBJ_GEOM, geom, twist, 0)
        wx, wy, wz = twist[:3]
        x, y, z = contact.pos - data.geom_xpos[geom]
        velocity = twist[3:] + [wy * z - wz * y, wz * x - wx * z, wx * y - wy * x]
        return np.asarray(velocity - axes[0] * (axes[0] @ velocity))

    def reports(self, planned: Mapping[str, Array]) -> tuple[FootReport, ...]:
        """Return the reports of all feet, with the planned mean forces (3,) by foot."""
        time = max(self._time, 1e-12)
        return tuple(
            FootReport(
                foot.name,
                float(self._slip[i]),
                float(self._sink[i]),
                self._impulse[i] / time,
                planned.get(foot.name),
                float(self._loaded[i] / time),
                int(self._stances[i]),
            )
            for i, foot in enumerate(self._feet)
        )
