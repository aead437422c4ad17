"""Planar robots by plain Pinocchio, one foot pinned or struck: robotraj only loads them."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

import robotraj as rt

OTHER = {"left": "right", "right": "left"}


class Planar:
    """A robot whose root link moves in x, z and pitch: the pinned foot and the impact from M and J."""

    def __init__(self, name: str) -> None:
        robot = rt.load(name, root="planar")
        self.model, self.names = robot.model, robot.velocity_names
        self.data = self.model.createData()

    def vector(self, values: dict[str, float]) -> np.ndarray:
        assert set(values) <= set(self.names)
        return np.array([values.get(name, 0.0) for name in self.names])

    def place(self, frame: str, q: np.ndarray) -> np.ndarray:
        pin.framesForwardKinematics(self.model, self.data, q)
        return self.data.oMf[self.model.getFrameId(frame)].translation[[0, 2]]

    def jacobian(self, frame: str, q: np.ndarray) -> np.ndarray:
        return pin.computeFrameJacobian(
            self.model, self.data, q, self.model.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED
        )[[0, 2]]

    def mass(self, q: np.ndarray) -> np.ndarray:
        upper = np.triu(pin.crba(self.model, self.data, q))
        return upper + np.triu(upper, 1).T

    def standing(self, frame: str, v: np.ndarray, q: np.ndarray) -> np.ndarray:
        """Choose the root's translation such that the foot does not move."""
        v = v.copy()
        v[:2] -= self.jacobian(frame, q) @ v
        return v

    def pinned(self, frame: str, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        """Return the accelerations while the foot is held: M a + h = tau + J' f, J a + J' v = 0."""
        h = pin.nonLinearEffects(self.model, self.data, q, v)
        pin.forwardKinematics(self.model, self.data, q, v, np.zeros_like(v))
        drift = pin.getFrameClassicalAcceleration(
            self.model, self.data, self.model.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED
        ).linear[[0, 2]]
        return self.saddle(frame, q, np.concatenate([tau - h, -drift]))

    def impact(self, frame: str, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return the velocities after the foot's impact: M (v+ - v-) = J' impulse, J v+ = 0."""
        return self.saddle(frame, q, np.concatenate([self.mass(q) @ v, [0.0, 0.0]]))

    def saddle(self, frame: str, q: np.ndarray, right: np.ndarray) -> np.ndarray:
        j = self.jacobian(frame, q)
        return np.linalg.solve(np.block([[self.mass(q), j.T], [j, np.zeros((2, 2))]]), right)[: self.model.nv]
