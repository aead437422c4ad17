"""``rt.plan(..., watch=True)``: the iterate on its way to the solution, with its residuals, in a browser."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.precision import ROUND_OFF
from robotraj.problem.problem import Problem
from robotraj.replay_page.colors import palette
from robotraj.replay_page.live.live_window import BrowserWindow, Event, LiveWindow
from robotraj.replay_page.page import live_page
from robotraj.replay_page.verdict import verdict
from robotraj.robot.robot import Robot
from robotraj.robot.tangent import normalised
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution
from robotraj.solvers.base import Iteration, Origin, Progress
from robotraj.transcription.extract import PhaseTrajectory, extract

if TYPE_CHECKING:
    from robotraj.replay_page.live.live_scene import LiveScene

SAMPLES = 40
"""Samples of an iterate's motion."""
FIRST = 60
"""Iterates that are shown whatever they cost; later ones take at most ``SHARE`` of the time."""
SHARE = 0.2


class LivePlan:
    """A progress callback that shows iterates in a window.

    Parameters
    ----------
    problem : Problem
    window : LiveWindow
    show : callable, optional
        A further callback.
    """

    def __init__(self, problem: Problem, window: LiveWindow, show: Progress | None) -> None:
        self._problem, self._window, self._show = problem, window, show
        self._robot = _one_robot(problem)
        self._scene: LiveScene | None = None
        self._opened = False
        self._solves = self._intervals = self._sent = 0
        self._pause_until = 0.0

    def __call__(self, iteration: Iteration) -> None:
        """Pass on the numbers of an iteration, and its motion unless that would slow down the plan."""
        if self._show is not None:
            self._show(iteration)
        began = time.perf_counter()
        if iteration.number == 0 or not self._opened:
            self._solves += 1
        event = {
            "kind": "iterate",
            "solve": self._solves,
            "number": iteration.number,
            "objective": _number(iteration.objective),
            "infeasibility": _number(iteration.infeasibility),
        }
        wanted = self._sent < FIRST or began > self._pause_until or iteration.number == 0
        if iteration.read is not None and wanted:
            event |= self._motion(iteration.read())
            now = time.perf_counter()
            self._pause_until = now + (now - began) * (1.0 / SHARE - 1.0)
            self._sent += 1
        if self._opened:
            self._window.send(event)

    def end(self, solution: Solution) -> None:
        """Show the solution and the verdict on it."""
        if not self._opened:
            return
        last: Event = {"solve": self._solves, "intervals": self._intervals, "number": solution.iterations}
        last |= {"kind": "iterate", "objective": _number(solution.objective), "infeasibility": None}
        if self._robot is None:
            self._window.send(last | self._curves([part.trajectory for part in solution.phases]))
        else:
            times = np.linspace(0.0, solution.duration, SAMPLES) + solution.phases[0].t0
            q = np.array([solution.at(t).q for t in times], dtype=float)
            self._window.send(last | self._poses(q, solution.duration))
        judged = verdict(solution)
        self._window.send({"kind": "end", "text": judged.text, "colour": judged.colour, "message": solution.message})

    def close(self) -> None:
        """No iterate follows."""
        if self._opened:
            self._window.close()

    def _motion(self, origin: Origin) -> Event:
        """Describe the motion of an iterate; the first one opens the window."""
        nlp = origin.nlp
        trajectories = extract(nlp, origin.w)
        self._intervals = sum(len(part.x.breaks) - 1 for part in trajectories)
        start, end = trajectories[0].t0, trajectories[-1].t0 + trajectories[-1].duration
        q = np.empty((0, 0))
        if self._robot is not None:
            # A phase has at least three samples, and in all there are about SAMPLES.
            parts = []
            for phase, layout, part in zip(self._problem.phases, nlp.layouts, trajectories, strict=True):
                count = max(3, round(SAMPLES * part.duration / max(end - start, ROUND_OFF)))
                curve = PhaseSolution(phase, layout.mesh, part).joint_states
                states = curve(np.linspace(part.t0, part.t0 + part.duration, count))[:, : self._robot.nq]
                parts.append(normalised(self._robot.model, states))
            q = np.concatenate(parts)
        if not self._opened:
            self._open(q)
        seen = self._curves(trajectories) if self._robot is None else self._poses(q, end - start)
        return {"intervals": self._intervals, "duration": end - start} | seen

    def _curves(self, parts: Sequence[PhaseTrajectory]) -> Event:
        """Return the curves of a System; its page has no robot."""
        return {"charts": iterate_charts(self._problem, parts, SAMPLES)}

    def _poses(self, q: Array, duration: float) -> Event:
        if self._scene is None or not np.all(np.isfinite(q)):
            return {}
        return {"poses": self._scene.poses(q), "samples": len(q), "duration": duration}

    def _open(self, q: Array) -> None:
        self._opened = True
        names = " → ".join(phase.name for phase in self._problem.phases[:6])
        if self._robot is None:
            system = self._problem.phases[0].system
            title = system.name if system is not None else "problem"
            self._window.open(live_page(title, names, {"scene": None, "palette": palette()}, None))
            return
        from robotraj.replay_page.live.live_scene import LiveScene

        feet = dict.fromkeys(contact.frame for phase in self._problem.phases for contact in phase.bound_contacts)
        self._scene = LiveScene(self._robot, [name for name in feet if name in self._robot.frame_names])
        description: dict[str, object] = {"scene": self._scene.description(q)}
        self._window.open(live_page(self._robot.name, names, description, self._scene.commands()))


