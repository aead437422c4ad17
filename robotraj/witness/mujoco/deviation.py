"""The deviation of a robot in MuJoCo from its plan, and the detection of falls."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.dynamics.terrain.base import Ground
from robotraj.robot.robot import Robot
from robotraj.witness.mujoco.roots import RootCoordinates
from robotraj.witness.plants.plant import RATE_UNITS
from robotraj.witness.simulation.drift import VELOCITY_SCALE, Drift, DriftRow

FLYING_POSITIONS = ("root_x", "root_y", "root_z", "root_rx", "root_ry", "root_rz")
FLYING_VELOCITIES = ("root_vx", "root_vy", "root_vz", "root_wx", "root_wy", "root_wz")

LEANING = 0.8
"""Rotation of the root against the plan [rad] above which the robot has fallen."""

LOW = 0.5
"""Share of the planned height of the centre of mass below which the robot has fallen."""


def labels(robot: Robot) -> tuple[list[str], list[str]]:
    """Return names and units (2 nv,) of a deviation in position and velocity."""
    positions: list[str] = []
    velocities: list[str] = []
    units: list[str] = []
    for joint in robot.model.joints.tolist()[1:]:
        name = robot.model.names[joint.id]
        if not joint.nv:
            continue  # it follows another joint
        flying = joint.nv == 6
        positions += FLYING_POSITIONS if flying else [name]
        velocities += FLYING_VELOCITIES if flying else [name]
        units += ["m"] * 3 + ["rad"] * 3 if flying else [_unit(joint)]
    names = [f"q.{name}" for name in positions] + [f"v.{name}" for name in velocities]
    return names, units + [RATE_UNITS[unit] for unit in units]


def deviation_of(
    robot: Robot, times: Array, gaps: Array, planned: Array, q: Array, phases: list[str], ended: bool
) -> Drift:
    """Return the largest and final deviation of every state from deviations (m, 2 nv) at times (m,).

    Parameters
    ----------
    planned : ndarray (m, nv)
        Planned velocities, which scale those of the deviation.
    q : ndarray (m, nq)
        Planned positions.
    phases : list of str
        Name of the phase of each sample.
    ended : bool
        Whether the last sample is the end of the plan; if not, final deviations are infinite.
    """
    names, units = labels(robot)
    root = RootCoordinates(robot.model)
    gaps = np.array([root.upright(position, gap) for position, gap in zip(q, gaps, strict=True)])
    sizes = np.nan_to_num(np.abs(gaps), nan=np.inf)
    speeds = np.abs(planned).max(axis=0, initial=0.0)
    scales = np.concatenate([np.ones(len(speeds)), VELOCITY_SCALE * np.maximum(1.0, speeds)])
    rows = []
    for i, (name, unit) in enumerate(zip(names, units, strict=True)):
        worst = int(np.argmax(sizes[:, i]))
        final = float(sizes[-1, i]) if ended else np.inf
        rows.append(
            DriftRow(name, unit, final, float(sizes[worst, i]), float(times[worst]), phases[worst], float(scales[i]))
        )
    return Drift(tuple(rows))


class Fall:
    """Detects falls of a robot whose root moves.

    Parameters
    ----------
    robot : Robot
    ground : Ground
    """

    def __init__(self, robot: Robot, ground: Ground) -> None:
        self._model, self._data, self._ground = robot.model, robot.model.createData(), ground
        self._root = RootCoordinates(robot.model)

    def reason(self, planned: Array, q: Array, gap: Array) -> str | None:
        """Return why the robot at q (nq,) has fallen, None if it has not.

        Parameters
        ----------
        planned : ndarray (nq,)
            Planned configuration.
        gap : ndarray (2 nv,)
            Deviation from it.
        """
        if not self._root.moves:
            return None
        turned = float(np.linalg.norm(gap[self._root.turns]))
        if turned > LEANING:
            return f"its root is turned by {turned:.2g} rad against the plan, more than {LEANING:g} rad"
        height, wanted = self._height(q), self._height(planned)
        if height < LOW * wanted:
            return f"its centre of mass is {height:.2g} m above the ground, below {LOW:g} of the planned {wanted:.2g} m"
        return None

    def _height(self, q: Array) -> float:
        x, y, z = pin.centerOfMass(self._model, self._data, q)
        return float(z - self._ground.height(float(x), float(y)))


def _unit(joint: pin.JointModel) -> str:
    return "m" if joint.shortname().startswith(("JointModelP", "JointModelHelical")) else "rad"
