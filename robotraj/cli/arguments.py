"""Arguments of the command line as values: configurations, durations, limits, motions from rest to rest."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.applications.problem_files.obstacles import load_obstacles
from robotraj.cli.minimise import Minimise
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.collision_free import CollisionFree
from robotraj.problem.objectives.base import Objective
from robotraj.problem.objectives.duration import Duration
from robotraj.problem.objectives.effort import Effort
from robotraj.problem.phase import Phase
from robotraj.problem.state import State
from robotraj.robot.limits import Limits
from robotraj.robot.robot import Robot


def rest_to_rest(
    robot: Robot,
    objective: Minimise,
    duration: str | None,
    start: Array | None,
    end: Array | None,
    limits: Limits | None,
    constraints: Sequence[Constraint] = (),
) -> Phase:
    """Return the phase of ``robotraj plan``; without a duration it takes 2 s, or a free time that is minimised."""
    free = (0.05, 60.0) if objective is Minimise.duration else 2.0
    cost: Objective = Duration() if objective is Minimise.duration else Effort()
    return Phase(
        robot,
        duration=free if duration is None else duration_of(duration),
        start=State(q=start, v=0),
        end=State(q=end, v=0),
        objective=cost,
        constraints=constraints,
        limits=limits,
        name=f"{robot.name}, least {objective.value}",
    )


def clear_of(obstacles: Path | None, srdf: Path | None, margin: float | None) -> list[Constraint]:
    """Return the constraint of ``--collision-free``: the shapes of a file, and the pairs that an SRDF disables."""
    shapes = () if obstacles is None else load_obstacles(obstacles)
    return [CollisionFree(shapes, margin=margin or 0.0, srdf=srdf)]


def limits_of(robot: Robot, own: bool, velocity: float | None, effort: float | None) -> Limits | None:
    """Return the robot's limits, with one speed or torque for all joints where it is given; or None."""
    if own:
        return robot.limits.with_(velocity=velocity, effort=effort)
    if velocity is not None or effort is not None:
        raise InputError("--no-limits removes all limits: give it without --velocity and --effort.")
    return None


def configuration_of(robot: Robot, text: str | None, option: str) -> Array:
    """Read ``"0,1.57"`` in the order of the joints, or ``"elbow=1.57"`` by name (the others neutral)."""
    if text is None:
        return robot.neutral
    parts = [part.strip() for part in text.split(",") if part.strip()]
    if not any("=" in part for part in parts):
        return robot.configuration([_number(part, option) for part in parts], option)
    values = {}
    for part in parts:
        joint, equals, value = part.partition("=")
        if not equals:
            raise InputError(f"{option} {text!r} mixes 'joint=value' with values alone ({part!r}); name every joint.")
        values[joint.strip()] = _number(value, option)
    neutral = dict(zip(robot.position_names, robot.neutral, strict=True))
    return robot.configuration({**neutral, **values}, option)


def duration_of(text: str) -> float | tuple[float, float]:
    """Read ``"2"`` or ``"0.5:3"`` [s]."""
    least, separator, greatest = text.partition(":")
    if not separator:
        return _number(text, "--duration", " such as 2, or least and greatest as in 0.5:3 [s]")
    return _number(least, "--duration"), _number(greatest, "--duration")


def _number(text: str, option: str, such_as: str = " such as 1.57; a comma separates two, as in 0,1.57") -> float:
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise InputError(f"{option} has {text!r}, which is no number; give a number{such_as}.")
    return value