@contextmanager
def live_plan(problem: Problem, watch: bool | LiveWindow, show: Progress | None) -> Iterator[LivePlan]:
    """Yield the callback of a plan that is watched; its window is closed at the end.

    Raises
    ------
    InputError
        ``watch`` is neither True nor a window.
    """
    window = BrowserWindow() if watch is True else watch
    named = all(callable(getattr(window, name, None)) for name in ("open", "send", "close"))
    if isinstance(window, bool | type) or not named:
        raise InputError(f"rt.plan(watch=) is True, False or a window with open, send and close; got {watch!r}.")
    live = LivePlan(problem, window, show)
    try:
        yield live
    finally:
        live.close()


def _one_robot(problem: Problem) -> Robot | None:
    return problem.phases[0].robot


def _number(value: float) -> float | None:
    """Return None for a value that is not finite, which JSON cannot hold."""
    return float(value) if np.isfinite(value) else None


def iterate_charts(problem: Problem, parts: Sequence[PhaseTrajectory], samples: int) -> list[dict[str, object]]:
    """Sample states, controls and algebraic variables.

    Parameters
    ----------
    problem : Problem
    parts : sequence of PhaseTrajectory
        The polynomials of every phase.
    samples : int
        Samples of each phase.

    Returns
    -------
    list of dict
        One for each chart that has curves: ``title`` and ``curves``, one for each phase and variable: ``label``,
        ``unit``, ``t`` [s] and ``y``. Values that are not finite are None.
    """
    charts: list[dict[str, object]] = []
    for title, group, name in (
        ("States", "states", "x"),
        ("Controls", "controls", "u"),
        ("Algebraic variables", "algebraic", "z"),
    ):
        curves: list[dict[str, object]] = []
        for phase, part in zip(problem.phases, parts, strict=True):
            variables = getattr(phase.dae, group)
            if not variables:
                continue
            times = np.linspace(part.t0, part.t0 + part.duration, samples)
            values = np.asarray(getattr(part, name)(times), dtype=float).reshape(samples, -1)
            curves += [
                {"label": variable.name, "unit": variable.unit, "t": _numbers(times), "y": _numbers(column)}
                for variable, column in zip(variables, values.T, strict=False)
            ]
        if curves:
            charts.append({"title": title, "curves": curves})
    return charts


def _numbers(values: Array) -> list[float | None]:
    return [float(f"{value:.5g}") if np.isfinite(value) else None for value in values]
