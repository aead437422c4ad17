"""Check that contacts hold where the ends of a phase are fixed, and that a robot without contacts falls between them.

Without contacts gravity is the only outer force on a robot whose root moves. Its centre of mass gains the speed
v_1 - v_0 = g T within the duration T, whatever the motors do.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, warn
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.loop_closure import BoundLoopClosure
from robotraj.dynamics.kinematics import KinematicBody
from robotraj.problem.constraints.base import Where, symbols_of
from robotraj.problem.constraints.bounds import Bounds
from robotraj.problem.feasibility import SLACK, Ends
from robotraj.problem.rows import RowTable
from robotraj.robot.loading.other_units import in_other_unit, seems_other
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION
from robotraj.robot.size.reach import reach

STANDING = 3
"""Number of held frames from which on half a turn of the root is refused."""
FALL = 1e-2
"""Difference of speeds [m/s] above which ends contradict a free fall."""


def check_contacts(
    table: RowTable,
    robot: Robot,
    contacts: Sequence[BoundContact],
    parameters: Bounds,
    ends: Ends,
    durations: tuple[float, float],
) -> None:
    """Refuse a fixed end at which a contact does not hold, and fixed ends that no free fall joins without contacts.

    A foothold whose parameters are not fixed is taken from the first end that fixes the configuration.

    Parameters
    ----------
    table : RowTable
    robot : Robot
    contacts : sequence of BoundContact
    parameters : Bounds
        Bounds of ``table.parameters``.
    ends : mapping of Where to Bounds
    durations : (float, float)
        Least and greatest duration [s].

    Raises
    ------
    InputError
        A contact does not hold at an end, or the root must turn by more than half a turn while several feet are held.
        The message names the contact, the row with its value, and the end. Without contacts, gravity gives the robot
        another speed than the ends have.

    Warns
    -----
    UserWarning
        A sole, an arc or an offset of a contact is plausible in millimetres only.
    """
    _warn_of_sizes(table.phase, robot, contacts)
    if not contacts and not isinstance(table.body, KinematicBody):
        _check_fall(table.phase, robot, durations, ends)
    if not any(contact.holds for contact in contacts):
        return
    _check_turn(table.phase, robot, contacts, ends)
    names, body = table.parameters, table.body
    size, stands = robot.nq, dict(zip(names, parameters.lower, strict=True))
    known = [name for name, low, up in zip(names, *parameters, strict=True) if low == up]
    rows = body.invariants
    located = False
    for end, bounds in ends.items():
        fixed = (bounds.lower == bounds.upper)[: len(body.states)]
        if not fixed[:size].all():
            continue
        state = np.where(fixed, bounds.lower[: fixed.size], 0.0)
        _check_loops(table.phase, robot, contacts, end, state[:size])
        if not located:
            found = {k: v for c in contacts for k, v in c.locate(robot, state[:size]).items()}
            stands, located = {**stands, **{k: v for k, v in found.items() if k not in known}}, True
        point = symbols_of(body, names)
        x, p = (ca.vertcat(ca.SX(0, 1), *named.values()) for named in (point.x, point.p))
        held = body.invariant(point)
        moving = np.array(ca.DM(ca.jacobian_sparsity(held, x), 1.0).full(), dtype=bool) @ ~fixed
        values = np.array(ca.Function("held", [x, p], [held])(state, [stands[name] for name in names])).ravel()
        worst = int(np.argmax(np.where(moving, 0.0, np.abs(values))))
        if not moving[worst] and abs(values[worst]) > SLACK:
            loops = {contact.name for contact in contacts if isinstance(contact, BoundLoopClosure)}
            hint = " rt.contacts.LoopClosure.closed_at closes a loop as it is." if rows[worst].label in loops else ""
            if robot.root == "fixed":
                hint += f" The root of {robot.name!r} is fixed; one that stands is loaded with root='floating'."
            raise InputError(
                f"Phase {table.phase!r}: at the {end.value}, contact {rows[worst].label!r} does not hold: its row "
                f"{rows[worst].name} is {values[worst]:.3g} {rows[worst].unit} instead of 0. Move the {end.value}, "
                f"free some of it, or end the contact before.{hint}"
            )


def _check_loops(phase: str, robot: Robot, contacts: Sequence[BoundContact], end: Where, q: Array) -> None:
    """Refuse a rigid loop whose frames are about half a turn apart, where its rows are zero too."""
    for contact in contacts:
        if isinstance(contact, BoundLoopClosure) and contact.is_turned_over(robot, q):
            raise InputError(
                f"Phase {phase!r}: at the {end.value}, the axes of {contact.first.frame!r} and "
                f"{contact.second.frame!r} are turned over, but the loop {contact.name!r} holds them to each other. "
                "Give rotation_b=, or close the loop as it is there with rt.contacts.LoopClosure.closed_at."
            )


def _check_turn(phase: str, robot: Robot, contacts: Sequence[BoundContact], ends: Ends) -> None:
    """Refuse ends more than half a turn apart while feet are held, since a motion would pass through the half turn."""
    frames = {contact.frame for contact in contacts if contact.holds}
    if robot.root != "floating" or len(frames) < STANDING:
        return
    start, end = (ends[where].lower[QUATERNION] for where in (Where.START, Where.END))
    fixed = all(np.array_equal(ends[where].upper[QUATERNION], ends[where].lower[QUATERNION]) for where in ends)
    if fixed and float(start @ end) < 0.0:
        raise InputError(
            f"Phase {phase!r}: the end quaternion of the root is more than half a turn away from the start's, and "
            f"{len(frames)} feet are held. A quaternion and its negative are one attitude, a full turn apart. Negate "
            "the end quaternion to select the nearer one, or turn the robot in a phase without these contacts."
        )


def _warn_of_sizes(phase: str, robot: Robot, contacts: Sequence[BoundContact]) -> None:
    """Warn of the first contact that touches farther from its frame than the robot reaches."""
    span = reach(robot.model) if contacts else 0.0
    for contact in contacts:
        away = max((max(*np.abs(spot.offset), spot.radius) for spot in contact.outline()), default=0.0)
        if seems_other(away, span, "m"):
            warn(
                f"Phase {phase!r}: the contact {contact.name!r} touches the ground {away:.4g} m from its frame, and "
                f"{robot.name!r} reaches {span:.2g} m. {in_other_unit(away, 'm')}"
            )
            return


def _check_fall(phase: str, robot: Robot, durations: tuple[float, float], ends: Ends) -> None:
    """Refuse ends whose centres of mass have other speeds than a free fall of an allowed duration gives."""
    if robot.root == "fixed":
        return
    first, last = (_speed(robot, ends[where]) for where in (Where.START, Where.END))
    if first is None or last is None:
        return
    gained = last - first
    gravity = np.array(robot.model.gravity.linear)
    squared = float(gravity @ gravity)
    nearest = float(np.clip(float(gained @ gravity) / squared if squared else 0.0, *durations))
    fallen = gravity * nearest
    if float(np.linalg.norm(gained - fallen)) <= FALL:
        return
    falls, stated = (f"({', '.join(f'{entry + 0.0:.3g}' for entry in each.round(6))})" for each in (fallen, gained))
    raise InputError(
        f"Phase {phase!r}: no contact holds {robot.name!r}, so its centre of mass gains the speed {falls} m/s within "
        f"{nearest:.3g} s, but the ends give it {stated} m/s. Give contacts=[rt.PointContact(frame), ...] if it "
        "stands, else free the speed at an end."
    )


def _speed(robot: Robot, end: Bounds) -> NDArray[np.float64] | None:
    """Return the velocity of the centre of mass [m/s] in the world, None where the end leaves it free.

    At rest it is 0 whatever the posture.
    """
    q, v = slice(robot.nq), slice(robot.nq, robot.nq + robot.nv)
    if not np.array_equal(end.lower[v], end.upper[v]):
        return None
    if not np.any(end.lower[v]):
        return np.zeros(3)
    if not np.array_equal(end.lower[q], end.upper[q]):
        return None
    data = robot.model.createData()
    pin.centerOfMass(robot.model, data, end.lower[q], end.lower[v])
    return np.array(data.vcom[0])
