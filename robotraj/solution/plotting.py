"""Plots of solutions: every variable over time with its limits, the knots and the collocation points.

Figures are matplotlib's, made without pyplot, so that no window opens.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.variable import Variable
from robotraj.solution.columns import values_of, variables_of

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.typing import ColorType

    from robotraj.solution.phase_solution import PhaseSolution
    from robotraj.solution.planned import Planned

Panel = tuple[str, str]
"""Quantity and unit of one set of axes."""

SAMPLES = 1200
"""Approximate number of points of each curve, shared among the intervals of a phase."""
CROWD = 250
"""Number of points in a panel above which they are marked below the curves."""
REACH = 0.75
"""Distance of a limit from the curves, relative to their span, above which it is written as text."""
QUANTITIES = ("position", "velocity", "acceleration", "effort", "state", "algebraic variable", "control")
QUATERNION = ("position", "")
"""The positions without a unit: the quaternion of a floating root."""
QUIET = "0.45"
DASHES = (0, (5, 3))


@dataclass(frozen=True, eq=False)
class _Trace(OneLine):
    """One phase of a solution, evaluated for drawing."""

    part: PhaseSolution
    times: Array
    values: dict[str, Array]
    knots: Array
    at_knots: dict[str, Array]
    inner: Array
    at_inner: dict[str, Array]


def plot(solution: Planned) -> Figure:
    """Draw every variable of a solution over time.

    Robots get positions, velocities, accelerations and torques, Systems their states, algebraic variables and
    controls; each quantity and unit has its own axes. Dashed lines are limits that hold throughout a phase.
    Filled dots are knots, open dots the other collocation points. If there are many, long and short ticks at
    the bottom mark them. Every second phase is shaded. A control that jumps at a knot is drawn with both its
    values.

    Parameters
    ----------
    solution : Solution
        Solved or not; the title states the status.

    Returns
    -------
    matplotlib.figure.Figure
        ``figure.savefig("swing.png")`` writes it; a notebook shows it.
    """
    from matplotlib.figure import Figure  # a third of a second to import: only where something is drawn

    traces = [_trace(part) for part in solution.phases]
    variables = list(dict.fromkeys(v for part in solution.phases for v in variables_of(part.phase)))
    systems = all(part.phase.robot is None for part in solution.phases)
    panels, columns = _arrange(variables, systems)
    rows = len(panels) // columns
    colors = _colors(sorted({v.label for v in variables}, key=[v.label for v in variables].index))
    figure = Figure(figsize=(6.2 * max(columns, 1.4), 1.1 + 2.4 * rows), dpi=110, layout="constrained")
    grid = figure.subplots(rows, columns, sharex=True, squeeze=False)
    most = max(Counter((v.quantity, v.unit) for v in variables).values())
    crowded = most * sum(len(trace.part.points) for trace in traces) > CROWD
    for axes, panel in zip(grid.ravel(), panels, strict=True):
        if panel is None:
            axes.set_axis_off()
            continue
        shown = [v for v in variables if (v.quantity, v.unit) == panel]
        _bands(axes, traces)
        _curves(axes, traces, shown, colors, crowded)
        _limits(axes, traces, shown, colors)
        if crowded:
            _marks(axes, traces)
        axes.set_title(_heading(panel, shown if systems else ()), loc="left", fontsize=10)
        axes.margins(x=0.0)
        axes.grid(alpha=0.25, linewidth=0.6)
        if systems and len(shown) > 1:
            axes.legend(*_handles(shown, colors), fontsize=8, loc="best", framealpha=0.8)
    _label_time(grid, panels, columns)
    _legend(figure, [] if systems else variables, colors, crowded)
    figure.suptitle(_title(solution), fontsize=11, color="black" if solution.success else "firebrick")
    return figure


def _trace(part: PhaseSolution) -> _Trace:
    """Evaluate a phase, interval by interval, so that both sides of every knot are there."""
    knots = part.knots
    count = max(3, SAMPLES // max(len(knots) - 1, 1))
    grids = [np.linspace(a, b, count) for a, b in zip(knots[:-1], knots[1:], strict=True)]
    pieces = [values_of(part, grid, k) for k, grid in enumerate(grids)]
    values = {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}
    gaps = np.abs(part.points[:, None] - knots[None, :]).min(axis=1)
    inner = part.points[gaps > 1e-9 * max(part.duration, 1e-9)]
    at_inner = values_of(part, inner)
    return _Trace(part, np.concatenate(grids), values, knots, values_of(part, knots), inner, at_inner)


def _arrange(variables: Sequence[Variable], systems: bool) -> tuple[list[Panel | None], int]:
    """Order the panels in a grid: a row for each quantity where a robot has joints of both kinds."""
    panels = list(dict.fromkeys((v.quantity, v.unit) for v in variables))
    panels.sort(key=lambda panel: QUANTITIES.index(panel[0]) if panel[0] in QUANTITIES else len(QUANTITIES))
    quantities = list(dict.fromkeys(quantity for quantity, _ in panels))
    most = max(sum(q == quantity for q, _ in panels) for quantity in quantities)
    if systems or most == 1:
        columns = 2 if len(panels) > 3 else 1
        return [*panels, *[None] * (-len(panels) % columns)], columns
    columns = min(most, 3)
    arranged: list[Panel | None] = []
    for quantity in quantities:
        # A floating root's quaternion comes after what has a unit, so that columns keep to one.
        row = sorted((panel for panel in panels if panel[0] == quantity), key=lambda panel: not panel[1])
        arranged += [*row, *[None] * (-len(row) % columns)]
    return arranged, columns


def _colors(labels: Sequence[str]) -> dict[str, ColorType]:
    """One colour for each joint or variable, easy to distinguish up to ten."""
    from matplotlib import colormaps

    if len(labels) <= 10:
        palette: list[ColorType] = list(colormaps["tab10"].colors)  # type: ignore[attr-defined]
    else:
        palette = list(colormaps["turbo"](np.linspace(0.03, 0.97, len(labels))))
    return dict(zip(labels, palette, strict=False))


def _bands(axes: Axes, traces: Sequence[_Trace]) -> None:
    """Shade every second phase and name all of them, where there are several."""
    if len(traces) == 1:
        return
    for i, trace in enumerate(traces):
        start, end = trace.part.t0, trace.part.t0 + trace.part.duration
        if i % 2:
            axes.axvspan(start, end, color="0.94", zorder=0, linewidth=0)
        axes.text(
            0.5 * (start + end), 0.98, trace.part.phase.name, transform=axes.get_xaxis_transform(),
            ha="center", va="top", fontsize=7, color=QUIET, clip_on=True,
        )  # fmt: skip


def _curves(
    axes: Axes, traces: Sequence[_Trace], shown: Sequence[Variable], colors: dict[str, ColorType], crowded: bool
) -> None:
    dots = partial(axes.plot, linestyle="none", marker="o", zorder=3)
    for trace in traces:
        for variable in shown:
            if variable.name not in trace.values:
                continue
            color = colors[variable.label]
            axes.plot(trace.times, trace.values[variable.name], color=color, linewidth=1.5, zorder=2)
            if not crowded:
                dots(trace.knots, trace.at_knots[variable.name], color=color, markersize=3.4)
                dots(
                    trace.inner, trace.at_inner[variable.name], color=color, markersize=3.2,
                    markerfacecolor="white", markeredgewidth=0.8,
                )  # fmt: skip


def _limits(axes: Axes, traces: Sequence[_Trace], shown: Sequence[Variable], colors: dict[str, ColorType]) -> None:
    """Draw the limits near the curves, and write the values of the others."""
    ranges = [trace.values[v.name] for trace in traces for v in shown if v.name in trace.values]
    every = np.concatenate(ranges)
    every = every[np.isfinite(every)]
    low, high = (float(every.min()), float(every.max())) if every.size else (0.0, 0.0)
    span = high - low if high - low > 1e-9 * max(1.0, abs(high)) else max(1.0, abs(high))
    drawn: list[float] = []
    away: set[float] = set()
    for trace in traces:
        bounds = trace.part.phase.rows.limits()
        used = [bounds[v.name] for v in shown if v.name in bounds]
        common = len(set(used)) == 1 and len(shown) > 1
        for variable in shown:
            for limit in bounds.get(variable.name, ()):
                if not np.isfinite(limit):
                    continue
                if not low - REACH * span <= limit <= high + REACH * span:
                    away.add(limit)
                    continue
                drawn.append(limit)
                color = QUIET if common else colors[variable.label]
                ends = [trace.part.t0, trace.part.t0 + trace.part.duration]
                axes.plot(ends, [limit, limit], color=color, linestyle=DASHES, linewidth=1.1, zorder=1)
    bottom, top = min([low, *drawn]), max([high, *drawn])
    margin = 0.1 * (top - bottom if top - bottom > 1e-6 * span else span)
    # Names of phases stand above the curves.
    axes.set_ylim(bottom - margin, top + margin * (1.0 if len(traces) == 1 else 1.8))
    if away:
        axes.set_title(f"limits out of view: {_listed(away)}", loc="right", fontsize=7, color=QUIET)


def _listed(limits: Iterable[float]) -> str:
    """Write limits shortly, mirrored pairs as one: ``+-20, 5``."""
    known = sorted(set(limits))
    parts = []
    for limit in known:
        if limit > 0 and -limit in known:
            parts.append(f"\N{PLUS-MINUS SIGN}{limit:.4g}")
        elif not (limit < 0 and -limit in known):
            parts.append(f"{limit:.4g}")
    return ", ".join(parts[:4]) + (" ..." if len(parts) > 4 else "")


def _marks(axes: Axes, traces: Sequence[_Trace]) -> None:
    """Mark knots with long and collocation points with short ticks along the bottom."""
    ticks = partial(axes.plot, transform=axes.get_xaxis_transform(), linestyle="none", marker="|")
    for trace in traces:
        ticks(trace.inner, np.full(len(trace.inner), 0.008), color="0.6", markersize=4)
        ticks(trace.knots, np.full(len(trace.knots), 0.02), color="0.25", markersize=8)


def _label_time(grid: NDArray[np.object_], panels: Sequence[Panel | None], columns: int) -> None:
    """Write times under the lowest panel of each column."""
    for column in range(columns):
        lowest = max(i for i in range(column, len(panels), columns) if panels[i] is not None)
        axes = grid.ravel()[lowest]
        axes.set_xlabel("t [s]", fontsize=9)
        axes.tick_params(labelbottom=True)


def _handles(shown: Sequence[Variable], colors: dict[str, ColorType]) -> tuple[list[Artist], list[str]]:
    from matplotlib.lines import Line2D

    labels = list(dict.fromkeys(v.label for v in shown))
    return [Line2D([], [], color=colors[label], linewidth=1.8) for label in labels], labels


def _legend(figure: Figure, variables: Sequence[Variable], colors: dict[str, ColorType], crowded: bool) -> None:
    """Explain colours, where panels do not, and marks, below all panels."""
    from matplotlib.lines import Line2D

    handles, labels = _handles(variables, colors)
    tick = "|" if crowded else "o"
    handles += [
        Line2D([], [], color=QUIET, linestyle=DASHES, linewidth=1.1),
        Line2D([], [], color="0.25", marker=tick, linestyle="none", markersize=8 if crowded else 4),
        Line2D([], [], color="0.5", marker=tick, linestyle="none", markersize=4, markerfacecolor="white"),
    ]
    labels += ["limit", "knot", "collocation point"]
    figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 6), fontsize=8, frameon=False)


def _heading(panel: Panel, shown: Sequence[Variable]) -> str:
    """Quantity and unit; with the variable's name where it is alone and has no legend."""
    quantity, unit = panel if panel != QUATERNION else ("quaternion", "")
    named = f"{quantity} {shown[0].label}" if len(shown) == 1 else quantity
    return f"{named} [{unit.replace('^2', chr(0xB2))}]" if unit else named


def _title(solution: Planned) -> str:
    first = solution.phases[0].phase
    names = list(dict.fromkeys(part.phase.name for part in solution.phases))
    named = f"{first.subject.name}: {names[0]}" if len(names) == 1 else f"{first.subject.name}, {len(names)} phases"
    state = "" if solution.success else f"{solution.status.value.upper()} \N{EM DASH} "
    return f"{state}{named}, objective {solution.objective:.6g}, duration {solution.duration:.4g} s"
