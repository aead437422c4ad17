"""Mass moments, placements, damping and armature of a robot's bodies, which the quantities of a design replace."""

from __future__ import annotations

import casadi as ca
import numpy as np

from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Column, Scalar
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class Body:
    """Mass moments of a body about the origin of its joint, in the joint's axes; linear in the mass.

    Attributes
    ----------
    mass : scalar
        m [kg].
    first : column (3,)
        h = int r dm = m c [kg m].
    second : matrix (3, 3)
        P = int r r' dm [kg m^2]; the rotational inertia is I = tr(P) 1 - P, and P = tr(I) 1 / 2 - I.
    """

    mass: Scalar
    first: Column
    second: Column

    @property
    def parameters(self) -> ca.SX:
        """Pinocchio's dynamic parameters (10,): m, h, then Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the origin."""
        p = self.second
        inertia = [p[1, 1] + p[2, 2], -p[0, 1], p[0, 0] + p[2, 2], -p[0, 2], -p[1, 2], p[0, 0] + p[1, 1]]
        return ca.vertcat(self.mass, self.first, *inertia)


class Bodies:
    """The bodies of a robot. Quantities replace some of their parameters; the others are those of the model.

    A body consists of all links that move rigidly with one joint. Indices are Pinocchio's: joint 0 is the world.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._bodies: dict[int, Body] = {}
        self._joints: dict[int, Column] = {}
        self._frames: dict[int, Column] = {}
        self._damping: dict[int, Scalar] = {}
        self._armature: dict[int, Scalar] = {}

    def body(self, joint: int) -> Body:
        """Moments of a joint's body."""
        if joint not in self._bodies:
            own = self.robot.model.inertias[joint].toDynamicParameters()
            xx, xy, yy, xz, yz, zz = own[4:]
            inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            second = 0.5 * np.trace(inertia) * np.eye(3) - inertia
            return Body(own[0], ca.DM(own[1:4]), ca.DM(second))
        return self._bodies[joint]

    def set_body(self, joint: int, body: Body) -> None:
        """Replace the moments of a joint's body."""
        self._bodies[joint] = body

    def joint_translation(self, joint: int) -> ca.SX:
        """Origin of a joint in its parent joint's frame, (3,) [m]."""
        return self._joints.get(joint, ca.DM(self.robot.model.jointPlacements[joint].translation))

    def set_joint_translation(self, joint: int, translation: Column) -> None:
        """Move a joint's origin in its parent joint's frame."""
        self._joints[joint] = translation

    def frame_translation(self, frame: int) -> ca.SX:
        """Origin of a frame in its joint's frame, (3,) [m]."""
        return self._frames.get(frame, ca.DM(self.robot.model.frames[frame].placement.translation))

    def set_frame_translation(self, frame: int, translation: Column) -> None:
        """Move a frame's origin in its joint's frame."""
        self._frames[frame] = translation

    def set_damping(self, index: int, damping: Scalar) -> None:
        """Replace the viscous damping of the joint at ``index`` of v [N m s/rad, N s/m]."""
        self._damping[index] = damping

    def set_armature(self, index: int, armature: Scalar) -> None:
        """Replace the armature of the joint at ``index`` of v [kg m^2, kg]."""
        self._armature[index] = armature

    @property
    def moved_frames(self) -> tuple[int, ...]:
        """Frames whose placement on their joint differs from the model's."""
        return tuple(self._frames)

    @property
    def inertias(self) -> ca.SX:
        """Dynamic parameters of every joint's body, 10 x njoints."""
        model = self.robot.model
        own = [ca.DM(inertia.toDynamicParameters()) for inertia in model.inertias]
        return ca.horzcat(*(self._bodies[i].parameters if i in self._bodies else own[i] for i in range(model.njoints)))

    @property
    def translations(self) -> ca.SX:
        """Origin of every joint in its parent's frame, 3 x njoints [m]."""
        return ca.horzcat(*(self.joint_translation(i) for i in range(self.robot.model.njoints)))

    @property
    def damping(self) -> ca.SX:
        """Viscous damping of every joint, (nv,)."""
        return ca.vertcat(*(self._damping.get(i, own) for i, own in enumerate(self.robot.damping)))

    @property
    def added_armature(self) -> ca.SX | None:
        """Armature of every joint beyond the model's, (nv,) [kg m^2, kg]; None where no quantity replaces one."""
        if not self._armature:
            return None
        known = self.robot.model.armature
        return ca.vertcat(*(self._armature[i] - own if i in self._armature else 0.0 for i, own in enumerate(known)))
