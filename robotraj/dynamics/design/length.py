"""The length of a link as a parameter."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
import numpy.typing as npt

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.values import dataclass
from robotraj.dynamics.design.bodies import Bodies, Body
from robotraj.dynamics.design.quantity import Quantity
from robotraj.dynamics.variable import Scalar
from robotraj.robot.robot import Robot

MIN_LENGTH = 1e-6
"""Smallest length [m] that can be scaled."""


@dataclass(frozen=True)
class LinkLength(Quantity):
    """The parameter L is the length [m] of the body that a joint moves; the body is scaled along one direction.

    The length is the distance from the joint's origin to the tip along a direction with unit vector e. With the
    length L0 = e'r_tip of the URDF and S = 1 + (L/L0 - 1) e e', a point r of the body moves to S r. This applies to the
    origins of child joints and frames and to the centre of mass. The mass is constant. With the second moment
    P = int r r' dm about the joint's origin,

        h = S h0,    P = S P0 S,    I = tr(P) 1 - P.

    The inertia of a slender link about an axis at right angles to e is proportional to L^2. Rotations of frames and
    joints do not change.

    Parameters
    ----------
    joint : str
        The joint that moves the body.
    tip : str, optional
        End of the length: a child joint, or a frame on the body. Default: the only child joint; for the last body of
        a chain, the frame farthest from the joint.
    along : (float, float, float), optional
        e, in the joint's frame. Default: from the joint to the tip. Set it if the tip is offset sideways from the
        direction of the link.
    """

    joint: str
    tip: str | None = None
    along: Sequence[float] | None = None
    description = "length of the link of joint"

    @property
    def target(self) -> str:
        """Name of the joint."""
        return self.joint

    def unit(self, robot: Robot) -> str:
        """Metre."""
        return "m"

    def check(self, robot: Robot) -> tuple[object, ...]:
        """Check that the joint and the tip exist and determine a direction."""
        self.original(robot)
        return LinkLength, joint_id(robot, self.joint)

    def check_lower(self, name: str, lower: float) -> None:
        """Check that the lower bound of a length is positive."""
        if not lower > 0:
            raise InputError(
                f"Parameter {name!r} is the {self.label} and may be as low as {lower:g} m; "
                "bound it from below with more than 0, such as rt.between(0.5, 2)."
            )

    def original(self, robot: Robot) -> tuple[float, npt.NDArray[np.float64]]:
        """Return the length of the URDF [m] and its unit vector (3,) in the joint's frame.

        Raises
        ------
        InputError
            The joint or the tip is unknown. The tip is on another body or at the joint's origin. The body has several
            child joints, and no tip is given.
        """
        model, joint = robot.model, joint_id(robot, self.joint)
        children = {model.names[i]: model.jointPlacements[i].translation for i in _children(robot, joint)}
        frames = {f.name: f.placement.translation for f in model.frames if f.parentJoint == joint}
        if self.tip is not None:
            if self.tip not in children and self.tip not in frames:
                raise unknown_name("tip", self.tip, [*children, *frames], f"Name one on the body of {self.joint!r}.")
            tip = children[self.tip] if self.tip in children else frames[self.tip]
        elif len(children) > 1:
            raise InputError(
                f"rt.design.LinkLength: joint {self.joint!r} carries several joints ({', '.join(children)}); "
                f"choose one as the tip: rt.design.LinkLength({self.joint!r}, tip={next(iter(children))!r})."
            )
        else:
            tip = max((children or frames).values(), key=lambda r: float(np.linalg.norm(r)), default=np.zeros(3))
        direction = np.array(tip if self.along is None else self.along, dtype=float).ravel()
        norm = float(np.linalg.norm(direction))
        if direction.size != 3 or not np.isfinite(norm) or (self.along is not None and norm == 0):
            raise InputError(
                f"rt.design.LinkLength: along={self.along!r} is no direction; give three numbers, not all zero."
            )
        length = float(tip @ direction / norm) if norm > 0 else 0.0
        if abs(length) < MIN_LENGTH:
            raise InputError(
                f"rt.design.LinkLength: the body of joint {self.joint!r} has no length to its tip"
                f"{'' if self.tip is None else f' {self.tip!r}'}; name one away from it with tip=. "
                f"On it are: {', '.join([*children, *frames])}."
            )
        return abs(length), direction / norm

    def write(self, bodies: Bodies, value: Scalar) -> None:
        """Scale the body: every point r moves to S r."""
        robot, joint = bodies.robot, joint_id(bodies.robot, self.joint)
        length, direction = self.original(robot)
        along = np.outer(direction, direction)
        stretch = ca.DM.eye(3) + (value / length - 1) * ca.DM(along)
        body = bodies.body(joint)
        second = ca.mtimes([stretch, body.second, stretch])
        bodies.set_body(joint, Body(body.mass, ca.mtimes(stretch, body.first), second))
        for child in _children(robot, joint):
            bodies.set_joint_translation(child, ca.mtimes(stretch, bodies.joint_translation(child)))
        for index, frame in enumerate(robot.model.frames):
            if frame.parentJoint == joint and np.linalg.norm(along @ frame.placement.translation) > 0:
                bodies.set_frame_translation(index, ca.mtimes(stretch, bodies.frame_translation(index)))


def joint_id(robot: Robot, name: str) -> int:
    """Return Pinocchio's index of a moving joint.

    Raises
    ------
    UnknownName
        There is no moving joint of that name.
    """
    if name not in robot.joint_names:
        raise unknown_name("moving joint", name, robot.joint_names)
    return int(robot.model.getJointId(name))


def _children(robot: Robot, joint: int) -> list[int]:
    model = robot.model
    return [i for i in range(1, model.njoints) if model.parents[i] == joint]
