"""What controllers require of a stream of set points, measured on the set points that they get.

Controllers differentiate the positions that arrive. Speeds, accelerations and jerks are therefore the differences of
the exported positions at the controller's period, with the robot at rest before the first and after the last.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from robotraj._util.checks import is_number
from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import table
from robotraj._util.values import dataclass
from robotraj.problem.constraints.base import Where
from robotraj.robot.limits import Limits
from robotraj.solution.export.set_points import SetPoints, set_points
from robotraj.solution.planned import Planned
from robotraj.solution.proof import Goals

HELD = 3
"""Number of periods at rest before and after the motion: a jerk needs four positions."""
_VERDICTS: Mapping[bool | None, str] = {True: "holds", False: "fails", None: "not judged"}
ROUNDING = 1e-6
"""Largest excess of a limit that is rounding: relative, and of positions absolute."""
REMEDY = "plan with limits=robot.limits.scaled(0.999), since a proof allows an excess of 1e-3"
REST = 1e-6
"""Largest speed at rest [rad/s, m/s]."""


@dataclass(frozen=True)
class Controller:
    """An interface of a robot's controller.

    Attributes
    ----------
    rates : tuple of float
        Lowest and highest rate of set points [Hz].
    usual : float
        Rate where none is given [Hz].
    motors : int or None
        Number of joints; None for any.
    rates_limited : bool
        Whether it stops with an error where an acceleration or a jerk exceeds the robot's limit, so that both must
        be known.
    source : str
        Document of the requirements.
    """

    rates: tuple[float, float]
    usual: float
    motors: int | None
    rates_limited: bool
    source: str


CONTROLLERS: Mapping[str, Controller] = {
    "joint_trajectory_controller": Controller(
        (1e-3, 1e4), 100.0, None, False, "ros2_controllers, joint_trajectory_controller, trajectory representation"
    ),
    "servoj": Controller((125.0, 500.0), 500.0, 6, False, "Universal Robots, ServoJ command"),
    "fri": Controller((10.0, 1000.0), 200.0, 7, False, "KUKA Sunrise.FRI, send period of 1 to 100 ms"),
    "libfranka": Controller((1000.0, 1000.0), 1000.0, 7, True, "Franka Emika, libfranka, rate_limiting.h"),
}
"""By name."""


@dataclass(frozen=True)
class Requirement:
    """One requirement of a controller.

    Attributes
    ----------
    name : str
    holds : bool or None
        None where it could not be judged.
    figure, bound : float
        What was measured, and what it must not exceed; of a rate, the given and the nearest that is accepted.
    unit : str
    where : str
        Joint and time of the largest figure.
    remedy : str
        What to change where it fails.
    """

    name: str
    holds: bool | None
    figure: float
    bound: float
    unit: str
    where: str = ""
    remedy: str = ""


@dataclass(frozen=True)
class ControllerReport:
    """The requirements of a controller on the set points of a plan.

    Attributes
    ----------
    controller : str
    source : str
        Document of the requirements.
    rate : float
        Of the set points [Hz].
    requirements : tuple of Requirement
    """

    controller: str
    source: str
    rate: float
    requirements: tuple[Requirement, ...]

    @property
    def passed(self) -> bool:
        """Whether no requirement fails."""
        return all(each.holds is not False for each in self.requirements)

    def __str__(self) -> str:
        """Print a line for each requirement."""
        rows = [
            (
                each.name,
                _VERDICTS[each.holds],
                f"{each.figure:.6g}",
                "-" if np.isnan(each.bound) else f"{each.bound:.6g}",
                each.unit,
                each.where if each.holds else "; ".join(filter(None, (each.where, each.remedy))),
            )
            for each in self.requirements
        ]
        verdict = "accepts" if self.passed else "does not accept"
        head = f"{self.controller} {verdict} the set points at {self.rate:g} Hz ({self.source})"
        return "\n".join([head, *table([("requirement", "", "figure", "bound", "unit", "where"), *rows])])


def controller_report(
    solution: Planned, controller: str, rate: float | None = None, limits: Limits | None = None
) -> ControllerReport:
    """Check the set points of a plan against what a controller requires.

    ==============================  =============================================================================
    requirement                     holds where
    ==============================  =============================================================================
    rate                            the controller accepts that many set points per second
    joints                          it has that many motors
    rest at the start, at the end   speeds of the plan are at most 1e-6 rad/s or m/s. A start that the plan is given in
                                    motion, as a stop on a path is, is not judged: it replaces a running motion
    position, speed                 are within the limits
    acceleration, jerk              are within the limits; without limits they are not judged, and fail for libfranka
    ==============================  =============================================================================

    Speeds, accelerations and jerks are differences of the positions at the period of the controller. The start must be
    where the robot is, which only the controller knows.

    Parameters
    ----------
    solution : Solution
        A plan of one robot.
    controller : str
        ``"joint_trajectory_controller"``, ``"servoj"``, ``"fri"`` or ``"libfranka"``.
    rate : float, optional
        Set points per second [Hz]; by default 100, 500, 200 and 1000.
    limits : Limits, optional
        Those of the robot by default.

    Raises
    ------
    UnknownName
        Another controller.
    InputError
        The plan moves a System or several robots, or the rate is not above 0.

    Examples
    --------
    >>> print(rt.solution.controller_report(solution, "servoj"))  # doctest: +SKIP
    """
    if controller not in CONTROLLERS:
        raise unknown_name("controller", controller, list(CONTROLLERS), "Give one of them.")
    known = CONTROLLERS[controller]
    chosen = known.usual if rate is None else rate
    if not (is_number(chosen) and chosen > 0.0):
        raise InputError(f"rate={rate!r}: give set points per second above 0, such as {known.usual:g}.")
    points = set_points(solution, float(chosen))
    robot = solution.phases[0].phase.robot
    assert robot is not None
    given = robot.limits if limits is None else limits
    moving = [robot.velocity_names.index(joint) for joint in points.joints]
    stream = _stream(points, known, float(chosen), _starts_in_motion(solution))
    differences = _differences(points, known, float(chosen), given, moving)
    return ControllerReport(controller, known.source, float(chosen), (*stream, *differences))


def _starts_in_motion(solution: Planned) -> bool:
    """Whether the plan is given its speeds at the start, and they are not 0."""
    phase = solution.phases[0].phase
    assert phase.robot is not None
    low, high = phase.joint_ends[Where.START]
    speeds = slice(phase.robot.nq, phase.robot.nq + phase.robot.nv)
    return bool(np.array_equal(low[speeds], high[speeds]) and np.abs(low[speeds]).max(initial=0.0) > REST)


def _stream(points: SetPoints, known: Controller, rate: float, in_motion: bool) -> Iterator[Requirement]:
    low, high = known.rates
    nearest = float(np.clip(rate, low, high))
    yield Requirement("rate", rate == nearest, rate, nearest, "Hz", remedy=f"export with rate={nearest:g}")
    if known.motors is not None:
        count = len(points.joints)
        remedy = "load the arm alone, with locked= for the others"
        yield Requirement("joints", count == known.motors, count, known.motors, "", remedy=remedy)
    for name, k in (("rest at the start", 0), ("rest at the end", -1)):
        speeds = np.abs(points.v[k])
        joint = int(np.argmax(speeds))
        figure, unit, where = float(speeds[joint]), f"{points.units[joint]}/s", points.joints[joint]
        if in_motion and k == 0 and figure > REST:
            replaces = "send it in place of the motion that the robot is in"
            yield Requirement("start in motion", None, figure, np.nan, unit, where, replaces)
            continue
        yield Requirement(name, figure <= REST, figure, REST, unit, where, "plan that end with rt.State(v=0)")


def _differences(
    points: SetPoints, known: Controller, rate: float, limits: Limits, moving: list[int]
) -> Iterator[Requirement]:
    """Compare positions and their differences at equal periods with the limits.

    The controller gets the last position a whole period after the one before, as all others. Before a start at rest and
    after an end at rest it gets the same position again.
    """
    before, after = (HELD if np.abs(points.v[k]).max() <= REST else 0 for k in (0, -1))
    values = np.concatenate([np.repeat(points.q[:1], before, 0), points.q, np.repeat(points.q[-1:], after, 0)])
    for order, name in enumerate(("position", "velocity", "acceleration", "jerk")):
        if order:
            values = np.diff(values, axis=0) * rate
        low, high = (side[moving] for side in limits.sides(name))
        below, above = low - values, values - high
        sizes = np.max(np.where(np.isfinite([low, high]), np.abs([low, high]), 0.0), axis=0)
        excess = np.maximum(below, above) / np.where((order > 0) & (sizes > 0.0), sizes, 1.0)
        k, joint = np.unravel_index(int(np.argmax(excess)), excess.shape)
        unit = points.units[joint] + ("", "/s", "/s^2", "/s^3")[order]
        label = "speed" if name == "velocity" else name
        if not np.isfinite([low, high]).any():
            if order:
                largest = float(np.abs(values).max())
                remedy = f"no limit is known; plan with limits={{'{name}': ...}}"
                yield Requirement(label, False if known.rates_limited else None, largest, np.nan, unit, remedy=remedy)
            continue
        is_low = below[k, joint] > above[k, joint]
        # Speeds and their rates below a lower limit are stated as magnitudes in that direction.
        sign = -1.0 if is_low and order else 1.0
        figure, bound = sign * float(values[k, joint]), sign * float((low if is_low else high)[joint])
        where = f"{points.joints[joint]} at {max(0.0, (k - before + order) / rate):.4g} s"
        # A proof allows a small excess. Only a controller that stops the arm there is not content with it.
        allowed = Goals().excess if order and not known.rates_limited else ROUNDING
        holds = bool(excess[k, joint] <= allowed)
        yield Requirement(label, holds, figure, bound, unit, where, REMEDY)
