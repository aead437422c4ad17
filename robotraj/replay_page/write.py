"""``replay``: write one or several solutions as one standalone HTML file."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import cast

import numpy as np

from robotraj._util.errors import InputError, require_solution
from robotraj._util.paths import output_path
from robotraj._util.system.interrupts import heeded
from robotraj._util.system.whole_files import WholeFile
from robotraj.dynamics.design.binding import realised
from robotraj.problem.phase import Phase
from robotraj.replay_page.charts.own_curves import NO_CURVES, Expressions, Measured, OwnCurves
from robotraj.replay_page.colors import palette
from robotraj.replay_page.gait_words import gait_words
from robotraj.replay_page.options import check_options
from robotraj.replay_page.page import Heading, page
from robotraj.replay_page.run import run_data
from robotraj.replay_page.verdict import Validation, Verdict, verdict
from robotraj.robot.robot import Robot
from robotraj.solution.cycles.gait_cycles import GaitCycles, gait_cycles
from robotraj.solution.solution import Solution

MOST = 4
"""Largest number of solutions on one page."""
SAME_PLACE = 1e-6
"""Largest difference [m] between dimensions of two phases' robots that count as equal.

The solver's tolerance allows such a difference.
"""

SAME_DURATION = 1e-9
"""Largest relative difference of the durations of a plan and of its report."""


@heeded
def replay(
    solution: Solution | Sequence[Solution],
    path: str | os.PathLike[str],
    *,
    speed: float = 1.0,
    fps: int = 30,
    traces: Sequence[str] | str | None = None,
    periods: int = 1,
    title: str | None = None,
    labels: Sequence[str] | None = None,
    report: Validation | Sequence[Validation | None] | None = None,
    curves: Expressions | None = None,
    measured: Measured | None = None,
) -> Path:
    """Write a page that shows the robot in motion beside its position, velocity and torque curves.

    The file contains meshcat's viewer, meshes, motion and curves, and needs no network. Writing it starts no server,
    process or browser. Phases follow one another on one time line. ``docs/how-to/replay.md`` describes the page.

    In the browser's console, ``robotraj.seek(t)`` moves to a time [s], and ``robotraj.time()`` returns it.
    ``robotraj.poses(k)`` returns the world position [m] and quaternion (x, y, z, w) of every joint of solution k = 1, 2
    ... as drawn. ``robotraj.viewer`` is meshcat's viewer.

    Forces of held contacts are arrows, whose scale the page shows. The page also shows friction cones at the
    footholds, impulses of impacts and the height that ``GroundClearance`` requires. Bars show which phase runs and
    which contacts are held. A periodic gait can be shown over several periods. Each is displaced from the one before,
    and mirrored if the plan is half a gait.

    Several solutions are compared on one page: the others as ghosts in the first one, or side by side.

    The page of an ``rt.System`` has the curves only, since there is no robot.

    Parameters
    ----------
    solution : Solution or sequence of Solution
        A solution, successful or not, or up to four; the page shows the verdict.
    path : path
        Ends in ``.html``; its directory must exist. An older file is replaced.
    speed : float
        Initial playback speed; 1 is real time.
    fps : int
        Animation keys per second of motion, 1 to 240. Where the motion is curved, up to eight times as many are kept.
        Between keys, joints then stay within about 1e-5 rad and m of the solution.
    traces : sequence of str, optional
        Frames whose path is drawn. The default is the frames of the contacts; without contacts, the tip of the longest
        chain. ``()`` draws none.
    periods : int
        Number of periods. More than one requires ``rt.Periodic``, ``rt.Mirror`` or ``rt.Touchdown(repeat=...)`` from
        the last phase to the first.
    title : str, optional
        Heading of the page; the robot's or system's name by default.
    labels : sequence of str, optional
        One name for each solution; their numbers and objectives by default.
    report : Report or sequence of Report, optional
        What ``rt.validate`` returned for the solution, or for each. The page shows its text and its verdict: a plan on
        a given mesh, of which nothing was proved, is validated if its report passed.
    curves : mapping, optional
        Charts of your own: functions of a ``Point``, as objectives take them, by title. The title may end with a unit:
        ``{"tool speed [m/s]": lambda point: casadi.norm_2(point.frame("tool0").velocity[:3])}``. Three values are named
        x, y and z. Later periods of a gait repeat the values of the first one.
    measured : mapping, optional
        Measured values, drawn over the plan: times (m,) [s] and values (m,) by the name of the curve, ``"q.elbow"``,
        ``"v.elbow"``, ``"tau.elbow"`` or the name of a system's variable.

    Returns
    -------
    pathlib.Path
        The absolute path of the file.

    Raises
    ------
    InputError
        A suffix other than ``.html``, a missing directory, or a speed or fps out of range. No solution or more than
        four, or labels or reports of another number. A report of a plan of another duration. Phases that move
        different robots, ``traces`` for a system, or several periods of a plan that is not periodic. Curves that are no
        functions, or measured values of no curve. An unknown frame raises UnknownName.
    """
    solutions = _checked(solution, labels)
    target = output_path(path, (".html", ".htm"), "the page of replay (its menu Save makes videos, GIFs and pictures)")
    for each in solutions:
        check_options(_one_robot(each), speed=speed, fps=fps, traces=traces, title=title)
    reports = _reports(solutions, report)
    own = OwnCurves.of(curves, measured)
    text = page_of(solutions, float(speed), int(fps), traces, periods, title, labels, reports, own)
    with WholeFile(target) as file:
        # Names from file names that are no UTF-8 hold letters which UTF-8 cannot encode.
        file.write_text(text, encoding="utf-8", errors="backslashreplace")
    return target


def page_of(
    solutions: Sequence[Solution],
    speed: float = 1.0,
    fps: int = 30,
    traces: Sequence[str] | str | None = None,
    periods: int = 1,
    title: str | None = None,
    labels: Sequence[str] | None = None,
    reports: Sequence[Validation | None] | None = None,
    own: OwnCurves = NO_CURVES,
) -> str:
    """Return the text of the page; parameters and errors are those of ``replay``."""
    reports = reports or [None] * len(solutions)
    robots = [_one_robot(solution) for solution in solutions]
    names = [traces] if isinstance(traces, str) else traces
    cycles = [gait_cycles(solution, periods) for solution in solutions]
    scenes: list[dict[str, object] | None] = [None] * len(robots)
    commands: bytes | None = None
    if any(robot is not None for robot in robots):
        # This import is deferred, since meshcat and trimesh take a second to import.
        from robotraj.replay_page.scene.scene import scenes_of

        scenes, commands = scenes_of(robots, cycles, fps, names)
    labels = labels or [_label(cycle, k) for k, cycle in enumerate(cycles)]
    runs = [
        run_data(robot, cycle, scene, labels[k], k, reports[k], own)
        for k, (robot, cycle, scene) in enumerate(zip(robots, cycles, scenes, strict=True))
    ]
    heading = _heading(cycles, verdict(solutions[0], reports[0]), labels, title)
    return page(heading, {"speed": speed, "palette": palette(), "runs": runs}, commands)


def _checked(solution: Solution | Sequence[Solution], labels: Sequence[str] | None) -> list[Solution]:
    """Return the solutions as a list."""
    solutions = list(solution) if isinstance(solution, list | tuple) else [cast("Solution", solution)]
    for each in solutions:
        require_solution(each, "rt.replay")
    if not 1 <= len(solutions) <= MOST:
        raise InputError(f"replay shows 1 to {MOST} solutions; got {len(solutions)}.")
    if labels is not None and (isinstance(labels, str) or len(labels) != len(solutions)):
        raise InputError(f"replay: labels= has one name for each of the {len(solutions)} solutions; got {labels!r}.")
    return solutions


def _reports(
    solutions: Sequence[Solution], report: Validation | Sequence[Validation | None] | None
) -> list[Validation | None]:
    """Return one report or None for each solution."""
    if report is None:
        return [None] * len(solutions)
    reports = list(report) if isinstance(report, list | tuple) else [cast("Validation", report)]
    if len(reports) != len(solutions):
        raise InputError(
            f"replay: report= has one report for each of the {len(solutions)} solutions; got {len(reports)}."
        )
    for solution, each in zip(solutions, reports, strict=True):
        if each is None:
            continue
        if not hasattr(each, "passed"):
            raise InputError(f"replay: report= takes what rt.validate returned; got {each!r}.")
        if not np.isclose(each.duration, solution.duration, rtol=SAME_DURATION):
            raise InputError(
                f"replay: the report is of a plan of {each.duration:.6g} s, but the solution takes "
                f"{solution.duration:.6g} s; validate this solution."
            )
    return reports


def _one_robot(solution: Solution) -> Robot | None:
    """Return the robot of all phases, in the dimensions of its design, or None if all are systems."""
    robots = [None if result.phase.robot is None else realised(result) for result in solution.phases]
    if not robots:
        raise InputError("replay: the solution has no phase, so there is nothing to show.")
    first = robots[0]
    for result, robot in zip(solution.phases, robots, strict=True):
        if robot is first or (robot is not None and first is not None and _looks_like(robot, first)):
            continue
        raise InputError(
            f"replay shows one robot, but phase {result.phase.name!r} moves {_name(result.phase)!r} and the "
            f"first moves {_name(solution.phases[0].phase)!r}; replay them separately."
        )
    return first


def _looks_like(robot: Robot, other: Robot) -> bool:
    """Whether two robots have the same joints and frames in the same places; loads may differ."""
    if robot.joint_names != other.joint_names or robot.frame_names != other.frame_names:
        return False
    pairs = [*zip(robot.model.jointPlacements, other.model.jointPlacements, strict=True)]
    pairs += [(f.placement, g.placement) for f, g in zip(robot.model.frames, other.model.frames, strict=True)]
    same_joints = all(a == b for a, b in zip(robot.model.joints, other.model.joints, strict=True))
    return same_joints and all(a.isApprox(b, SAME_PLACE) for a, b in pairs)


def _name(phase: Phase) -> str:
    moved = phase.robot or phase.system
    assert moved is not None
    return moved.name


def _label(cycles: GaitCycles, number: int) -> str:
    return f"{number + 1}: objective {cycles.solution.objective:.4g}"


def _heading(cycles: Sequence[GaitCycles], judged: Verdict, labels: Sequence[str], title: str | None) -> Heading:
    """Name the first solution, with its verdict, or the number of those that are compared.

    The verdict is that of the solution in focus, which is the first one until the page changes it.
    """
    solution = cycles[0].solution
    first = solution.phases[0].phase
    names = list(dict.fromkeys(_name(own.solution.phases[0].phase) for own in cycles))
    if len(cycles) > 1:
        text = f"{labels[0]}: {judged.text}"
        return Heading(title or " and ".join(names), f"{len(cycles)} solutions", text, judged.colour, ())
    phases = [result.phase.name for result in solution.phases]
    gait = gait_words(cycles[0]) if first.robot is not None else ""
    shown = gait or " → ".join(phases[:6]) + (f" → … ({len(phases)} phases)" if len(phases) > 6 else "")
    facts = [("Duration", f"{solution.duration:.4g} s"), ("Objective", f"{solution.objective:.6g}")]
    if cycles[0].periods > 1:
        facts[0] = ("Duration", f"{cycles[0].periods} × {cycles[0].period:.4g} s")
    facts.append(("Iterations", str(solution.iterations)))
    # The first limit that must give is the largest one.
    facts += [("In conflict", solution.in_phase(conflict)) for conflict in solution.conflicts[:1]]
    heading = title or _name(first)
    subtitle = "" if shown.lower() == heading.lower() else shown
    return Heading(heading, subtitle, judged.text, judged.colour, tuple(facts))
