"""Two plots of a run: solver time of each tool, and its growth with the mesh."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from figures import of
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from tasks import TASKS, task_of
from tools import TOOLS

BARS, SWEEP = "solve_seconds.svg", "mesh_seconds.svg"
# The same figures give the same file.
matplotlib.rcParams["svg.hashsalt"] = "peers"
matplotlib.rcParams["svg.fonttype"] = "none"  # text stays text: a quarter of the size
COLOURS = {
    "robotraj": "#084594",
    "robotraj-compiled": "#4292c6",
    "robotraj-interior-point": "#2171b5",
    "robotraj-bernstein-compiled": "#016c59",
    "robotraj-ipopt": "#6baed6",
    "robotraj-bernstein": "#41b6c4",
    "robotraj-ends": "#00441b",
    "robotraj-starts": "#54278f",
    "robotraj-starts-20": "#807dba",
    "by-hand": "#969696",
    "opti": "#74c476",
    "drake-ipopt": "#fd8d3c",
    "drake-snopt": "#d94801",
    "crocoddyl": "#d62728",
    "dymos": "#9467bd",
    "opty": "#e377c2",
    "opty-compiled": "#f7b6d2",
}


def _save(figure: Figure, path: Path) -> None:
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def bars(record: Mapping[str, Any], path: Path) -> None:
    """Processor seconds in the solver, a group of bars for each task."""
    tasks = [key for key in (*TASKS, "T4@200") if key in record["results"]]
    names = [name for name in TOOLS if any(of(record, key, name, "solve cpu") > 0 for key in tasks)]
    figure = Figure(figsize=(11, 4.5), layout="constrained")
    axes = figure.subplots()
    width = 0.85 / max(len(names), 1)
    for i, name in enumerate(names):
        values = [of(record, key, name, "solve cpu") for key in tasks]
        places = np.arange(len(tasks)) + (i - (len(names) - 1) / 2) * width
        axes.bar(places, values, width, color=COLOURS[name], label=TOOLS[name].title)
    axes.set(yscale="log", ylabel="processor seconds in the solver")
    axes.set_xticks(range(len(tasks)), [f"{key} {task_of(key).title}".replace(" ", "\n", 2) for key in tasks])
    axes.grid(axis="y", alpha=0.3)
    figure.legend(loc="outside right upper", fontsize="small")
    _save(figure, path)


def _against_intervals(axes: Axes, record: Mapping[str, Any], figure: str, title: str) -> None:
    keys = sorted((key for key in record["results"] if key.startswith("T4")), key=lambda key: task_of(key).intervals)
    for name, tool in TOOLS.items():
        found = [(task_of(key).intervals, of(record, key, name, figure)) for key in keys]
        found = [(n, value) for n, value in found if value == value]
        if found:
            axes.loglog(*zip(*found, strict=True), "o-", color=COLOURS[name], label=tool.title)
    counts = [task_of(key).intervals for key in keys]
    axes.set_xticks(counts, [str(n) for n in counts], minor=False)
    axes.minorticks_off()
    axes.set(xlabel="intervals of T4", ylabel="processor seconds", title=title)
    axes.grid(alpha=0.3)


def sweep(record: Mapping[str, Any], path: Path) -> None:
    """T4: seconds in the solver, and of build and solve, against intervals."""
    figure = Figure(figsize=(11, 4.5), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    _against_intervals(left, record, "solve cpu", "solve")
    _against_intervals(right, record, "work cpu", "build and solve")
    figure.legend(*left.get_legend_handles_labels(), loc="outside right upper", fontsize="small")
    _save(figure, path)
