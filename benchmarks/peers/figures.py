"""Medians of the measurements."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

Runs = list[dict[str, Any]]


def good(runs: Runs) -> Runs:
    """Return the runs that returned a plan."""
    return [run for run in runs if "failed" not in run]


def median(runs: Runs, key: str) -> float:
    """Median of a figure over the runs that ended well; NaN where none has it."""
    values = [run[key] for run in good(runs) if key in run]
    return statistics.median(values) if values else float("nan")


def over(runs: Runs) -> str:
    """Largest excess over a limit, in percent of it, and which limit."""
    value, kind = max((median(runs, f"over {kind}"), kind) for kind in ("position", "speed", "torque"))
    digits = ".0f" if value > 0.1 else ".2g"
    return "0" if value < 1e-6 else f"{100 * value:{digits}} % {kind}"


def seconds(value: float) -> str:
    """Two significant digits below 10 s; nothing for NaN."""
    return "" if value != value else f"{value:.2g}" if value < 10 else f"{value:.0f}"


def of(record: Mapping[str, Any], task: str, name: str, key: str) -> float:
    """Median of one tool's figure on one task; NaN where there is none."""
    return median(record["results"].get(task, {}).get(name, []), key)


def off_the_line(x: Sequence[float], y: Sequence[float]) -> float:
    """Largest relative distance of y from the straight line over x that is nearest in relative squares."""
    weights = 1 / np.asarray(y)
    rows = np.column_stack([np.ones(len(x)), x]) * weights[:, None]
    line = np.linalg.lstsq(rows, np.ones(len(x)), rcond=None)[0]
    return float(np.max(np.abs(rows @ line - 1)))
