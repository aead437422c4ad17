"""Six robots, from two joints to a humanoid, each with 100 random points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from importlib import metadata
from pathlib import Path

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

from robotraj.symbolic import SymbolicModel

COUNT = 100
DESCRIPTIONS = Path(
    str(metadata.distribution("example-robot-data").locate_file("cmeel.prefix/share/example-robot-data/robots"))
)
FIXED = {
    "double_pendulum": "double_pendulum_description/urdf/double_pendulum.urdf",
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "panda": "panda_description/urdf/panda.urdf",
    "kinova": "kinova_description/robots/kinova.urdf",
}
FLOATING = {
    "solo12": "solo_description/robots/solo12.urdf",
    "talos": "talos_data/robots/talos_full_v2.urdf",
}


@dataclass(frozen=True)
class Case:
    """A robot with its functions and random points, one point a column."""

    name: str
    model: pin.Model
    symbolic: SymbolicModel
    points: dict[str, np.ndarray]

    @cached_property
    def data(self) -> pin.Data:
        return self.model.createData()

    @property
    def frames(self) -> list[str]:
        """Of the frames that move: the first, one half-way and the last."""
        moving = [frame.name for frame in self.model.frames if frame.parentJoint > 0]
        return [moving[0], moving[len(moving) // 2], moving[-1]]

    def evaluate(self, function: ca.Function, count: int = COUNT, **more: np.ndarray) -> list[np.ndarray]:
        """Every output of a function at the first points: arrays of shape (count, rows, columns)."""
        values = {**self.points, **more}
        columns = [
            values[name].reshape(function.size1_in(i), -1)[:, : count * function.size2_in(i)]
            for i, name in enumerate(function.name_in())
        ]
        results = function.map(count).call(columns)
        return [np.array(result).reshape(result.shape[0], count, -1).transpose(1, 0, 2) for result in results]

    def point(self, index: int) -> dict[str, np.ndarray]:
        """One point, with ``fext`` as 6 x njoints and ``forces`` in Pinocchio's format."""
        njoints = self.model.njoints
        values = {
            name: value[:, index].copy() for name, value in self.points.items() if name not in ("fext", "direction")
        }
        values["fext"] = self.points["fext"][:, index * njoints : (index + 1) * njoints].copy()
        forces = pin.StdVec_Force()
        forces.extend(pin.Force(wrench) for wrench in values["fext"].T)
        values["forces"] = forces
        return values


def build(name: str) -> Case:
    floating = name in FLOATING
    path = str(DESCRIPTIONS / (FLOATING if floating else FIXED)[name])
    model = pin.buildModelFromUrdf(path, pin.JointModelFreeFlyer()) if floating else pin.buildModelFromUrdf(path)
    rng = np.random.default_rng(20)
    model.armature[6 if floating else 0 :] = rng.uniform(0.01, 0.1, model.nv - (6 if floating else 0))
    neutral = pin.neutral(model)

    def configurations() -> np.ndarray:
        steps = rng.uniform(-np.pi, np.pi, (COUNT, model.nv))
        return np.column_stack([pin.integrate(model, neutral, step) for step in steps])

    def vectors(scale: float = 1.0) -> np.ndarray:
        return scale * rng.standard_normal((model.nv, COUNT))

    q = configurations()
    dv = vectors(0.4)
    points = {
        "q": q,
        "v": vectors(),
        "a": vectors(5.0),
        "tau": vectors(20.0),
        "fext": 10.0 * rng.standard_normal((6, model.njoints * COUNT)),
        "dv": dv,
        "q0": q,
        "q1": np.column_stack([pin.integrate(model, q[:, i], dv[:, i]) for i in range(COUNT)]),
        "direction": vectors(),
    }
    return Case(name, model, SymbolicModel(model), points)


@pytest.fixture(scope="session", params=[*FIXED, *FLOATING])
def case(request: pytest.FixtureRequest) -> Case:
    return build(request.param)


@pytest.fixture(scope="session")
def arm() -> Case:
    return build("ur5")
