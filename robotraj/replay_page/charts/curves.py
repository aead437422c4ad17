"""The curves beside the 3D view: position, velocity, torque and contact force of a robot, or a system's variables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field, replace
from typing import Any, TypedDict, cast

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.mobility import AXES
from robotraj.dynamics.system import System
from robotraj.dynamics.terrain.function import as_ground
from robotraj.dynamics.variable import Variable
from robotraj.replay_page.charts.nearest import NearestObstacle, nearest_obstacle
from robotraj.replay_page.charts.own_curves import NO_CURVES, OwnCurves, heading
from robotraj.replay_page.footholds import footholds
from robotraj.robot.robot import Robot
from robotraj.solution.cycles.gait_cycles import CyclePhase, CycleSample, GaitCycles
from robotraj.solution.sample import Sample

SAME = {"rad": "rad", "m": "m", "": ""}
RATE = {"rad": "rad/s", "m": "m/s"}
EFFORT = {"rad": "N m", "m": "N"}
SAMPLES = 900
"""Approximate number of samples per phase. Each of its intervals has at least 3, ends included."""
NEAREST = "distance.obstacles"
"""Name of the distance to the nearest obstacle among the variables of a page."""
ALL_SAMPLES = 3600
"""Approximate number of samples in all phases of all periods."""


@dataclass(frozen=True)
class Series(OneLine):
    """One curve: its label, unit and name among the variables (``q.elbow``)."""

    label: str
    unit: str
    variable: str


def _no_values(sample: Sample[Any] | CycleSample) -> Array:
    return np.empty((np.size(sample.t), 0))


@dataclass(frozen=True)
class Panel(OneLine):
    """One chart: its title, the heading of its column of values, its curves, and whether they are states."""

    title: str
    symbol: str
    series: tuple[Series, ...]
    read: Callable[[Sample[Any] | CycleSample], Array] = field(default=_no_values, repr=False)
    """Map a sample at m times to values (m, number of series)."""
    continuous: bool = False


def robot_panels(robot: Robot) -> list[Panel]:
    """Return the position and velocity charts of a robot's joints, and the torque chart of the actuated ones."""

    def series(prefix: str, names: Sequence[str], units: Sequence[str], unit: dict[str, str]) -> tuple[Series, ...]:
        return tuple(Series(n, unit[u], f"{prefix}.{n}") for n, u in zip(names, units, strict=True))

    panels = [
        Panel(
            "Joint position",
            "q",
            series("q", robot.position_names, robot.position_units, SAME),
            lambda s: _rows(s.q),
            continuous=True,
        ),
        Panel(
            "Joint velocity",
            "v",
            series("v", robot.velocity_names, robot.units, RATE),
            lambda s: _rows(s.v),
            continuous=True,
        ),
    ]
    if len(robot.actuated):
        units = dict(zip(robot.velocity_names, robot.units, strict=True))
        kinds = [units[joint] for joint in robot.actuated]
        title = {frozenset({"m"}): "Actuator force", frozenset({"rad"}): "Joint torque"}.get(frozenset(kinds), "Effort")
        panels.append(Panel(title, "τ", series("tau", robot.actuated, kinds, EFFORT), lambda s: _rows(s.tau)))
    return panels


def contact_panel(cycle_phase: CyclePhase) -> list[Panel]:
    """Return the chart of the normal forces of contacts with the ground; empty without contacts."""
    holds = footholds(cycle_phase)
    if not holds:
        return []
    # On level ground a bound on the normal force is a bound on the variable along z, on a wall on that along its axis.
    normals = (AXES[as_ground(hold.contact.contact.ground).axis] for hold in holds)
    series = tuple(
        Series(hold.name, "N", f"force.{hold.contact.name}.{axis}") for hold, axis in zip(holds, normals, strict=True)
    )

    def read(sample: Sample[Any] | CycleSample) -> Array:
        return np.column_stack([hold.normal_force(sample) for hold in holds])

    return [Panel("Normal force of contacts", "fₙ", series, read)]


def obstacle_panel(nearest: NearestObstacle | None) -> list[Panel]:
    """Return the chart of the distance to the nearest obstacle; empty without obstacles."""
    series = (Series("nearest obstacle", "m", NEAREST),)
    return [] if nearest is None else [Panel("Distance to obstacles", "d", series, nearest.distances)]


def system_panels(system: System) -> list[Panel]:
    """Return the charts of the states, controls and algebraic variables of an ``rt.System``."""

    def panel(title: str, head: str, symbol: str, group: Sequence[Variable]) -> Panel:
        names = [variable.name for variable in group]

        def read(sample: Sample[Any] | CycleSample) -> Array:
            values = getattr(sample, symbol)
            return np.column_stack([np.asarray(values[name], dtype=float).ravel() for name in names])

        return Panel(title, head, tuple(Series(v.name, v.unit, v.name) for v in group), read, continuous=symbol == "x")

    groups = (
        # The columns of the legend carry words, since x and u are also names of variables.
        ("States", "state", "x", system.states),
        ("Controls", "control", "u", system.controls),
        ("Algebraic variables", "algebraic", "z", system.algebraic),
    )
    return [panel(title, head, symbol, group) for title, head, symbol, group in groups if len(group)]


