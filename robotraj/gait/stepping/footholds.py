"""Steps from rest to rest onto given footholds."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.point_contact import PointContact
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.terrain.flat import Flat
from robotraj.dynamics.terrain.function import GroundFunction
from robotraj.gait.bounds.margins import MARGIN, checked_margin, limits_with
from robotraj.gait.bounds.own_sides import OwnSides
from robotraj.gait.bounds.swing_clearance import through_ground
from robotraj.gait.bounds.upright import Upright
from robotraj.gait.capability.swing_time import check_swing_time
from robotraj.gait.checks import check_options, number, positive
from robotraj.gait.dependent_feet import held_attitude
from robotraj.gait.feet import FootKind, feet_of, foot_contact
from robotraj.gait.phase_sequence import sequence
from robotraj.gait.repetition import on_ground
from robotraj.gait.standing import FOOT_TOLERANCE
from robotraj.gait.stepping.foothold_arcs import step_clearances
from robotraj.gait.stepping.root_room import check_root
from robotraj.gait.stepping.stances import check_footholds
from robotraj.gait.supports import GaitOptions, GaitTerms, Support
from robotraj.guess.legs.stance import BalancedStance
from robotraj.guess.legs.standing_posture import mean_ground, pendulum_time, standing
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.objectives.base import Objective
from robotraj.problem.problem import Problem
from robotraj.problem.state import State
from robotraj.robot.robot import Robot
from robotraj.robot.root import QUATERNION
from robotraj.robot.sides.foot_pairs import foot_pairs

LEVEL = Flat()
OWN_SIDES = OwnSides()

SWING, SUPPORT, SHIFT = 1.8, 0.4, 1.4
"""Default durations of a step, and of the supports by all feet between steps and at both ends, in sqrt(h / g)."""
TILT = 0.6
"""Default bound of ``Upright``, to which a turn is added [rad]."""

ROOM = 0.9
"""Part of the distance of two footholds that feet keep to their own sides, in turns by large angles."""
LEVELLING = 3
"""Number of Newton steps from a small roll to none."""

Step = Mapping[str, Sequence[float]]
"""Footholds of the feet that swing together: (x, y) or (x, y, yaw) by frame [m, rad]; in a plane, (x,)."""


class StepOptions(GaitOptions, total=False):
    """Keyword arguments that motions on regular footholds pass to ``steps``."""

    swing: float
    support: float
    shift: float
    feet: Sequence[str] | None


def steps(
    robot: Robot,
    footholds: Sequence[Step],
    *,
    swing: float | None = None,
    support: float | None = None,
    shift: float | None = None,
    feet: Sequence[str] | None = None,
    contact: FootKind = PointContact,
    clearance: float | None = 0.0,
    objective: Objective | None = None,
    upright: Upright | None = None,
    ground: Ground | GroundFunction = LEVEL,
    sides: OwnSides | None = OWN_SIDES,
    margin: float = MARGIN,
) -> Problem:
    """Return a motion from rest to rest in which feet step onto given footholds, in the given order.

    The robot starts in the configuration of ``rt.gait.stand``, with the feet at their places of the neutral
    configuration. It ends at rest above the last footholds, with the mean heading of the feet. Phases with all feet on
    the ground precede, separate and follow the steps.

    Parameters
    ----------
    robot : Robot
        With ``root="planar"`` or ``"floating"``.
    footholds : sequence of mapping of str to sequence of float
        One mapping a step: from the frames of the feet that swing together to world x, y and, for soles, yaw
        [m, m, rad]. In a plane, x alone.
    swing, support, shift : float
        Durations [s] of a step, of the support by all feet between steps (0 for none), and of that at both ends. By
        default 1.8, 0.4 and 1.4 times sqrt(h / g), with h the height of the centre of mass in the first configuration.
    feet, contact, objective, ground, sides, margin
        As for ``rt.gait.walk``.
    clearance : float or None
        Height [m] of a swinging foot halfway between its footholds; 0 keeps it above the ground, None adds no row.
    upright : Upright, optional
        Bounds of the root; by default those of ``Upright`` with a tilt that allows the turn.

    Raises
    ------
    InputError
        There are no steps, a foot is unknown, a foothold is no pair of numbers, or all feet swing at once. A duration
        is not positive. The robot cannot stand on the footholds before or after a step.
    """
    names = feet_of(robot, feet)
    check_options(None, upright)
    _check(robot, footholds, names)
    kind = on_ground(contact, ground)
    contacts = {name: foot_contact(kind, name).bound_to(robot) for name in names}
    stance = BalancedStance(robot, tuple(contacts.values()))
    first = standing(stance)
    swing = positive(swing, SWING * pendulum_time(stance, first), "rt.gait.steps(swing)")
    shift = positive(shift, SHIFT * pendulum_time(stance, first), "rt.gait.steps(shift)")
    support = SUPPORT * pendulum_time(stance, first) if support is None else number(support, "rt.gait.steps(support)")
    if not support >= 0.0:
        raise InputError(f"rt.gait.steps(support) is {support!r}; give a duration [s], or 0 for none.")
    places = [stance.locate(first)]
    for step in footholds:
        reached = dict(places[-1])
        for foot, place in step.items():
            reached |= _anchors(contacts[foot].name, place, places[0])
        places.append(reached)
    held = held_attitude(robot, Support(names, shift, "stand"), first)
    if held:
        for k, after in enumerate(places[1:]):
            _keep_planes(robot, places[0], after, k)
    last, turn = check_footholds(stance, first, places, [tuple(step) for step in footholds])
    if held:
        last = _levelled(robot, stance, last, places[-1])
    bounds = Upright(tilt=min(TILT + abs(turn), 3.1)) if upright is None else upright
    check_root(stance, first, places, [tuple(step) for step in footholds], bounds)
    for before, after in itertools.pairwise(places):
        ways = {foot: _way(contacts[foot].name, before, after) for foot in names}
        check_swing_time(robot, first, ways, swing, checked_margin(margin), lambda enough: f"swing={enough:.2g}")
    supports = [Support(names, shift, "stand")]
    swings: list[tuple[int, int]] = []
    for k, step in enumerate(footholds):
        supports.append(Support(tuple(n for n in names if n not in step), swing, f"step {k + 1}"))
        swings.append((len(supports) - 1, k))
        if k + 1 < len(footholds) and support > 0.0:
            supports.append(Support(names, support, f"support {k + 1}"))
    supports.append(Support(names, shift, "stop"))
    terms = GaitTerms(kind, None, objective, None, ground, None, margin)
    problem = sequence(robot, supports, terms, None, State(q=first, v=0.0), State(q=last, v=0.0))
    # The root's height above an edge of the ground would be discontinuous, so it is measured from the feet's level.
    levels = [mean_ground(stance, place) for place in places]
    begun = [sum(i < at for i, _ in swings) for at in range(len(supports))]
    phases = [
        replace(
            phase,
            states={**bounds.states(robot), **phase.states},
            constraints=[
                *bounds.constraints(robot, first, Flat(levels[0]), _span(levels, k)),
                *limits_with(robot, checked_margin(margin)),
            ],
        )
        for phase, k in zip(problem.phases, begun, strict=True)
    ]
    for i, k in swings:
        begin = sum(float(cast(float, support.duration)) for support in supports[:i])
        ends, air = (places[k], places[k + 1]), (begin, begin + swing)
        rows: list[Constraint] = (
            [through_ground([contacts[f] for f in footholds[k]])]
            if clearance is None
            else [row for f in footholds[k] for row in step_clearances(contacts[f], *ends, air, clearance, ground)]
        )
        if sides is not None:
            room = _room(robot, contacts, first, ends)
            rows += sides.constraints(robot, contacts, first, supports[i].feet, room)
        phases[i] = replace(phases[i], constraints=[*phases[i].constraints, *rows])
        # The end of the motion fixes the last foothold of every foot; those before it are fixed where the feet land.
        later = {foot for step in footholds[k + 1 :] for foot in step}
        landed = [n for f in footholds[k] if f in later for n in _names(contacts[f].name, places[0])]
        fixed = {**phases[i + 1].parameters} | {name: places[k + 1][name] for name in landed}
        phases[i + 1] = replace(phases[i + 1], parameters={**phases[i + 1].parameters, **fixed})
    return replace(problem, phases=phases)


def _room(
    robot: Robot, contacts: Mapping[str, BoundContact], first: Array, ends: Sequence[Mapping[str, float]]
) -> float:
    """Return the distance [m] of feet on their own sides that the footholds before and after a step allow."""
    names = [[contacts[foot].name for foot in pair[:2]] for pair in foot_pairs(robot, list(contacts), first)]
    axes = "x" if robot.root == "planar" else "xy"
    apart = [[place[f"{a}.{axis}"] - place[f"{b}.{axis}"] for axis in axes] for a, b in names for place in ends]
    return ROOM * float(np.min(np.linalg.norm(apart, axis=1))) if apart else np.inf


def _way(foot: str, before: Mapping[str, float], after: Mapping[str, float]) -> float:
    """Return the horizontal distance of two footholds [m]."""
    return float(np.linalg.norm([after[n] - before[n] for n in _names(foot, before) if n.endswith((".x", ".y"))]))


def _span(levels: Sequence[float], k: int) -> tuple[float, float]:
    """Return the least and the greatest level of the feet from step k on to the next, above the first [m]."""
    near = levels[k : k + 2]
    return min(near) - levels[0], max(near) - levels[0]


def _names(foot: str, anchors: Mapping[str, float]) -> list[str]:
    return [name for name in anchors if name.rpartition(".")[0] == foot]


def _anchors(foot: str, foothold: Sequence[float], first: Mapping[str, float]) -> dict[str, float]:
    """Return the values of a foot's anchors by name; a yaw is counted from the first one."""
    values = dict(zip(("x", "y", "yaw"), (float(v) for v in foothold), strict=False))
    axes = {name: name.rpartition(".")[2] for name in _names(foot, first)}
    return {n: values[axis] + (first[n] if axis == "yaw" else 0.0) for n, axis in axes.items() if axis in values}


