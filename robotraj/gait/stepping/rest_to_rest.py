"""Motions from rest to rest: a walk that starts and stops, sidesteps, turns on the spot."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.gait.checks import number
from robotraj.gait.feet import feet_of, foot_contact
from robotraj.gait.repetition import on_ground
from robotraj.gait.stepping.footholds import LEVEL, StepOptions, steps
from robotraj.gait.stepping.stances import FeetOverlap
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import standing
from robotraj.problem.problem import Problem
from robotraj.robot.loading.other_units import doubt_of_unit
from robotraj.robot.robot import Robot

if TYPE_CHECKING:
    from typing_extensions import Unpack


LEAST_TURN = 0.1
"""Turn in a pair of steps [rad] below which no smaller one is tried."""


def start_stop(robot: Robot, *, step_length: float, count: int = 4, **options: Unpack[StepOptions]) -> Problem:
    """Return a walk from rest to rest: ``count`` steps forward, the first and the last half as long.

    Bipeds move one foot a step, quadrupeds the diagonal pairs of feet in turn.

    Parameters
    ----------
    robot : Robot
        With ``root="planar"`` or ``"floating"``.
    step_length : float
        Displacement of the root in a full step [m]; negative backwards.
    count : int
        Number of steps, at least 2.
    **options
        Of ``rt.gait.steps``.

    Raises
    ------
    InputError
        There are fewer than two steps, the length is no number, or the robot has neither two nor four feet. Further
        errors are those of ``steps``.
    """
    length = number(step_length, "rt.gait.start_stop(step_length)")
    if not isinstance(count, int) or count < 2:
        raise InputError(f"rt.gait.start_stop(count) is {count!r}; give at least 2 steps.")
    groups, home = alternating(robot, options)
    # A foot lands half a step before the root's final displacement of the step.
    reached = [length * (k + 1) for k in range(count - 1)]
    reached.append(reached[-1])
    return steps(robot, [{f: _moved(home[f], reached[k], 0.0) for f in groups[k % 2]} for k in range(count)], **options)


def sidestep(robot: Robot, *, distance: float, count: int = 2, **options: Unpack[StepOptions]) -> Problem:
    """Return sidesteps from rest to rest: in each pair of steps, all feet move sideways by ``distance``.

    The leading feet, on the side of the motion, move first. Quadrupeds move the diagonal pairs of feet in turn.

    Parameters
    ----------
    robot : Robot
        With a floating root.
    distance : float
        Displacement along y in two steps [m]; negative to the right.
    count : int
        Number of steps, even.
    **options
        Of ``rt.gait.steps``.

    Raises
    ------
    InputError
        The number of steps is odd, the robot is planar, or it has neither two nor four feet. Further errors are those
        of ``steps``.
    """
    way = number(distance, "rt.gait.sidestep(distance)")
    _check_space(robot, count, "sidestep")
    groups, home = alternating(robot, options)
    if len(home) == 2 and (home[groups[0][0]][1] - home[groups[1][0]][1]) * way < 0:
        groups = groups[::-1]
    places = [{f: _moved(home[f], 0.0, way * (k // 2 + 1)) for f in groups[k % 2]} for k in range(count)]
    return steps(robot, places, **options)


def turn(robot: Robot, *, angle: float, count: int | None = None, **options: Unpack[StepOptions]) -> Problem:
    """Return a turn on the spot from rest to rest: in each pair of steps, all feet turn by an equal part of ``angle``.

    The foot of a biped on the side of the turn moves first, with its toe outwards.

    Parameters
    ----------
    robot : Robot
        With a floating root.
    angle : float
        Angle about the vertical axis [rad]; positive to the left.
    count : int, optional
        Number of steps, even; by default the least in which no flat foot turns into the other one.
    **options
        Of ``rt.gait.steps``.

    Raises
    ------
    InputError
        The number of steps is odd, or the angle is half a turn or more. Or the robot is planar, or has neither two nor
        four feet. Further errors are those of ``steps``.
    """
    whole = number(angle, "rt.gait.turn(angle)", "rad")
    if not abs(whole) < np.pi:
        raise InputError(
            f"rt.gait.turn(angle) is {whole:g} rad; give less than half a turn, and plan longer ones in parts."
            f"{doubt_of_unit(whole, -np.pi, np.pi, 'rad')}"
        )
    _check_space(robot, 2 if count is None else count, "turn")
    groups, home = alternating(robot, options)
    if len(home) == 2 and (home[groups[0][0]][1] - home[groups[1][0]][1]) * whole < 0:
        groups = groups[::-1]
    centre = np.mean([place[:2] for place in home.values()], axis=0)

    def turned(count: int) -> Problem:
        places = []
        for k in range(count):
            yaw = whole * (k // 2 + 1) / (count // 2)
            c, s = np.cos(yaw), np.sin(yaw)
            spots = {f: np.array([[c, -s], [s, c]]) @ (home[f][:2] - centre) + centre for f in groups[k % 2]}
            places.append({f: (float(p[0]), float(p[1]), yaw) for f, p in spots.items()})
        return steps(robot, places, **options)

    most = int(np.ceil(abs(whole) / LEAST_TURN)) or 1
    for pairs in range(1, most) if count is None else ():
        with suppress(FeetOverlap):
            return turned(2 * pairs)
    return turned(2 * most if count is None else count)


def alternating(robot: Robot, options: StepOptions) -> tuple[list[tuple[str, ...]], dict[str, Array]]:
    """Return the feet that swing in odd and even steps, and the positions (3,) of all in the standing configuration."""
    names = feet_of(robot, options.get("feet"))
    kind = on_ground(options.get("contact", PointContact), options.get("ground", LEVEL))
    contacts = {name: foot_contact(kind, name).bound_to(robot) for name in names}
    stance = BalancedStance(robot, tuple(contacts.values()))
    anchors = stance.locate(standing(stance))
    home = {n: np.array([anchors.get(f"{contacts[n].name}.{axis}", 0.0) for axis in "xy"]) for n in names}
    if len(names) == 2:
        return [(names[1],), (names[0],)], home
    if len(names) != 4:
        raise InputError(
            f"This motion needs two or four feet; {robot.name!r} has {', '.join(names)}. Name them with feet=."
        )
    # In a plane footholds have no y; the model has.
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.neutral)
    below = {n: np.array(data.oMf[robot.frame(n)].translation[:2]) for n in names}
    centre = np.mean(list(below.values()), axis=0)
    diagonal = tuple(n for n in names if np.prod(below[n] - centre) > 0)
    others = tuple(n for n in names if n not in diagonal)
    if len(diagonal) != 2:
        raise InputError(f"The feet {', '.join(names)} of {robot.name!r} are no two diagonal pairs; use rt.gait.steps.")
    return [diagonal, others], home


def _moved(place: Array, x: float, y: float) -> tuple[float, float]:
    return float(place[0] + x), float(place[1] + y)


def _check_space(robot: Robot, count: object, what: str) -> None:
    if robot.root != "floating":
        raise InputError(
            f"rt.gait.{what} moves sideways, but {robot.name!r} has a {robot.root} root; load it with root='floating'."
        )
    if not isinstance(count, int) or count < 2 or count % 2:
        raise InputError(f"rt.gait.{what}(count) is {count!r}; give an even number of steps.")
