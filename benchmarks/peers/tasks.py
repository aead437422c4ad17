"""The tasks T1 to T5 as plain data, the same for every tool. SI units."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, pi


@dataclass(frozen=True)
class Task:
    """One motion of one robot, rest to rest.

    Attributes
    ----------
    urdf : str
        Name of the robot; ``urdf.py`` writes it without shapes, for all tools alike.
    joints : tuple of str
        Order of q and v.
    actuated : tuple of int
        Joints with a motor, in order of u.
    start, end : tuple of float
        q at both ends; v is zero there.
    duration : float, or (least, greatest)
    guess : float
        Duration of the first, straight guess [s].
    position, velocity : (lower, upper), limit
        One number a joint.
    effort : tuple of float
        One number a motor.
    objective : str
        "effort", the integral of u.u, or "duration".
    intervals : int
    """

    title: str
    urdf: str
    joints: tuple[str, ...]
    actuated: tuple[int, ...]
    start: tuple[float, ...]
    end: tuple[float, ...]
    duration: float | tuple[float, float]
    guess: float
    position: tuple[tuple[float, ...], tuple[float, ...]]
    velocity: tuple[float, ...]
    effort: tuple[float, ...]
    objective: str
    intervals: int

    @property
    def durations(self) -> tuple[float, float]:
        """Least and greatest duration [s]."""
        return self.duration if isinstance(self.duration, tuple) else (self.duration, self.duration)


def _within(*largest: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    return tuple(-x for x in largest), largest


TASKS = {
    "T1": Task(
        "block, minimum time", "block", ("slider",), (0,), (0.0,), (10.0,), (0.1, 20.0), 10.0,
        _within(20.0), (inf,), (1.0,), "duration", 50,
    ),
    "T2": Task(
        "cart-pole swing-up", "cartpole", ("slider", "pole"), (0,), (0.0, 0.0), (1.0, pi), 2.0, 2.0,
        _within(2.0, 2 * pi), (inf, inf), (20.0,), "effort", 50,
    ),
    "T3": Task(
        "acrobot swing-up", "rods", ("shoulder", "elbow"), (1,), (0.0, 0.0), (pi, 0.0), 4.0, 4.0,
        _within(inf, inf), (inf, inf), (10.0,), "effort", 100,
    ),
    "T4": Task(
        "ur5, effort", "ur5",
        ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"),
        (0, 1, 2, 3, 4, 5), (-1.1, -1.8, 1.6, -1.2, -1.57, 0.0), (1.1, -0.8, 0.6, -0.6, -0.6, 1.2), 1.0, 1.0,
        _within(2 * pi, 2 * pi, pi, 2 * pi, 2 * pi, 2 * pi), (3.15,) * 3 + (3.2,) * 3, (150.0,) * 3 + (28.0,) * 3,
        "effort", 50,
    ),
    "T5": Task(
        "panda, minimum time", "panda", tuple(f"panda_joint{i}" for i in range(1, 8)), tuple(range(7)),
        (0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785), (1.5, 0.5, -0.5, -1.2, 0.6, 2.2, -0.8), (0.1, 3.0), 1.5,
        ((-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973),
         (2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973)),
        (2.175,) * 4 + (2.61,) * 3, (87.0,) * 4 + (12.0,) * 3, "duration", 50,
    ),
}  # fmt: skip


def task_of(key: str) -> Task:
    """Return a task by name, "T4", or on another mesh, "T4@200".

    Raises
    ------
    KeyError
        No task of that name.
    """
    name, at, intervals = key.partition("@")
    return replace(TASKS[name], intervals=int(intervals)) if at else TASKS[name]
