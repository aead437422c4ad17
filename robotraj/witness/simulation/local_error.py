"""The local error of a plan: short parts of it are simulated one by one, each from its planned state.

A small error of an unstable motion grows without bound in an open-loop simulation, but not over a short window. The
local error therefore decides whether the plan is a motion of the robot. It does not depend on the mesh: intervals
longer than a window are simulated in equal parts, and shorter ones are joined.

Simulation and plan of a System are also compared at every knot and once inside every interval, where no window ends.
Inside the windows of robots inverse dynamics are compared (``checks.torques``): the speed of a light joint with damping
may differ for a moment there, and moves nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj.dynamics.design.binding import realised
from robotraj.robot.size.state_sizes import WINDOWS, error_window
from robotraj.witness.plants.of_phase import plant_of
from robotraj.witness.plants.plant import Plant
from robotraj.witness.plants.robot_plant import RobotPlant
from robotraj.witness.plants.sizes import sizes_of
from robotraj.witness.protocols import SolutionLike
from robotraj.witness.simulation.drift import Drift, DriftRow, merge
from robotraj.witness.simulation.mirror_image import MIRRORED, mirror_image, mirror_of
from robotraj.witness.simulation.open_loop import handed_on
from robotraj.witness.simulation.short_events import cut_at_events
from robotraj.witness.simulation.spans import Span, Stopped
from robotraj.witness.simulation.steps import Stepper

INSIDE = 0.382
"""Share of an interval of a System at which it is cut in two: no node of a collocation scheme."""


def windows_of(knots: Array, longest: float, inside: bool = False) -> list[list[Span]]:
    """Cut a phase into windows no longer than ``longest`` [s], each a list of spans without a knot inside.

    An interval that would be one span becomes two where it is also compared ``inside``.
    """
    windows: list[list[Span]] = []
    current: list[Span] = []
    for k, (begin, end) in enumerate(zip(knots[:-1], knots[1:], strict=True)):
        if end <= begin:
            continue
        # Round-off does not cut an interval of exactly this length in two.
        count = max(1, int(np.ceil((end - begin) / longest * (1.0 - 1e-9))))
        if current and (count > 1 or end - current[0].begin > longest * (1.0 + 1e-9)):
            windows.append(current)
            current = []
        cuts = np.linspace(begin, end, count + 1)
        if inside and count == 1:
            cuts = np.array([begin, begin + INSIDE * (end - begin), end])
        spans = [Span(float(a), float(b), k) for a, b in zip(cuts[:-1], cuts[1:], strict=True)]
        if count > 1:
            windows += [[span] for span in spans]
        else:
            current += spans
    return [*windows, current] if current else windows


def local_errors(solution: SolutionLike, rtol: float, atol: float, clock: Callable[[], None]) -> Drift:
    """Return the local errors of all phases, and of their mirror images where half a gait is planned."""
    mirror = mirror_of(solution)
    before: tuple[Plant, Array, Array] | None = None
    whole = sum(float(planned.knots[-1] - planned.knots[0]) for planned in solution.phases)
    found = []
    sizes = sizes_of(solution)
    for i, planned in enumerate(solution.phases):
        robot, longest = planned.phase.robot, whole / WINDOWS
        if robot is not None:
            # Between one and two windows of the proof.
            window = error_window(robot)
            longest = float(np.clip(longest, window, 2.0 * window))
        knots = np.asarray(planned.knots, dtype=float)
        plant, phase = plant_of(planned), planned.phase.name
        own, end = plant.states(knots[:1], 0)[0], plant.states(knots[-1:], len(knots) - 2)[0]
        if before is not None:
            handed = handed_on(solution, i, plant, own, before)
            found.append(_seam(plant, handed, own, sizes[i], float(knots[0]), phase))
        windows = cut_at_events(planned, windows_of(knots, longest, robot is None), plant.names, sizes[i])
        found.append(local_error_of(plant, windows, phase, sizes[i], rtol, atol, clock, robot is None))
        image = None if mirror is None else mirror_image(realised(planned), mirror)
        if image is not None:
            half = RobotPlant(planned, robot=image)
            found.append(local_error_of(half, windows, phase + MIRRORED, sizes[i], rtol, atol, clock))
        before = plant, end, end
    return merge(found)


def local_error_of(
    plant: Plant,
    windows: Sequence[Sequence[Span]],
    phase: str,
    sizes: Array,
    rtol: float,
    atol: float,
    clock: Callable[[], None],
    inside: bool = False,
) -> tuple[DriftRow, ...]:
    """Simulate the windows of a phase and compare each with the plan at its end, and ``inside`` at the ends of spans.

    Returns
    -------
    tuple of DriftRow
        By state: largest |simulated - planned| at the end of any window, or jump of the plan there. Its scale is the
        size of the state in the plan. Infinite where a simulation stopped.
    """
    begins = _ends(plant, windows, 0)
    stepper = Stepper(plant, [span for window in windows for span in window], plant.spread(sizes), rtol, atol, clock)
    times, states, intervals = [], [], []
    for x, window in zip(begins, windows, strict=True):
        clock()
        for span in window:
            try:
                at, found = stepper.through(x, span)
            except Stopped:
                at, found = np.array([window[-1].end]), np.full((1, len(x)), np.nan)
            x = found[-1]
            stopped = not np.isfinite(x).all()
            if inside or stopped or span is window[-1]:
                # The plan may jump at the begin of a span, too.
                seen = [0, -1] if inside and span is not window[0] else [-1]
                times.append(at[seen])
                states.append(found[seen])
                intervals.append(np.full(len(seen), span.interval))
            if stopped:
                break
    compared = np.concatenate(times)
    planned = plant.states(compared, np.concatenate(intervals))
    gaps = np.nan_to_num(np.abs(plant.gaps(np.concatenate(states), planned)), nan=np.inf)
    if len(windows) > 1:
        # A jump of the plan between two windows is an error too.
        jumps = np.abs(plant.gaps(begins[1:], _ends(plant, windows, -1)[:-1]))
        gaps = np.vstack([np.nan_to_num(jumps, nan=np.inf), gaps])
        compared = np.append([window[-1].end for window in windows[:-1]], compared)
    return tuple(
        _row(name, unit, gaps[:, j], float(sizes[j]), compared, phase)
        for j, (name, unit) in enumerate(zip(plant.gap_names, plant.gap_units, strict=True))
    )


def _seam(plant: Plant, handed: Array, own: Array, sizes: Array, time: float, phase: str) -> tuple[DriftRow, ...]:
    """Compare the first state of a phase with the last state of the phase before, impact included."""
    x, _ = plant.begin(handed)
    gaps = np.nan_to_num(np.abs(plant.gaps(x[None], own[None])), nan=np.inf)
    return tuple(
        _row(name, unit, gaps[:, j], float(sizes[j]), np.array([time]), phase)
        for j, (name, unit) in enumerate(zip(plant.gap_names, plant.gap_units, strict=True))
    )


def _ends(plant: Plant, windows: Sequence[Sequence[Span]], side: int) -> Array:
    """Return the planned states (m, n) at the beginnings (0) or ends (-1) of windows."""
    spans = [window[side] for window in windows]
    times = np.array([span.begin if side == 0 else span.end for span in spans])
    return plant.states(times, np.array([span.interval for span in spans]))


def _row(name: str, unit: str, gaps: Array, size: float, times: Array, phase: str) -> DriftRow:
    worst = int(np.argmax(gaps))
    return DriftRow(name, unit, float(gaps[-1]), float(gaps[worst]), float(times[worst]), phase, size)
