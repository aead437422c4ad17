"""Check of the options of a page that need no solution, so that a problem file is checked before its plan."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypedDict

from robotraj._util.checks import number, whole
from robotraj._util.errors import InputError
from robotraj.robot.robot import Robot

SLOWEST = 1e-6
"""Slowest playback; the fastest is its inverse."""


class ReplayOptions(TypedDict, total=False):
    """Options of ``rt.replay`` that need no solution."""

    speed: float
    fps: int
    traces: Sequence[str] | str | None
    periods: int
    title: str | None
    labels: Sequence[str] | None


def check_options(
    robot: Robot | None,
    speed: float = 1.0,
    fps: int = 30,
    traces: Sequence[str] | str | None = None,
    title: str | None = None,
) -> None:
    """Check the playback speed, the keys per second, the heading and the traced frames of a robot, None for a system.

    Raises
    ------
    InputError
        A value out of range, or traces of a system. An unknown frame raises UnknownName.
    """
    number("replay: speed, 0.5 for half speed,", speed, SLOWEST, 1.0 / SLOWEST)
    whole("replay: fps", fps, 1, 240)
    if title is not None and not isinstance(title, str):
        raise InputError(f"replay: title= is a text; got {title!r}.")
    names = [traces] if isinstance(traces, str) else traces or ()
    if names and robot is None:
        raise InputError("replay: traces= names frames of a robot, but this solution is of an rt.System; omit traces=.")
    for name in names:
        assert robot is not None
        robot.frame(name)
