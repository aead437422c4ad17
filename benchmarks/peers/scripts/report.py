"""The result of every script: figures of the solve, and samples of the tool's own interpolant."""

from __future__ import annotations

import os
import resource
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tasks import Task, task_of

SAMPLES = 21
"""Samples of an interval, both its ends included."""
_BEGAN: list[tuple[float, float]] = []


def requested_task() -> Task:
    """Return the task named by PEERS_TASK and start the clock; called after all imports."""
    _BEGAN.append((time.time(), processor()))
    return task_of(os.environ["PEERS_TASK"])


def urdf(task: Task) -> str:
    """Path of the task's robot."""
    return str(Path(os.environ["PEERS_URDF"]) / f"{task.urdf}.urdf")


def inside(knots: Any) -> np.ndarray:
    """Sample times of all intervals, (K, SAMPLES)."""
    knots = np.asarray(knots, dtype=float)
    return knots[:-1, None] + np.diff(knots)[:, None] * np.linspace(0, 1, SAMPLES)


def peak() -> float:
    """Peak resident memory of this process [MB]; getrusage would count the process that started it."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return float(next(line.split()[1] for line in lines if line.startswith("VmHWM"))) / 1024


def processor() -> float:
    """Processor seconds of this process and of those it waited for, compilers above all."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


class Clock:
    """Wall and processor seconds of a ``with`` block."""

    def __enter__(self) -> Clock:
        """Start."""
        self._began = time.perf_counter(), time.process_time()
        return self

    def __exit__(self, *_: object) -> None:
        """Stop."""
        self.wall = time.perf_counter() - self._began[0]
        self.processor = time.process_time() - self._began[1]


class Report:
    """Made as soon as the result is there; the clocks stop then.

    Parameters
    ----------
    solve : (float, float)
        Wall and processor seconds inside the solver.
    iterations : int
        Less than 0 where a tool does not report it.
    """

    def __init__(self, solve: tuple[float, float], iterations: int, success: bool, message: str = "") -> None:
        ended, spent = time.time(), processor()
        began, before = _BEGAN[0]
        self.figures = {
            "ended": ended,
            "work": ended - began,
            "process cpu": spent,
            "work cpu": spent - before,
            "solve": solve[0],
            "solve cpu": solve[1],
            "memory": peak(),
            "iterations": iterations,
            "success": success,
            "message": message,
        }

    def write(self, t: Any, q: Any, v: Any, u: Any, **further: float) -> None:
        """Store samples: t (K, S), q and v (K, S, n), u (K, S, m); further figures by name."""
        np.savez(sys.argv[1], t=t, q=q, v=v, u=u, **self.figures, **further)
