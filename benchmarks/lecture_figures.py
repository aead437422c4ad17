"""Figures 3 to 10 of the lecture's experiment, drawn from our own data; `lecture.py` calls this.

3, 4, 5
    Direct collocation by the lecture's scheme at 51, 101 and 201 points: position, velocity and force over the exact
    ones, and how far the position is off. The force crosses from 1 to -1 on lines over the two intervals beside the
    switch. The error arises there, and falls by four when the points double.
6, 7
    The same of multiple and of single shooting at 21 points: constants meet the switch, which is on a knot, and the
    position is off by 1e-8 m only.
8
    Seconds of all methods beside the lecture's 2, 7 and 55 s, and how far each position is off along time.
9
    The adaptive mesh against the uniform one nearest in points: force, velocity, lengths of the intervals. The switch
    is on no knot of the uniform mesh, whose parabola leaves the bounds between its points.
10
    Error of the duration and seconds against points: uniform meshes fall as the square of the length, the adaptive
    one by decades a mesh.

The numbers follow the order of the lecture's experiment (collocation at 51, 101 and 201 points, multiple
shooting, single shooting, adaptive against uniform mesh). Its text was not available: the numbers of
its panels are unknown, and its curves were not compared.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import robotraj as rt
from robotraj._util.arrays import Array

Series = Mapping[str, Sequence[tuple[int, float, float]]]
Motion = Callable[[Array], tuple[Array, Array, Array]]


def saved(figure: Figure, number: int) -> Path:
    path = Path(f"lecture_{number:02d}.png")
    figure.savefig(path, dpi=100)
    return path


def pieces(solution: rt.Solution) -> list[tuple[Array, rt.solution.Sample]]:
    """Sample every interval from inside it, so that controls jump at knots."""
    part = solution.phases[0]
    spans = zip(part.knots[:-1], part.knots[1:], strict=True)
    return [(t := np.linspace(*span, 9), part.at(t, interval=k)) for k, span in enumerate(spans)]


def draw_motion(number: int, name: str, solution: rt.Solution, exact: Motion) -> Path:
    """Figures 3 to 7: the motion over the exact one, and how far its position is off."""
    figure = Figure(figsize=(9, 10), layout="constrained")
    position, velocity, force, off = figure.subplots(4, 1, sharex=True)
    t = np.linspace(0, solution.duration, 1001)
    for axes, curve in zip((position, velocity, force), exact(t), strict=True):
        axes.plot(t, curve, "0.75", linewidth=4, label="exact")
    knots = solution.phases[0].knots
    for k, (times, sample) in enumerate(pieces(solution)):
        values = sample.x["x"], sample.x["v"], sample.u["u"]
        for axes, value in zip((position, velocity, force), values, strict=True):
            axes.plot(times, value, "C0", label=None if k else "planned")
        off.semilogy(times, np.maximum(np.abs(values[0] - exact(times)[0]), 1e-12), "C0")
    position.plot(knots, solution.at(knots).x["x"], "C1.", label=f"{len(knots)} points")
    velocity.plot(knots, solution.at(knots).x["v"], "C1.")
    for axes, label in zip(
        (position, velocity, force, off), ("x [m]", "v [m/s]", "u [N]", "distance from exact x [m]"), strict=True
    ):
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
    position.legend()
    position.set_title(f"{name}: {solution.duration:.7f} s")
    off.set_xlabel("t [s]")
    return saved(figure, number)


def draw_seconds(
    number: int,
    solutions: Mapping[str, rt.Solution],
    seconds: Mapping[str, float],
    reported: Mapping[str, float],
    exact: Motion,
) -> Path:
    """Figure 8: seconds beside the lecture's, and the distance from the exact position along time."""
    figure = Figure(figsize=(14, 6), layout="constrained")
    left, right = figure.subplots(1, 2)
    names = list(seconds)
    left.plot([seconds[name] for name in names], names, "C0o", label="here, median of rt.plan")
    left.plot([reported[name] for name in reported], list(reported), "C1D", label="lecture")
    left.set(xlabel="seconds", xscale="log")
    left.invert_yaxis()
    left.grid(alpha=0.3, which="both")
    left.legend()
    for name, solution in solutions.items():
        t = np.linspace(0, solution.duration, 401)[1:-1]
        right.semilogy(t, np.maximum(np.abs(solution.at(t).x["x"] - exact(t)[0]), 1e-12), label=name)
    right.set(xlabel="t [s]", ylabel="distance from the exact position [m]")
    right.legend(fontsize="small")
    return saved(figure, number)


def draw_meshes(number: int, adaptive: rt.Solution, uniform: rt.Solution) -> Path:
    """Figure 9: control, velocity and lengths of intervals on both meshes."""
    figure = Figure(figsize=(14, 8), layout="constrained")
    columns = figure.subplots(3, 2, sharex=True, sharey="row").T
    for column, name, solution in zip(columns, ("adaptive", "uniform"), (adaptive, uniform), strict=True):
        _mesh(column, name, solution)
    for axes, label in zip(columns[0], ("force [N]", "velocity [m/s]", "length of interval [s]"), strict=True):
        axes.set_ylabel(label)
    return saved(figure, number)


def _mesh(column: Sequence[Axes], name: str, solution: rt.Solution) -> None:
    part = solution.phases[0]
    for times, sample in pieces(solution):
        column[0].plot(times, sample.u["u"], "C0")
        column[1].plot(times, sample.x["v"], "C0")
    column[1].plot(part.knots, solution.at(part.knots).x["v"], "C1.")
    column[2].stairs(np.diff(part.knots), part.knots, baseline=None)
    column[2].plot(part.knots, np.full(len(part.knots), 1e-3), "k|")
    column[2].set(xlabel="t [s]", yscale="log")
    column[0].set_title(
        f"{name}: {len(part.knots) - 1} intervals, {len(part.points)} points, {solution.duration:.7f} s"
    )


def draw_costs(number: int, series: Series) -> Path:
    """Figure 10: error and seconds against points; a series has (points, error, seconds) by name."""
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
    return saved(figure, number)