def _keep_planes(robot: Robot, before: Mapping[str, float], after: Mapping[str, float], k: int) -> None:
    """Check that legs which move in parallel planes reach their footholds after step k with a level root."""
    shifts = {name: after[name] - at for name, at in before.items() if name.endswith(".y")}
    off = float(np.ptp(list(shifts.values())))
    if off > FOOT_TOLERANCE:
        raise InputError(
            f"{robot.name!r} cannot stand on the footholds after step {k + 1}: its legs move in parallel planes, whose "
            f"distances these footholds change by {off:.2g} m. It can step forwards and backwards only. For turns and "
            "steps to the side, the legs need joints that swing them out of their planes."
        )


def _levelled(robot: Robot, stance: BalancedStance, q: Array, feet: Mapping[str, float]) -> Array:
    """Return a configuration near q on the same footholds, with a roll of zero.

    The feet's positions hardly change with the roll, so that inverse kinematics leave a little of it.
    """
    level = np.array(q)
    for _ in range(LEVELLING):
        level[QUATERNION.start] = 0.0
        level = pin.normalize(robot.model, level)
        rows, slope = stance.places(level, feet)
        slope[:, 3:6] = 0.0
        level = np.asarray(pin.integrate(robot.model, level, -np.linalg.lstsq(slope, rows, rcond=1e-8)[0]))
    return level


def _check(robot: Robot, footholds: Sequence[Step], names: Sequence[str]) -> None:
    least = 1 if robot.root == "planar" else 2
    if not footholds or not all(isinstance(step, Mapping) and step for step in footholds):
        raise InputError(
            f'footholds= must be mappings such as {{"{names[0]}": (0.2, 0.1)}}, one a step; got {footholds!r}.'
        )
    for k, step in enumerate(footholds):
        for foot, place in step.items():
            if foot not in names:
                raise InputError(f"Step {k + 1} moves {foot!r}, which is no foot; the feet are {', '.join(names)}.")
            values = np.atleast_1d(np.asarray(place, dtype=float))
            if values.ndim != 1 or not least <= len(values) <= 3 or not np.all(np.isfinite(values)):
                raise InputError(
                    f"The foothold of {foot!r} in step {k + 1} is {place!r}; give (x, y) or (x, y, yaw) [m, rad]."
                )
        if len(step) == len(names):
            raise InputError(f"Step {k + 1} moves all feet; leave one on the ground, or use rt.gait.jump.")
