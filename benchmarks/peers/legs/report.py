"""Markdown from the record of a run."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Mapping
from typing import Any

from walks import WALKS

NAMES = {
    "crocoddyl": "Crocoddyl 3.2.1", "robotraj": "robotraj", "robotraj compiled": "robotraj, "
    "`engine=rt.engines.Compiled()`",
    "robotraj interior point": "robotraj, interior point",
    "robotraj periodic": "robotraj, one step that repeats",
    "robotraj periodic interior point": "robotraj, interior point, one step that repeats",
}  # fmt: skip


def _number(value: float) -> str:
    return f"{value:.2g}" if abs(value) < 10 else f"{value:.0f}"


def _percent(value: float) -> str:
    return "holds" if value < 1e-6 else f"{100 * value:.2g} %"


def _metres(value: float) -> str:
    return f"{1e3 * value:.3g} mm" if value > 1e-9 else "0"


def _excess(unit: str) -> Callable[[float], str]:
    return lambda value: "hold" if value < 1e-6 else f"broken by {value:.2g} {unit}"


# Row of the table: (label, figure, format).
ROWS: tuple[tuple[str, str, Callable[[float], str]], ...] = (
    ("solve, processor [s]", "worked", _number),
    ("solve, clock [s]", "solve", _number),
    ("whole process, processor [s]", "total worked", _number),
    ("whole process, clock [s]", "total", _number),
    ("iterations", "iterations", lambda value: f"{value:.0f}"),
    ("intervals", "nodes", lambda value: f"{value:.0f}"),
    ("memory [MB]", "memory", lambda value: f"{value:.0f}"),
    ("joint positions", "over position", _excess("rad")),
    ("joint speeds", "over speed", _excess("rad/s")),
    ("torque limits", "over torque", _percent),
    ("friction cone, of weight", "cone", _percent),
    ("friction cone, share of time broken", "cone time", _percent),
    ("ground pulls, of weight", "pull", _percent),
    ("centre of pressure outside the sole", "pressure", _metres),
    ("centre of pressure outside Crocoddyl's smaller sole", "box", _metres),
    ("slip", "slip", _metres),
    ("sink", "sink", _metres),
    ("stands above or below the ground", "off ground", _metres),
    ("swings below the ground", "lowest swing", lambda value: _metres(max(0.0, -value))),
    ("footholds missed by", "step missed by", _metres),
    ("swing reaches", "apex", _metres),
    ("root equations between knots, of weight", "equations root", _percent),
    ("joint equations between knots [N m]", "equations", _number),
    ("one interval simulated, error over time [rad/s]", "defect", _number),
    ("one phase simulated open loop, error [rad, m]", "drift", _number),
    ("motion [s]", "time", _number),
    ("way of the root [m]", "way", _number),
    ("integral of tau^2", "effort", _number),
    ("cost of transport", "transport", _number),
    ("ends at [m/s, rad/s]", "end speed", _number),
)


def full(record: Mapping[str, Any]) -> str:
    """Every figure of every walk: medians over the runs."""
    lines = []
    for walk, tools in record["results"].items():
        shown = {tool: runs for tool, runs in tools.items() if any("failed" not in run for run in runs)}
        lines += [f"### {walk} {WALKS[walk].title}", "", "| | " + " | ".join(NAMES[tool] for tool in shown) + " |"]
        lines.append("|---" * (len(shown) + 1) + "|")
        count = [str(sum("failed" not in run for run in runs)) for runs in shown.values()]
        lines.append("| runs | " + " | ".join(count) + " |")
        for title, key, written in ROWS:
            cells = []
            for runs in shown.values():
                good = [run[key] for run in runs if "failed" not in run]
                cells.append(written(statistics.median(good)))
            lines.append(f"| {title} | " + " | ".join(cells) + " |")
        lines.append("")
    return "\n".join(lines)
