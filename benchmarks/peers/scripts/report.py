"""What every script hands back: figures of the solve, and its own interpolant sampled densely."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tasks import TASKS, Task

SAMPLES = 21
"""Samples of an interval, both its ends included."""


def asked(name: str) -> Task:
    """Give the task of that name."""
    return TASKS[name]


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


class Report:
    """Made as soon as the result is there; the clock stops then."""

    def __init__(self, solve: float, iterations: int, success: bool, message: str = "") -> None:
        self.figures = {
            "ended": time.time(),
            "memory": peak(),
            "solve": solve,
            "iterations": iterations,
            "success": success,
            "message": message,
        }

    def write(self, t: Any, q: Any, v: Any, u: Any) -> None:
        """Store samples: t (K, S), q and v (K, S, n), u (K, S, m)."""
        np.savez(sys.argv[1], t=t, q=q, v=v, u=u, **self.figures)