class ChartData(TypedDict):
    """A chart as JSON; see ``curves``."""

    title: str
    symbol: str
    continuous: bool
    series: list[dict[str, str]]
    pieces: list[dict[str, object]]


def curves(cycles: GaitCycles, own: OwnCurves = NO_CURVES) -> list[ChartData]:
    """Sample every chart of a solution, ready for JSON; the caller's own charts come last.

    Each interval is evaluated with its polynomial, so a jump at a knot is visible. Limits are the tightest bounds
    of the phase's rows that bound one variable throughout.

    Returns
    -------
    list of ChartData
        ``title``, ``symbol``, ``continuous``, ``series`` (label, unit, variable) and ``pieces``, one for each phase:
        ``t`` (m,) [s], ``of`` (indices of its series), ``y`` (series by m), ``lower`` and ``upper`` (None where open).
    """
    drawn: dict[str, ChartData] = {}
    known: dict[str, None] = {}
    number = len(cycles.phases)
    for cycle_phase in cycles.phases:
        phase = cycle_phase.phase
        if phase.robot is not None:
            nearest = nearest_obstacle(cycle_phase)
            panels = robot_panels(phase.robot) + contact_panel(cycle_phase) + obstacle_panel(nearest)
        else:
            nearest = None
            panels = system_panels(cast(System, phase.system))
        limits = _limits(cycle_phase)
        if nearest is not None:
            limits[NEAREST] = (nearest.margin, np.inf)
        grids = _grids(cycle_phase, min(SAMPLES, ALL_SAMPLES / number))
        times, samples = np.concatenate(grids), [cycle_phase.at(grid, interval=k) for k, grid in enumerate(grids)]
        shown = [(panel, np.concatenate([panel.read(sample) for sample in samples])) for panel in panels]
        known |= dict.fromkeys(series.variable for panel in panels for series in panel.series)
        shown = [_with_measured(panel, values, own, times) for panel, values in shown]
        for title in own.expressions:
            values = own.values(title, cycle_phase, grids)
            name, unit, names = heading(title, values.shape[1])
            shown.append((Panel(name, name, tuple(Series(label, unit, "") for label in names)), values))
        for panel, values in shown:
            labels = [{"label": s.label, "unit": s.unit, "variable": s.variable} for s in panel.series]
            empty: ChartData = {
                "title": panel.title,
                "symbol": panel.symbol,
                "continuous": panel.continuous,
                "series": [],
                "pieces": [],
            }
            chart = drawn.setdefault(panel.title, empty)
            chart["series"] += [label for label in labels if label not in chart["series"]]
            bounds = [limits.get(s.variable, (-np.inf, np.inf)) for s in panel.series]
            chart["pieces"].append(
                {
                    "t": _rounded(times, 9),
                    "of": [chart["series"].index(label) for label in labels],
                    "y": [_rounded(column, 6) for column in values.T],
                    "lower": [low if np.isfinite(low) else None for low, _ in bounds],
                    "upper": [high if np.isfinite(high) else None for _, high in bounds],
                }
            )
    own.check_variables(list(known))
    return list(drawn.values())


def _grids(cycle_phase: CyclePhase, wanted: float) -> list[Array]:
    """Return the times of each interval, both ends included, so that every knot has a left and a right value."""
    knots = cycle_phase.knots
    count = max(3, int(np.ceil(wanted / max(len(knots) - 1, 1))) + 1)
    return [np.linspace(a, b, count) for a, b in zip(knots[:-1], knots[1:], strict=True)]


def _with_measured(panel: Panel, values: Array, own: OwnCurves, times: Array) -> tuple[Panel, Array]:
    """Add the measured curves of a chart's variables to it and to its values."""
    known = [series for series in panel.series if series.variable in own.measured]
    added = tuple(replace(series, label=f"{series.label}, measured", variable="") for series in known)
    columns = [own.measured_at(series.variable, times) for series in known]
    return replace(panel, series=(*panel.series, *added)), np.column_stack([values, *columns])


def _limits(cycle_phase: CyclePhase) -> dict[str, tuple[float, float]]:
    """Return bounds by variable name, from the rows that hold throughout the phase, mapped to the period."""
    limits: dict[str, tuple[float, float]] = dict(cycle_phase.phase.rows.limits())
    robot = cycle_phase.phase.robot
    if cycle_phase.period == 0 or robot is None:
        return limits
    moved = {name: pair for name, pair in limits.items() if name.startswith("force.")}
    groups = (("q", robot.position_names), ("v", robot.velocity_names), ("tau", robot.actuated))
    for quantity, joints in groups:
        names = [f"{quantity}.{joint}" for joint in joints]
        lower, upper = np.array([limits.get(name, (-np.inf, np.inf)) for name in names]).reshape(-1, 2).T
        moved |= dict(zip(names, zip(*cycle_phase.bounds(quantity, lower, upper), strict=True), strict=True))
    return moved


def _rows(values: Array | None) -> Array:
    return np.atleast_2d(np.asarray(values, dtype=float))


def _rounded(values: Array, digits: int) -> list[float | None]:
    """Round to significant digits; a value that is not finite becomes None, since JSON has no NaN."""
    return [float(f"{value:.{digits}g}") if np.isfinite(value) else None for value in values]
