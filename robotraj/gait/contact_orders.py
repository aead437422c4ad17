"""Gaits that differ in the order in which the feet of a robot stand and swing: candidates at one speed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from robotraj._util.errors import InputError
from robotraj.gait.checks import number, positive
from robotraj.gait.feet import feet_of
from robotraj.gait.supports import GaitOptions
from robotraj.gait.walks import run, trot, walk
from robotraj.problem.problem import Problem
from robotraj.robot.robot import Robot
from robotraj.robot.sides.images import frames_across, places_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

FLIGHT = 0.3
"""Fraction of a step in the air, of orders with a flight."""
TOGETHER = 0.2
"""Fraction of a step with all feet on the ground, of orders with such a support."""

Writer = Callable[[], Problem]


def orders(
    robot: Robot, *, speed: float, stride: float, feet: Sequence[str] | None = None, **options: Unpack[GaitOptions]
) -> dict[str, Problem]:
    """Return gaits of one speed by name, which differ in the order of their contacts.

    All have strides of the same duration, in which each foot swings once:

    - of two feet: "walk", "walk with double support", "run";
    - of four feet: "trot" and "trot with flight" of diagonal pairs, "pace" of the pairs on one side, "bound" of the
      front and the hind pair, "lateral sequence" and "diagonal sequence" of single feet.

    ``rt.applications.cheapest`` plans them and names the one with the least objective per metre. Orders that the legs
    cannot do at this speed are left out.
    Source of the sequences: Hildebrand, Science 150 (1965), on symmetrical gaits of horses.

    Parameters
    ----------
    robot : Robot
        With ``root="planar"`` or ``"floating"``, and two or four feet.
    speed : float
        Speed of the root along x [m/s].
    stride : float
        Duration of a stride [s].
    feet : sequence of str, optional
        The frames of the feet; by default those named foot, sole or toe.
    **options
        Of ``rt.gait.walk``: contact, clearance, objective, upright, ground, sides, margin.

    Raises
    ------
    InputError
        The robot has another number of feet, a number is invalid, or no order can be written; then the reason is that
        of the last one.
    """
    names = feet_of(robot, feet)
    quick = number(speed, "rt.gait.orders(speed)", "m/s")
    time = positive(stride, 0.0, "rt.gait.orders(stride)")
    if len(names) not in (2, 4):
        raise InputError(
            f"rt.gait.orders knows orders of two and of four feet; {robot.name!r} has {', '.join(names)}. Name them "
            "with feet=, or give rt.applications.cheapest other gaits, such as rt.gait.walk(groups=...)."
        )
    writers = (_of_two if len(names) == 2 else _of_four)(robot, names, quick, time, options)
    written: dict[str, Problem] = {}
    refusal: InputError | None = None
    for name, write in writers.items():
        try:
            written[name] = write()
        except InputError as error:
            refusal = error
    if not written and refusal is not None:
        raise refusal
    return written


def _of_two(robot: Robot, feet: Sequence[str], speed: float, stride: float, options: GaitOptions) -> dict[str, Writer]:
    """Return the orders of a biped."""
    step = 0.5 * stride
    return {
        "walk": lambda: walk(robot, feet=feet, speed=speed, duration=step, **options),
        "walk with double support": lambda: walk(
            robot, feet=feet, speed=speed, duration=step, double_support=TOGETHER, **options
        ),
        "run": lambda: run(robot, feet=feet, speed=speed, duration=step, flight=FLIGHT, **options),
    }


def _of_four(robot: Robot, feet: Sequence[str], speed: float, stride: float, options: GaitOptions) -> dict[str, Writer]:
    """Return the orders of a quadruped."""
    across, places = frames_across(robot, feet), places_of(robot, robot.neutral)
    near = sorted((foot for foot in feet if places[foot][1] > 0.0), key=lambda foot: float(places[foot][0]))
    if len(near) != 2 or any(across[foot] in near or across[foot] == foot for foot in near):
        raise InputError(f"rt.gait.orders needs two feet on each side; got {', '.join(feet)}.")
    hind, fore = near
    other_hind, other_fore = across[hind], across[fore]

    def swinging(*groups: Sequence[str]) -> Writer:
        return lambda: walk(robot, feet=feet, groups=groups, speed=speed, duration=stride / len(groups), **options)

    def trotting(flight: float) -> Writer:
        return lambda: trot(robot, feet=feet, speed=speed, duration=0.5 * stride, flight=flight, **options)

    return {
        "trot": trotting(0.0),
        "trot with flight": trotting(FLIGHT),
        "pace": swinging((hind, fore), (other_hind, other_fore)),
        "bound": swinging((hind, other_hind), (fore, other_fore)),
        "lateral sequence": swinging((hind,), (fore,), (other_hind,), (other_fore,)),
        "diagonal sequence": swinging((hind,), (other_fore,), (other_hind,), (fore,)),
    }
