"""Gaits written out as problems: walk, run and trot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.gait.checks import share
from robotraj.gait.feet import FootKind
from robotraj.gait.halves import pace, repeated, some_feet
from robotraj.gait.phase_sequence import GaitTerms, Support, shares
from robotraj.gait.sides import other_side
from robotraj.gait.upright import Upright
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.objectives.base import Objective
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot

LEVEL = Flat()
UPRIGHT = Upright()


def walk(
    robot: Robot,
    *,
    step_length: float | None = None,
    duration: Any = None,
    speed: float | None = None,
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    double_support: float = 0.0,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = UPRIGHT,
    ground: Ground | Any = LEVEL,
    repeat: Mirror | Periodic | None = None,
) -> Problem:
    """One step of a biped that repeats mirrored: the foot named first stands, the other swings and comes down.

    Without double support the step is one phase, "single support", closed by a ``Touchdown`` onto its own mirror image.
    With it the step begins with both feet on the ground, "double support", until the rear one lifts (``Liftoff``). With
    ``repeat=rt.Periodic(...)`` both steps of a stride are written, for robots that are not symmetric.

    What comes back is a ``Problem`` to plan with ``rt.plan``, which starts from ``rt.guess.InvertedPendulum``
    where no guess
    is given, or to edit: ``dataclasses.replace(problem, phases=[dataclasses.replace(problem.phases[0], ...)])``.

    Parameters
    ----------
    robot : Robot
        With ``root="planar"`` or ``"floating"``.
    step_length, duration, speed : float
        Two of: way of the root in one step [m], its time [s] (or (least, greatest) beside a step length), speed [m/s].
    feet : sequence of str, optional
        Two frames, the one that stands first first; by default those named foot, sole or toe.
    contact : Contact or callable
        ``rt.PointContact``; a contact to copy to the other foot; or a function from a frame to a contact, such as
        ``functools.partial(rt.FlatFoot, length=0.2, width=0.1)``.
    double_support : float
        Share of the step with both feet on the ground, 0 to less than 1.
    clearance : float or None
        Height [m] at which the swing foot passes the standing one, ``rt.constraints.SwingApex``; 0 asks it to
        stay above the
        ground, None for nothing at all, as for walkers without knees.
    objective : Objective, optional
        Of every phase. ``rt.Effort()`` by default; in space with the distance of the joints from how the robot stands,
        ``rt.gait.gait_objective``.
    upright : Upright or None
        Bounds on height and attitude of the root; None for none.
    ground : Ground or callable
        For clearance, and for contacts of the kinds that ``contact`` names without a ground of their own.
    repeat : Mirror or Periodic, optional
        ``rt.gait.mirror(robot)`` by default. The displacement along x is added to it, and along z that of the ground:
        a gait repeats on level ground and on slopes.

    Raises
    ------
    InputError
        Not two feet; none or too much said of length, time and speed; a robot that is not its own mirror image.
    """
    names = some_feet(robot, feet, 2, "walk")
    length, time = pace(step_length, duration, speed, "walk")
    share(double_support, "rt.gait.walk(double_support)")
    first, second = names
    parts = [double_support, 1.0 - double_support] if double_support > 0.0 else [1.0]
    spans = shares(time, parts)
    phases = [Support((first,), spans[-1], "single support")]
    if double_support > 0.0:
        phases.insert(0, Support((first, second), spans[0], "double support"))
    terms = GaitTerms(contact, clearance, objective, upright, ground)
    return repeated(robot, phases, parts, {first: second, second: first}, terms, repeat, length)


def run(
    robot: Robot,
    *,
    step_length: float | None = None,
    duration: Any = None,
    speed: float | None = None,
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    flight: float = 0.3,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = UPRIGHT,
    ground: Ground | Any = LEVEL,
    repeat: Mirror | Periodic | None = None,
) -> Problem:
    """One step of a running biped: "stance" on one foot, ``Liftoff``, "flight", ``Touchdown`` of the other, mirrored.

    Parameters are those of ``walk``, and

    Parameters
    ----------
    flight : float
        Share of the step in the air, more than 0 and less than 1.

    Raises
    ------
    InputError
        As ``walk``.
    """
    names = some_feet(robot, feet, 2, "run")
    length, time = pace(step_length, duration, speed, "run")
    if share(flight, "rt.gait.run(flight)") == 0.0:
        raise InputError("rt.gait.run(flight) is 0; a run has flight, without it rt.gait.walk is meant.")
    parts = [1.0 - flight, flight]
    stance, air = shares(time, parts)
    phases = [Support((names[0],), stance, "stance"), Support((), air, "flight")]
    terms = GaitTerms(contact, clearance, objective, upright, ground)
    return repeated(robot, phases, parts, {names[0]: names[1], names[1]: names[0]}, terms, repeat, length)


def trot(
    robot: Robot,
    *,
    step_length: float | None = None,
    duration: Any = None,
    speed: float | None = None,
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    flight: float = 0.0,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = UPRIGHT,
    ground: Ground | Any = LEVEL,
    repeat: Mirror | Periodic | None = None,
) -> Problem:
    """Half a stride of a trotting quadruped: one diagonal pair stands, the other swings and comes down, mirrored.

    The phase is named after the standing feet; with ``flight`` above 0 all feet leave the ground before the others come
    down. Parameters are those of ``walk``, but ``double_support``, and

    Parameters
    ----------
    feet : sequence of str, optional
        Four frames; those that stand first are the first one and the one diagonal to it.
    flight : float
        Share of the half stride in the air, 0 to less than 1.

    Raises
    ------
    InputError
        Not four feet, two on each side; else as ``walk``.
    """
    names = some_feet(robot, feet, 4, "trot")
    length, time = pace(step_length, duration, speed, "trot")
    sides = {name: other_side(name, names) for name in names}
    diagonal = next((n for n in names if n not in (names[0], sides[names[0]]) and _left(robot, n, names[0])), None)
    if diagonal is None or any(sides[name] == name for name in names):
        raise InputError(f"rt.gait.trot needs two feet on each side; got {', '.join(names)}.")
    pair = (names[0], diagonal)
    title = f"{pair[0]} and {pair[1]} stand"
    parts = [1.0 - flight, flight] if share(flight, "rt.gait.trot(flight)") > 0.0 else [1.0]
    stance, *air = shares(time, parts)
    phases = [Support(pair, stance, title), *(Support((), span, "flight") for span in air)]
    return repeated(
        robot, phases, parts, sides, GaitTerms(contact, clearance, objective, upright, ground), repeat, length
    )


def _left(robot: Robot, foot: str, other: str) -> bool:
    """Whether two feet are on different sides and at different ends of the robot."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.neutral)
    a, b = (data.oMf[robot.frame(name)].translation for name in (foot, other))
    return bool(a[1] * b[1] < 0.0 and a[0] * b[0] < 0.0)
