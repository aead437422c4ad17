"""Gaits written out as problems: walk, run, trot and jump."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

from robotraj.contacts import PointContact
from robotraj.errors import InputError
from robotraj.gait.feet import FootKind, feet_of, stands
from robotraj.gait.mirror import mirror
from robotraj.gait.sequence import Support, Terms, sequence, shares
from robotraj.gait.sides import other_side
from robotraj.gait.upright import Upright
from robotraj.guesses.stance import Stance, standing
from robotraj.links import Mirror, Periodic
from robotraj.objectives import Objective
from robotraj.problem import Problem
from robotraj.robot import Robot
from robotraj.state import State
from robotraj.terrain import Flat, Ground

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
    ground: Ground | Any = Flat(),
    repeat: Mirror | Periodic | None = None,
) -> Problem:
    """One step of a biped that repeats mirrored: the foot named first stands, the other swings and comes down.

    Without double support the step is one phase, "single support", closed by a ``Touchdown`` onto its own mirror image.
    With it the step begins with both feet on the ground, "double support", until the rear one lifts (``Liftoff``). With
    ``repeat=rt.Periodic(...)`` both steps of a stride are written, for robots that are not symmetric.

    What comes back is a ``Problem`` to plan with ``rt.plan``, which starts from ``rt.InvertedPendulum`` where no guess
    is given, or to edit: ``dataclasses.replace(problem, phases=[dataclasses.replace(problem.phases[0], ...)])``.

    Parameters
    ----------
    robot : Robot
        With ``root="planar"`` or ``"floating"``.
    step_length, duration, speed : float
        Two of: way of the root in one step [m], its time [s] (or (least, greatest) with a step length), and speed [m/s].
    feet : sequence of str, optional
        Two frames, the one that stands first first; by default those named foot, sole or toe.
    contact : Contact or callable
        ``rt.PointContact``; a contact to copy to the other foot; or a function from a frame to a contact, such as
        ``functools.partial(rt.FlatFoot, length=0.2, width=0.1)``.
    double_support : float
        Share of the step with both feet on the ground, 0 to less than 1.
    clearance : float or None
        Height [m] at which the swing foot passes the standing one, ``rt.SwingApex``; 0 asks it to stay above the
        ground, None for nothing at all, as for walkers without knees.
    objective : Objective, optional
        ``rt.Effort()`` by default.
    upright : Upright or None
        Bounds on height and attitude of the root; None for none.
    ground : Ground or callable
        For clearance, and for contacts of the kinds that ``contact`` names without a ground of their own.
    repeat : Mirror or Periodic, optional
        ``rt.gait.mirror(robot)`` by default. The displacement along x is added to it.

    Raises
    ------
    InputError
        Not two feet; none or too much said of length, time and speed; a robot that is not its own mirror image.
    """
    names = _some_feet(robot, feet, 2, "walk")
    length, time = _pace(step_length, duration, speed, "walk")
    if not 0.0 <= double_support < 1.0:
        raise InputError(f"double_support= is {double_support!r}; give the share of a step from 0 to less than 1.")
    first, second = names
    parts = [double_support, 1.0 - double_support] if double_support > 0.0 else [1.0]
    spans = shares(time, parts)
    phases = [Support((first,), spans[-1], "single support")]
    if double_support > 0.0:
        phases.insert(0, Support((first, second), spans[0], "double support"))
    terms = Terms(contact, clearance, objective, upright, ground)
    return _repeated(robot, phases, {first: second, second: first}, terms, repeat, length)


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
    ground: Ground | Any = Flat(),
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
    names = _some_feet(robot, feet, 2, "run")
    length, time = _pace(step_length, duration, speed, "run")
    stance, air = shares(time, [1.0 - _share(flight), flight])
    phases = [Support((names[0],), stance, "stance"), Support((), air, "flight")]
    terms = Terms(contact, clearance, objective, upright, ground)
    return _repeated(robot, phases, {names[0]: names[1], names[1]: names[0]}, terms, repeat, length)


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
    ground: Ground | Any = Flat(),
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
    names = _some_feet(robot, feet, 4, "trot")
    length, time = _pace(step_length, duration, speed, "trot")
    sides = {name: other_side(name, names) for name in names}
    diagonal = next((n for n in names if n not in (names[0], sides[names[0]]) and _left(robot, n, names[0])), None)
    if diagonal is None or any(sides[name] == name for name in names):
        raise InputError(f"rt.gait.trot needs two feet on each side; got {', '.join(names)}.")
    pair = (names[0], diagonal)
    title = f"{pair[0]} and {pair[1]} stand"
    if flight > 0.0:
        stance, air = shares(time, [1.0 - _share(flight), flight])
        phases = [Support(pair, stance, title), Support((), air, "flight")]
    else:
        phases = [Support(pair, time, title)]
    return _repeated(robot, phases, sides, Terms(contact, clearance, objective, upright, ground), repeat, length)


def jump(
    robot: Robot,
    *,
    length: float = 0.0,
    height: float = 0.1,
    push: Any = (0.15, 0.6),
    land: Any = (0.15, 0.6),
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = UPRIGHT,
    ground: Ground | Any = Flat(),
) -> Problem:
    """A jump from standing still to standing still: "push off" on all feet, "flight", "landing" on all feet.

    The flight takes sqrt(8 height / g), in which the centre of mass rises by ``height`` where it lands as high as it
    took off. The robot starts as ``rt.gait.stand`` has it and ends so, ``length`` farther on.

    Parameters
    ----------
    robot : Robot
    length, height : float
        How far and how high the centre of mass goes [m].
    push, land : float or (float, float)
        Duration of both stances [s].
    feet, contact, clearance, objective, upright, ground
        As for ``walk``; all feet stand.

    Raises
    ------
    InputError
        A height that is not positive, or no feet.
    """
    names = feet_of(robot, feet)
    if not (np.isfinite(height) and height > 0.0):
        raise InputError(f"rt.gait.jump: height= is {height!r}; give a positive height [m].")
    gravity = float(np.linalg.norm(robot.model.gravity.linear))
    kind = _grounded(contact, ground)
    q = standing(Stance(robot, tuple(stands(kind, name).bind(robot) for name in names)))
    landed = np.array(q)
    landed[0] += length
    data = robot.model.createData()
    rise = _level(robot, data, names, landed, ground) - _level(robot, data, names, q, ground)
    landed[1 if robot.root == "planar" else 2] += rise
    air = float(np.sqrt(8.0 * height / gravity))
    phases = [Support(names, push, "push off"), Support((), air, "flight"), Support(names, land, "landing")]
    terms = Terms(kind, clearance, objective, upright, ground)
    return sequence(robot, phases, terms, None, State(q=q, v=0.0), State(q=landed, v=0.0))


def _repeated(
    robot: Robot,
    phases: Sequence[Support],
    sides: Mapping[str, str],
    terms: Terms,
    repeat: Mirror | Periodic | None,
    length: float,
) -> Problem:
    """Close a gait on its mirror image, or write its other half and close it as it is."""
    terms = replace(terms, contact=_grounded(terms.contact, terms.ground))
    if isinstance(repeat, Periodic):
        other = [Support(tuple(sides[f] for f in p.feet), p.duration, f"{p.name}, other side") for p in phases]
        return sequence(robot, [*phases, *other], terms, _moved(repeat, 2.0 * length))
    if repeat is None:
        repeat = mirror(robot)
    both = {**repeat.partners, **{b: a for a, b in repeat.partners.items()}}
    for foot in sides:
        if both.get(foot, foot) != sides[foot]:
            raise InputError(
                f"The mirror image of foot {foot!r} is {both.get(foot, foot)!r}, not {sides[foot]!r}; name the pair in "
                "rt.gait.mirror(robot, partners=...)."
            )
    return sequence(robot, phases, terms, _moved(repeat, length))


def _moved(repeat: Any, length: float) -> Any:
    """Add the way along x to what a repetition gains."""
    return replace(repeat, displacement={"q.root_x": length, **repeat.displacement})


def _grounded(kind: FootKind, ground: Any) -> FootKind:
    """Contacts on a ground, where the kind of contact is named without one."""

    def on(frame: str) -> Any:
        contact = stands(kind, frame)
        return replace(contact, ground=ground) if getattr(contact, "ground", None) == Flat() else contact  # type: ignore[call-arg]

    return on


def _some_feet(robot: Robot, feet: Sequence[str] | None, count: int, who: str) -> tuple[str, ...]:
    names = feet_of(robot, feet)
    if len(names) != count:
        raise InputError(f"rt.gait.{who} needs {count} feet; got {', '.join(names)}. Name them with feet=[...].")
    return names


def _pace(length: float | None, duration: Any, speed: float | None, who: str) -> tuple[float, Any]:
    """Step length [m] and duration [s] out of two of three."""
    if sum(value is not None for value in (length, duration, speed)) != 2:
        raise InputError(f"rt.gait.{who} takes two of step_length=, duration= and speed=.")
    if speed is None:
        return float(length), duration  # type: ignore[arg-type]
    if length is None:
        if np.ndim(duration):
            raise InputError(
                f"rt.gait.{who}: with speed= the duration is one number, or give step_length= and duration=."
            )
        return float(speed) * float(duration), duration
    if not speed > 0.0:
        raise InputError(f"rt.gait.{who}: speed= is {speed!r} beside a step length; give a positive speed [m/s].")
    return float(length), float(length) / float(speed)


def _share(flight: float) -> float:
    if not 0.0 < flight < 1.0:
        raise InputError(f"flight= is {flight!r}; give the share of the step in the air, between 0 and 1.")
    return flight


def _left(robot: Robot, foot: str, other: str) -> bool:
    """Whether two feet are on different sides and at different ends of the robot."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.neutral)
    a, b = (data.oMf[robot.frame(name)].translation for name in (foot, other))
    return bool(a[1] * b[1] < 0.0 and a[0] * b[0] < 0.0)


def _level(robot: Robot, data: Any, feet: Sequence[str], q: Any, ground: Any) -> float:
    """Mean height of the ground under the feet [m]."""
    from robotraj.terrain import as_ground

    pin.framesForwardKinematics(robot.model, data, q)
    places = [data.oMf[robot.frame(name)].translation for name in feet]
    return float(np.mean([as_ground(ground).height(float(p[0]), float(p[1])) for p in places]))
