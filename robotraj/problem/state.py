"""The state at an end of a phase: free, fixed or bounded, by joint or state name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import cast

import numpy as np

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass, own_fields
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.path_body import PathBody
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.problem.augmentation import body_of
from robotraj.problem.constraints.base import Where
from robotraj.problem.constraints.bounds import Bounds, BoundsLike, Interval, NearTurn, as_bounds
from robotraj.robot.configuration import unit_quaternion
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION

TURN = 2.0 * np.pi


@dataclass(frozen=True)
class State(OneLine):
    """The state at the start or the end of a phase.

    None leaves a value free, a number fixes it, ``rt.between(lower, upper)`` bounds it, and ``rt.turns(angle)`` fixes
    the angle of a joint up to whole turns. Joints that a mapping does not
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
    a : None, number, Between, sequence or mapping by joint name, optional
        Accelerations (nv) [rad/s^2, m/s^2], such as measured ones of a moving robot. None is 0 at rest under limits
        of jerk, and free otherwise (``rt.constraints.JointJerk``).
    """

    values: BoundsLike = None
    q: BoundsLike = None
    v: BoundsLike = None
    a: BoundsLike = None

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
            if not all(given is None for given in (self.values, self.q, self.v, self.a)):
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
        if not all(given is None for given in (self.q, self.v, self.a)):
            raise InputError(f"The {which} of a System is rt.State({{name: value}}); q=, v= and a= are for robots.")
        return as_bounds(self.values, [s.name for s in dynamics.states], f"{which} state", "state")


def near_turns(
    state: State | None, other: State | None, robot: Robot, limits: Limits | None, which: str
) -> State | None:
    """Return a state with a number for every ``rt.turns``: the turn nearest to the other end of the phase.

    Parameters
    ----------
    state, other : State, optional
        The states at this end and at the other one.
    robot : Robot
    limits : Limits, optional
        Position limits within which the turn lies.
    which : str
        ``"start"`` or ``"end"``, for messages.

    Raises
    ------
    InputError
        The joint slides, or no turn lies within its limits.
    """
    if state is None or not _has_turns(state.q):
        return state
    names, q = list(robot.position_names), state.q
    if isinstance(q, Mapping):
        every: dict[str, Interval] = dict(q)
    else:
        entries = list(q) if isinstance(q, list | tuple) else [cast("Interval", q)] * len(names)
        if len(entries) != len(names):
            raise InputError(
                f"The {which} position has {len(entries)} values; it needs {len(names)}: {', '.join(names)}."
            )
        every = dict(zip(names, entries, strict=True))
    known = None if other is None or _has_turns(other.q) else as_bounds(other.q, names, "other end")
    for name, value in every.items():
        if not isinstance(value, NearTurn):
            continue
        if name not in names:
            raise unknown_name("joint", name, names, f"It was used in the {which} position.")
        i = names.index(name)
        if robot.position_units[i] != "rad":
            raise InputError(f"The {which} position of {name!r} is rt.turns, but it is no angle; give a number.")
        fixed = known is not None and known.lower[i] == known.upper[i]
        near = float(known.lower[i]) if known is not None and fixed else float(robot.neutral[i])
        low, high = (-np.inf, np.inf) if limits is None else (float(side[i]) for side in limits.positions)
        first = value.angle + TURN * round((near - value.angle) / TURN)
        # The nearest turn and its neighbours, the nearest one within the limits.
        found = [each for k in (0, 1, -1) if low <= (each := first + k * TURN) <= high]
        if not found:
            raise InputError(
                f"The {which} position of {name!r} is {value.angle:g} rad up to whole turns; no such angle near "
                f"{near:g} lies within its limits [{low:g}, {high:g}] rad."
            )
        every[name] = min(found, key=lambda each: abs(each - near))
    return replace(state, q=every if isinstance(q, Mapping) else list(every.values()))


def _has_turns(q: object) -> bool:
    if isinstance(q, Mapping):
        return any(isinstance(value, NearTurn) for value in q.values())
    return isinstance(q, NearTurn) or (isinstance(q, list | tuple) and any(isinstance(each, NearTurn) for each in q))


def far_turns(ends: Mapping[Where, Bounds], robot: Robot, limits: Limits | None) -> str:
    """Name the first joint without position limits that turns by more than half a turn; empty if there is none."""
    start, end = ends[Where.START], ends[Where.END]
    low, high = (-np.full(robot.nq, np.inf), np.full(robot.nq, np.inf)) if limits is None else limits.positions
    for i, (name, unit) in enumerate(zip(robot.position_names, robot.position_units, strict=True)):
        fixed = start.lower[i] == start.upper[i] and end.lower[i] == end.upper[i]
        if unit != "rad" or name.startswith("root_") or not fixed or np.isfinite([low[i], high[i]]).any():
            continue
        way = float(end.lower[i] - start.lower[i])
        if abs(way) > 0.5 * TURN * (1.0 + 1e-9):
            near = way - TURN * round(way / TURN)
            return (
                f"Joint {name!r} turns by {way:.4g} rad from start to end; the same pose is {abs(near):.4g} rad away. "
                f"For that give rt.turns({float(end.lower[i]):g}) as its end."
            )
    return ""


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
