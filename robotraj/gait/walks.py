"""Walk, run and trot as problems."""

from __future__ import annotations

from collections.abc import Sequence

import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction
from robotraj.gait.bounds.margins import MARGIN
from robotraj.gait.bounds.own_sides import OwnSides
from robotraj.gait.bounds.upright import Upright
from robotraj.gait.checks import TimeSpan, fraction, step_timing
from robotraj.gait.feet import FootKind, feet_of
from robotraj.gait.mirroring.foot_groups import foot_groups, halves
from robotraj.gait.phase_sequence import split_duration
from robotraj.gait.repetition import checked_feet, repeating, whole_stride
from robotraj.gait.supports import GaitTerms, Support
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.objectives.base import Objective
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.robot.sides.images import frames_across

LEVEL = Flat()
OWN_SIDES = OwnSides()
UPRIGHT = Upright()


def walk(
    robot: Robot,
    *,
    step_length: float | None = None,
    duration: TimeSpan | None = None,
    speed: float | None = None,
    feet: Sequence[str] | None = None,
    groups: Sequence[Sequence[str]] | None = None,
    contact: FootKind = PointContact,
    double_support: float = 0.0,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = UPRIGHT,
    ground: Ground | GroundFunction = LEVEL,
    sides: OwnSides | None = OWN_SIDES,
    margin: float = MARGIN,
    repeat: Mirror | Periodic | None = None,
) -> Problem:
    """Return steps of a walk that repeats: the feet of each group swing together and land while all others stand.

    A biped plans one step: the first foot stands and the other one swings. The step is one phase, "single support",
    closed by a ``Touchdown`` onto its mirror image. Robots with six feet or more walk with alternate feet, such as the
    two tripods of a hexapod. The second half of the groups is planned as the mirror image of the first half where it
    is one. With ``repeat=rt.Periodic(...)``, and for robots whose inertia or limits are not symmetric, all groups of a
    stride are planned.

    With double support, each step begins with a phase in which all feet stand, which ends with the ``Liftoff`` of the
    next group.

    ``rt.plan`` starts from ``rt.guess.InvertedPendulum`` by default. The problem can be edited:
    ``dataclasses.replace(problem, phases=[dataclasses.replace(problem.phases[0], ...)])``.

    Parameters
    ----------
    robot : Robot
        With ``root="planar"`` or ``"floating"``.
    step_length, duration, speed : float
        Two of: displacement of the root in one step [m], in which one group swings, its duration [s] (or (least,
        greatest) beside a step length), speed [m/s].
    feet : sequence of str, optional
        The frames of the feet, one that stands first in front; by default those named foot, sole or toe.
    groups : sequence of sequences of str, optional
        Feet that swing together, in the order in which the groups swing. By default each foot of a biped, and alternate
        feet of both sides of robots with six feet or more.
    contact : Contact or callable
        Contact of every foot: ``rt.PointContact``, a contact to copy to the other foot, or a function of the frame,
        such as ``functools.partial(rt.FlatFoot, length=0.2, width=0.1)``.
    double_support : float
        Fraction of the step with all feet on the ground, 0 to less than 1.
    clearance : float or None
        Height [m] at which the swing foot passes the standing one. 0 keeps it above the ground. None adds no row, which
        walkers without knees need.
    objective : Objective, optional
        Objective of every phase; ``rt.gait.gait_objective`` by default.
    upright : Upright or None
        Bounds on height and attitude of the root; None for none.
    ground : Ground or callable
        Ground for the clearance, and for contacts on the default level ground.
    sides : OwnSides or None
        The feet of a floating robot keep to their own sides; None lets its legs cross.
    margin : float
        Share of friction cones, soles, torques and speeds that the plan keeps back for a controller, 0 to less than 1.
    repeat : Mirror or Periodic, optional
        ``rt.gait.mirror(robot)`` by default. The displacement along x and the rise of the ground are added to it.

    Raises
    ------
    InputError
        The robot has another number of feet and no groups are given, or a group names other feet. The ground does not
        repeat. Not exactly two of length, duration and speed are given.
    """
    names = feet_of(robot, feet)
    order = foot_groups(robot, names, groups) if groups is not None or len(names) != 4 else ()
    if not order:
        names = checked_feet(robot, feet, 2, "walk")
    length, time = step_timing(step_length, duration, speed, "walk")
    fraction(double_support, "rt.gait.walk(double_support)")
    across = frames_across(robot, names)
    if len(names) == 2:
        across = {names[0]: names[1], names[1]: names[0]}
    mirrored = halves(order, across)
    parts = [double_support, 1.0 - double_support] if double_support > 0.0 else [1.0]
    *together, alone = split_duration(time, parts)
    phases: list[Support] = []
    planned = order[: len(order) // 2] if mirrored else order
    for group in planned:
        title = "single support" if len(names) == 2 else f"{' and '.join(group)} swing"
        full = "double support" if len(names) == 2 else f"all stand before {group[0]} swings"
        phases += [Support(names, span, full) for span in together]
        phases.append(Support(tuple(name for name in names if name not in group), alone, title))
    terms = GaitTerms(contact, clearance, objective, upright, ground, sides, margin)
    shares, far = parts * len(planned), length * len(planned)
    if mirrored:
        return repeating(robot, phases, shares, across, terms, repeat, far, len(planned))
    return whole_stride(robot, phases, shares, terms, repeat, far, len(planned))


def run(
    robot: Robot,
    *,
    step_length: float | None = None,
    duration: TimeSpan | None = None,
    speed: float | None = None,
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    flight: float = 0.3,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = UPRIGHT,
    ground: Ground | GroundFunction = LEVEL,
    sides: OwnSides | None = OWN_SIDES,
    margin: float = MARGIN,
    repeat: Mirror | Periodic | None = None,
) -> Problem:
    """Return one step of a running biped: "stance" on one foot, ``Liftoff``, "flight", ``Touchdown`` of the other.

    The other parameters are those of ``walk``.

    Parameters
    ----------
    flight : float
        Fraction of the step in the air, more than 0 and less than 1.

    Raises
    ------
    InputError
        The flight is 0; further errors are those of ``walk``.
    """
    names = checked_feet(robot, feet, 2, "run")
    length, time = step_timing(step_length, duration, speed, "run")
    if fraction(flight, "rt.gait.run(flight)") == 0.0:
        raise InputError("rt.gait.run(flight) is 0; give a positive fraction, or use rt.gait.walk.")
    parts = [1.0 - flight, flight]
    stance, air = split_duration(time, parts)
    phases = [Support((names[0],), stance, "stance"), Support((), air, "flight")]
    terms = GaitTerms(contact, clearance, objective, upright, ground, sides, margin)
    return repeating(robot, phases, parts, {names[0]: names[1], names[1]: names[0]}, terms, repeat, length)


def trot(
    robot: Robot,
    *,
    step_length: float | None = None,
    duration: TimeSpan | None = None,
    speed: float | None = None,
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    flight: float = 0.0,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = UPRIGHT,
    ground: Ground | GroundFunction = LEVEL,
    sides: OwnSides | None = OWN_SIDES,
    margin: float = MARGIN,
    repeat: Mirror | Periodic | None = None,
) -> Problem:
    """Return half a stride of a trotting quadruped: one diagonal pair stands, the other one swings and lands.

    The other half is its mirror image. The phase is named after the standing feet. With ``flight`` above 0, all feet
    leave the ground before the others land. The other parameters are those of ``walk`` without ``double_support``.

    Parameters
    ----------
    feet : sequence of str, optional
        Four frames; the first one and the one diagonal to it stand first.
    flight : float
        Fraction of the half stride in the air, 0 to less than 1.

    Raises
    ------
    InputError
        There are not two feet on each side; further errors are those of ``walk``.
    """
    names = checked_feet(robot, feet, 4, "trot")
    length, time = step_timing(step_length, duration, speed, "trot")
    others = frames_across(robot, names)
    diagonal = next(
        (n for n in names if n not in (names[0], others[names[0]]) and _are_diagonal(robot, n, names[0])), None
    )
    if diagonal is None or any(others[name] == name for name in names):
        raise InputError(f"rt.gait.trot needs two feet on each side; got {', '.join(names)}.")
    pair = (names[0], diagonal)
    title = f"{pair[0]} and {pair[1]} stand"
    parts = [1.0 - flight, flight] if fraction(flight, "rt.gait.trot(flight)") > 0.0 else [1.0]
    stance, *air = split_duration(time, parts)
    phases = [Support(pair, stance, title), *(Support((), span, "flight") for span in air)]
    return repeating(
        robot,
        phases,
        parts,
        others,
        GaitTerms(contact, clearance, objective, upright, ground, sides, margin),
        repeat,
        length,
    )


def _are_diagonal(robot: Robot, foot: str, other: str) -> bool:
    """Return whether two feet are diagonal: on different sides and at different ends of the robot."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.neutral)
    a, b = (data.oMf[robot.frame(name)].translation for name in (foot, other))
    return bool(a[1] * b[1] < 0.0 and a[0] * b[0] < 0.0)
