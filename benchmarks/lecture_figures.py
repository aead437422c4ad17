"""Figures of the lecture's experiment: error and seconds against points, error in time, the adaptive mesh."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

import robotraj as rt

Array = NDArray[np.float64]
Series = Mapping[str, Sequence[tuple[int, float, float]]]


def draw_costs(series: Series, path: str) -> Path:
    """Draw error and seconds against points; a series has (points, error, seconds) by name."""
    figure = Figure(figsize=(13, 5), layout="constrained")
    left, right = figure.subplots(1, 2)
    for name, rows in series.items():
        points, errors, seconds = zip(*rows, strict=True)
        style = "k*-" if name.startswith("adaptive") else "o-"
        left.loglog(points, errors, style, label=name)
        right.loglog(points, seconds, style, label=name)
    left.set(xlabel="points", ylabel="relative error of the duration")
    right.set(xlabel="points", ylabel="seconds, all meshes of an adaptive run added up")
    for axes in (left, right):
        axes.grid(alpha=0.3, which="both")
        axes.legend()
    figure.savefig(path, dpi=100)
    return Path(path)


def draw_errors(solutions: Mapping[str, rt.Solution], exact: Callable[[Array], Array], path: str) -> Path:
    """Draw the distance of the position from the exact one along solutions by name."""
    figure = Figure(figsize=(9, 5), layout="constrained")
    axes = figure.subplots()
    for name, solution in solutions.items():
        t = np.linspace(0, solution.duration, 401)[1:-1]
        distance = np.abs(solution.at(t).x["x"] - exact(t))
        axes.semilogy(t, np.maximum(distance, 1e-12), label=name)
    axes.set(xlabel="t [s]", ylabel="distance from the exact position [m]")
    axes.legend()
    figure.savefig(path, dpi=100)
    return Path(path)


def draw_mesh(solution: rt.Solution, path: str) -> Path:
    """Draw control and velocity over the lengths of the intervals."""
    figure = Figure(figsize=(13, 6), layout="constrained")
    over, under = figure.subplots(2, 1, sharex=True)
    knots = solution.phases[0].knots
    times = np.linspace(0, solution.duration, 2001)
    over.plot(times, solution.at(times).u["u"], label="control [N]")
    over.plot(knots, solution.at(knots).x["v"], "C1.-", label="velocity at knots [m/s]")
    over.legend()
    under.stairs(np.diff(knots), knots, baseline=None)
    under.plot(knots, np.full(len(knots), np.diff(knots).min() / 2), "k|")
    title = f"{len(knots) - 1} intervals"
    under.set(xlabel="t [s]", ylabel="length of interval [s]", yscale="log", title=title)
    figure.savefig(path, dpi=100)
    return Path(path)
