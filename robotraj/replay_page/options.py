"""Check of the options of a page that need no solution, so that a problem file is checked before its plan."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real
from typing import TypedDict

import numpy as np

from robotraj._util.errors import InputError
from robotraj.robot.robot import Robot


class ReplayOptions(TypedDict, total=False):
    """Options of ``rt.replay`` that need no solution."""

    speed: float
    fps: int
    traces: Sequence[str] | str | None
    periods: int
    title: str | None
    labels: Sequence[str] | None


def check_options(
    robot: Robot | None, speed: float = 1.0, fps: int = 30, traces: Sequence[str] | str | None = None
) -> None:
    """Check the playback speed, the keys per second and the traced frames of a robot, None for a system.

    Raises
    ------
    InputError
        A value out of range, or traces of a system. An unknown frame raises UnknownName.
    """
    if not (_is_number(speed) and np.isfinite(speed) and speed > 0.0):
        raise InputError(f"replay: speed is {speed!r}; give a factor above 0, such as 0.5 for half speed.")
    if not (_is_number(fps) and 1 <= fps <= 240 and int(fps) == fps):
        raise InputError(f"replay: fps is {fps!r}; give a whole number of frames per second from 1 to 240.")
    names = [traces] if isinstance(traces, str) else traces or ()
    if names and robot is None:
        raise InputError("replay: traces= names frames of a robot, but this solution is of an rt.System; omit traces=.")
    for name in names:
        assert robot is not None
        robot.frame(name)


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)
