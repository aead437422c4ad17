"""Repeating gaits: length and duration of a step, and the link from its end to its start."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, warn
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import Contact, copied, has_field
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction, as_ground
from robotraj.dynamics.variable import Scalar
from robotraj.gait.bounds.margins import checked_margin
from robotraj.gait.capability.leg_reach import check_step, leg_length
from robotraj.gait.capability.leg_samples import greatest_friction
from robotraj.gait.capability.leg_speed import MODEST_STEP, check_speed, standing_shares
from robotraj.gait.capability.swing_time import check_swing_time
from robotraj.gait.capability.weight import check_weight
from robotraj.gait.checks import check_free_root, check_ground_repeats, check_options
from robotraj.gait.feet import FootKind, feet_of, foot_contact
from robotraj.gait.mirroring.common_limits import joint_without_common_limits
from robotraj.gait.mirroring.heading import check_heading, check_up, leg_pairs
from robotraj.gait.mirroring.imbalance import IMBALANCE, imbalance
from robotraj.gait.mirroring.mirror import mirror_by_geometry
from robotraj.gait.phase_sequence import sequence
from robotraj.gait.supports import GaitTerms, Support
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import standing
from robotraj.problem.links.base import Ends
from robotraj.problem.links.linkage import Linkage
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.links.touchdown import Touchdown
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot


def repeating(
    robot: Robot,
    phases: Sequence[Support],
    parts: Sequence[float],
    sides: Mapping[str, str],
    terms: GaitTerms,
    repeat: Mirror | Periodic | None,
    length: float,
    steps: int = 1,
) -> Problem:
    """Return a gait that repeats: half of it, closed by its mirror image, or both halves, closed by ``Periodic``.

    Parameters
    ----------
    robot : Robot
    phases : sequence of Support
        Phases of one half.
    parts : sequence of float
        Fractions of the phases in the duration of the half.
    sides : mapping of str to str
        Foot on the other side of each foot.
    terms : GaitTerms
    repeat : Mirror, Periodic or None
        None chooses ``Mirror``, or ``Periodic`` if the shape, the inertia or the limits are not symmetric.
    length : float
        Displacement along x in one half [m].
    steps : int
        Number of ``step_length=`` in it, for messages.

    Raises
    ------
    InputError
        The mirror pairs other feet than ``sides``, the ground does not repeat, or the step is longer than the legs
        reach.
    """
    check_options(repeat, terms.upright)
    terms = replace(terms, contact=on_ground(terms.contact, terms.ground))
    stands = _standing(robot, terms, sides)
    check_step(robot, phases, length, steps, terms, stands[1])
    if repeat is None:
        repeat = _symmetric_repeat(robot, sides)
    if isinstance(repeat, Periodic):
        other = [Support(tuple(sides[f] for f in p.feet), p.duration, f"{p.name}, other side", p.kinds) for p in phases]
        moved = _moved(robot, sides, repeat, 2.0 * length, terms.ground)
        problem = sequence(robot, [*phases, *other], terms, moved, passes=sides)
        _check_legs(robot, problem, phases, parts, sides, terms, length, steps, stands)
        return _in_shares(problem, [*parts, *parts])
    both = repeat.partner_of
    for foot in sides:
        if both.get(foot, foot) != sides[foot]:
            raise InputError(
                f"The mirror image of foot {foot!r} is {both.get(foot, foot)!r}, not {sides[foot]!r}; name the pair in "
                "rt.gait.mirror(robot, partners=...)."
            )
    problem = sequence(robot, phases, terms, _moved(robot, sides, repeat, length, terms.ground))
    _check_legs(robot, problem, phases, parts, sides, terms, length, steps, stands)
    return _in_shares(problem, parts)


def _standing(robot: Robot, terms: GaitTerms, feet: Iterable[str]) -> tuple[BalancedStance, Array]:
    """Return the inverse kinematics of all feet, and the standing configuration (nq,)."""
    check_free_root(robot)
    stance = BalancedStance(robot, tuple(foot_contact(terms.contact, foot).bound_to(robot) for foot in feet))
    return stance, standing(stance)


def _check_legs(
    robot: Robot,
    problem: Problem,
    phases: Sequence[Support],
    parts: Sequence[float],
    sides: Mapping[str, str],
    terms: GaitTerms,
    length: float,
    steps: int,
    stands: tuple[BalancedStance, Array],
    whole: bool = False,
) -> None:
    """Refuse a gait whose phases in one half are too fast for the legs, or in which they cannot carry the robot.

    The phases, the length and the steps are those of a ``whole`` stride where no half is mirrored.
    """
    (stance, posture), margin = stands, checked_margin(terms.margin)
    spans = [phase.duration_bounds for phase in problem.phases[: len(phases)]]
    half, time = 0.5 if whole else 1.0, sum(longest for _, longest in spans)
    friction, feet = greatest_friction(stance), sorted(sides)
    check_speed(robot, phases, parts, sides, half * length, half * time, posture, friction, margin, half * steps)
    check_weight(robot, phases, spans, feet, posture, friction, margin)
    impact = any(isinstance(link, Touchdown) for link in problem.links)
    for foot, share in standing_shares(phases, parts, sides).items():
        way, air = 2.0 * half * abs(length), 2.0 * half * time * (1.0 - share)

        modest = min(MODEST_STEP * leg_length(robot, foot) * steps / max(abs(length), 1e-9), 1.0)

        def remedy(enough: float, air: float = air, modest: float = modest) -> str:
            # At the same acceleration a part of the way takes the square root of that part of the time.
            longer = float(np.sqrt(modest)) * enough / air
            return f"step_length={modest * length / steps:.2g} with duration={time / steps * longer:.2g}"

        if air > 0.0:
            check_swing_time(robot, posture, {foot: way}, air, margin, remedy, impact)


def whole_stride(
    robot: Robot,
    phases: Sequence[Support],
    parts: Sequence[float],
    terms: GaitTerms,
    repeat: Mirror | Periodic | None,
    length: float,
    steps: int,
) -> Problem:
    """Return a gait of a whole stride without a mirrored half, closed by ``Periodic``.

    Parameters are those of ``repeating``; ``phases``, ``length`` and ``steps`` are those of the stride.

    Raises
    ------
    InputError
        ``repeat`` is a mirror, the ground does not repeat, or the legs are too short, slow or weak for the gait.
    """
    check_options(repeat, terms.upright)
    if isinstance(repeat, Mirror):
        raise InputError(
            "repeat= is a mirror, but the second half of groups= is not the first half on the other side; give "
            "rt.Periodic(), or groups of which it is."
        )
    terms = replace(terms, contact=on_ground(terms.contact, terms.ground))
    feet = dict.fromkeys(foot for phase in phases for foot in phase.feet)
    stands = _standing(robot, terms, feet)
    check_step(robot, phases, length, steps, terms, stands[1])
    moved = _moved(robot, feet, repeat or Periodic(), length, terms.ground)
    problem = sequence(robot, phases, terms, moved, passes={})
    _check_legs(robot, problem, phases, parts, {foot: foot for foot in feet}, terms, length, steps, stands, whole=True)
    return _in_shares(problem, parts)


def _symmetric_repeat(robot: Robot, sides: Mapping[str, str]) -> Mirror | Periodic:
    """Return the mirror of a robot, or ``Periodic`` with a warning where its shape, inertia or limits have none.

    The legs of feet on both sides are partners, joint by joint.
    """
    try:
        found = mirror_by_geometry(robot, partners=leg_pairs(robot, sides))
    except InputError as error:
        check_heading(robot, tuple(sides))
        fault = str(error).split(": left and right")[0].rstrip(".")
        warn(f"{fault}. Hence both halves of the gait are planned, with rt.Periodic.")
        return Periodic()
    joint = joint_without_common_limits(robot, found)
    if joint is not None:
        warn(
            f"The position limits of joint {joint!r} of {robot.name!r} have no value in common with the mirror image "
            f"of those of {found.partner_of.get(joint, joint)!r}. Hence both halves of the gait are planned, with "
            "rt.Periodic."
        )
        return Periodic()
    off = imbalance(robot, found)
    if off <= IMBALANCE:
        return found
    warn(
        f"The inertia of {robot.name!r} is not symmetric (accelerations under mirrored torques differ by {off:.2g} of "
        "g over the robot's size). Hence both halves of the gait are planned, with rt.Periodic. "
        f"repeat=rt.gait.mirror(robot, imbalance={1.1 * off:.1g}) plans one half."
    )
    return Periodic()


def _in_shares(problem: Problem, parts: Sequence[float]) -> Problem:
    """Add links that keep free durations in the proportion of the parts."""
    bounds = [phase.duration_bounds for phase in problem.phases]
    ties = [
        Linkage((i, i + 1), DurationRatio(parts[i + 1] / parts[i]), name="share of the step", unit="s")
        for i in range(len(bounds) - 1)
        if bounds[i][0] < bounds[i][1]
    ]
    return replace(problem, links=[*problem.links, *ties])


@dataclass(frozen=True)
class DurationRatio:
    """Difference of the duration of a phase from a multiple of that of the phase before [s].

    Attributes
    ----------
    times : float
        The multiple.
    """

    times: float

    def __call__(self, first: Ends, second: Ends) -> Scalar:
        """Evaluate the difference."""
        return second.end.t - second.start.t - self.times * (first.end.t - first.start.t)


def _moved(
    robot: Robot, feet: Iterable[str], repeat: Mirror | Periodic, length: float, ground: Ground | GroundFunction
) -> Mirror | Periodic:
    """Return the repetition with the displacement along x and the rise of the ground."""
    level = as_ground(ground)
    rise = float(level.height(length, 0.0)) - float(level.height(0.0, 0.0))
    gain = {"q.root_x": length} | ({"q.root_z": rise} if rise else {})
    gains = {**gain, **repeat.displacement}
    check_ground_repeats(robot, list(feet), gains, isinstance(repeat, Mirror), level)
    return replace(repeat, displacement=gains)


def on_ground(kind: FootKind, ground: Ground | GroundFunction) -> FootKind:
    """Return the kind of contact on a ground; a contact with another ground than the level one keeps it."""

    def on(frame: str) -> Contact:
        contact = foot_contact(kind, frame)
        if contact.ground == Flat() != ground:
            if not has_field(contact, "ground"):
                raise InputError(
                    f"{type(contact).__name__} {contact.label!r} stands on level ground; give its class a field "
                    f"'ground', or leave out ground={ground!r}."
                )
            return copied(contact, ground=ground)
        return contact

    return on


GAITS = {2: ("walk", "run"), 4: ("trot", "crawl"), 6: ("walk",)}
"""Gaits by the number of feet that they move."""


def checked_feet(robot: Robot, feet: Sequence[str] | None, count: int, what: str) -> tuple[str, ...]:
    """Return the feet.

    Raises
    ------
    InputError
        The robot has another number of feet than ``count``, or another axis than z is up.
    """
    names = feet_of(robot, feet)
    check_up(robot, names)
    if len(names) != count:
        other = " or ".join(f"rt.gait.{gait}" for gait in GAITS.get(len(names), ()))
        raise InputError(
            f"rt.gait.{what} needs {count} feet; got {', '.join(names)}. Name them with feet=[...]"
            + (f", or use {other}, which moves {len(names)} feet." if other else ".")
        )
    return names
