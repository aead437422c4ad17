"""The state at an end of a phase: free, fixed or bounded, by joint or state name."""

from __future__ import annotations

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass, own_fields
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.path_body import PathBody
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.problem.augmentation import body_of
from robotraj.problem.constraints.bounds import Bounds, BoundsLike, as_bounds
from robotraj.robot.configuration import unit_quaternion
from robotraj.robot.root import QUATERNION


@dataclass(frozen=True)
class State(OneLine):
    """The state at the start or the end of a phase.

    None leaves a value free, a number fixes it, ``rt.between(lower, upper)`` bounds it. Joints that a mapping does not
    name stay free. Arrays, lists and mappings are copied, so later changes to them have no effect.

    Parameters
    ----------
    values : mapping or sequence, optional
        For a System: values by state name, or one value per state.
    q, v : None, number, Between, sequence or mapping by joint name, optional
        For a robot: positions (nq) [rad, m] and velocities (nv) [rad/s, m/s], those of a moving root first. The
        names are ``robot.position_names`` and ``robot.velocity_names``. The quaternion of a floating root, (x, y, z,
        w), must have length 1. Its negative is the same attitude, one full turn later. An end quaternion q is an even
        number of full turns away, and -q an odd number; the guess determines the direction.
    """

    values: BoundsLike = None
    q: BoundsLike = None
    v: BoundsLike = None

    def __post_init__(self) -> None:
        own_fields(self)

    def bounds(self, dynamics: Dynamics, which: str) -> Bounds:
        """Bounds on the state vector, (nx,) each; ``which`` is ``"start"`` or ``"end"``, for messages.

        States that an objective added stay free.

        Raises
        ------
        InputError
            A name is unknown, a length is wrong, a value is NaN, a quaternion's length is not 1, or q or v is given
            for a System.
        """
        body = body_of(dynamics)
        given = self._bounds(body, which)
        if dynamics is body:
            return given
        added = np.full(len(dynamics.states) - len(body.states), np.inf)
        return Bounds(np.append(given.lower, -added), np.append(given.upper, added))

    def _bounds(self, dynamics: Dynamics, which: str) -> Bounds:
        if isinstance(dynamics, PathBody):
            if not (self.values is None and self.q is None and self.v is None):
                raise InputError(f"FollowPath determines the {which} of the phase; leave {which}= out.")
            return Bounds(*dynamics.ends(which == "end"))
        if isinstance(dynamics, RigidBody):
            if self.values is not None:
                raise InputError(
                    f"The {which} of a robot is rt.State(q=..., v=...); positional values are for Systems."
                )
            robot = dynamics.robot
            q = as_bounds(self.q, robot.position_names, f"{which} position")
            v = as_bounds(self.v, robot.velocity_names, f"{which} velocity")
            if robot.root == "floating":
                _turn(q, f"{which} position")
            return Bounds(np.concatenate([q.lower, v.lower]), np.concatenate([q.upper, v.upper]))
        if self.q is not None or self.v is not None:
            raise InputError(f"The {which} of a System is rt.State({{name: value}}); q= and v= are for robots.")
        return as_bounds(self.values, [s.name for s in dynamics.states], f"{which} state", "state")


def _turn(q: Bounds, what: str) -> None:
    """Normalise the quaternion of a position in place; refuse bounds that contain no unit quaternion."""
    lower, upper = q.lower[QUATERNION], q.upper[QUATERNION]
    if np.array_equal(lower, upper):
        lower[:] = upper[:] = unit_quaternion(lower, what)
        return
    with np.errstate(invalid="ignore"):
        nearest = np.where(lower * upper <= 0, 0.0, np.minimum(np.abs(lower), np.abs(upper)))
    farthest = np.maximum(np.abs(lower), np.abs(upper))
    if np.linalg.norm(nearest) > 1 or np.linalg.norm(farthest) < 1:
        raise InputError(
            f"{what}: no quaternion (x, y, z, w) of the root within {lower.tolist()} and {upper.tolist()} has "
            "length 1; give other bounds."
        )
