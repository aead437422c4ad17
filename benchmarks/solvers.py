"""IPOPT and rt.InteriorPoint on every case and on the examples' first problems: `python benchmarks/solvers.py`.

Each problem is planned twice, once with each solver, from the same guess, with the same mesh or tolerance and
`interval_limits=rt.interval_limits.ConstraintGeneration()`; the latter has nothing to fall back on. Prints and writes
solvers.md: which of them solved, which found the better optimum, and their processor seconds. Swing-ups of the acrobot,
whose optima lie close together, are planned on several meshes in several durations as well. Every row is written as
soon as it is known; a run of named problems replaces theirs.
"""

from __future__ import annotations

import argparse
import datetime
import os
import runpy
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast
from unittest import mock

import numpy as np
import pinocchio as pin
from cases import cases
from problems.case import TOLERANCE

import robotraj as rt
from robotraj.solvers.base import Multipliers, Outcome, Progress, Solver

HERE = Path(__file__).resolve().parent
TABLE = HERE / "solvers.md"
EXAMPLES = sorted((HERE.parent / "examples").glob("[0-9]*.py"))
UNIFORM = rt.Mesh(40)
LARGEST = 6000
"""Variables of the largest problem of an example that is tried."""
LIMIT = 60.0
"""Seconds that a solver has for one mesh."""
MANY_OPTIMA = ("cartpole", "acrobot", "cartpole, URDF", "acrobot, URDF")
SMOOTH = ("ur3", "ur5_limited", "ur10_limited", "panda", "kinova")
"""Arms that are moved by rates of torques and by jerks."""
STARTS = 20
DURATIONS, INTERVALS = (1.6, 1.8, 2.0, 2.2, 2.5, 3.0), (25, 30, 40, 50, 60)
"""Of the acrobot's swing-ups."""
EQUAL = 1e-5
"""Objectives that differ by no more than this share are the same optimum."""
OWN = "InteriorPoint"
SOLVERS: dict[str, Solver] = {
    "IPOPT": rt.Ipopt(time_limit=LIMIT),
    OWN: rt.InteriorPoint(time_limit=LIMIT, threads=1, fallback=None),
}


@dataclass(frozen=True)
class Task:
    """A problem for both solvers.

    Attributes
    ----------
    name, kind : str
    problem : Problem or Phase
    options : dict
        Of ``rt.plan``.
    exact : float
        The known optimum; NaN where there is none.
    """

    name: str
    kind: str
    problem: rt.Problem | rt.Phase
    options: dict[str, Any]
    exact: float


@dataclass
class Timed(Solver):
    """A solver whose processor seconds and iterations are added up, set-up included."""

    inner: Solver
    seconds: float = 0.0
    iterations: int = 0

    @property
    def stagewise(self) -> bool:
        """Whether the inner solver works by stages."""
        return self.inner.stagewise

    def solve(
        self, nlp: rt.transcription.Nlp, progress: Progress | None = None, multipliers: Multipliers | None = None
    ) -> Outcome:
        """Solve and count."""
        return self._counted(self.inner.solve, nlp, progress, multipliers)

    def resolve(
        self,
        nlp: rt.transcription.Nlp,
        known: Multipliers,
        progress: Progress | None = None,
        multipliers: Multipliers | None = None,
    ) -> Outcome:
        """Solve again and count."""
        return self._counted(self.inner.resolve, nlp, known, progress, multipliers)

    def _counted(self, solve: Any, *arguments: Any) -> Outcome:
        began = time.process_time()
        try:
            outcome: Outcome = solve(*arguments)
        finally:
            self.seconds += time.process_time() - began
        self.iterations += outcome.iterations
        return outcome


@dataclass(frozen=True)
class Run:
    """Result of one solver for one task; ``objective`` is infinite where it did not solve it."""

    status: str
    objective: float
    iterations: int
    seconds: float


@dataclass(frozen=True)
class Line:
    """A task and both runs."""

    task: Task
    runs: dict[str, Run] = field(default_factory=dict)

    @property
    def better(self) -> str:
        """Solver with the lower optimum, or the only one that solved it: its name, "same" or "none"."""
        ipopt, own = (self.runs[name].objective for name in SOLVERS)
        if not np.isfinite([ipopt, own]).any():
            return "none"
        if abs(ipopt - own) <= EQUAL * (1 + min(abs(ipopt), abs(own))):
            return "same"
        return "IPOPT" if ipopt < own else OWN


class _Planned(Exception):
    """Carries the arguments of the first plan of an example."""

    def __init__(self, problem: rt.Problem | rt.Phase, options: dict[str, Any]) -> None:
        self.problem, self.options = problem, options


def first_plan(example: Path) -> tuple[rt.Problem | rt.Phase, dict[str, Any]] | None:
    """Run an example until it plans and return the arguments; None without ``rt.plan`` or ``rt.multistart``."""

    def plan(problem: Any, mesh: Any = None, guess: Any = None, *_: Any, **options: Any) -> None:
        kept = {k: v for k, v in options.items() if k in ("mesh", "guess", "tolerance", "refinement", "continuation")}
        given = {k: v for k, v in (("mesh", mesh), ("guess", guess)) if v is not None}
        raise _Planned(problem, given | kept)

    def multistart(problem: Any, *_: Any, **options: Any) -> None:
        plan(problem, **options)

    with mock.patch.object(rt, "plan", plan), mock.patch.object(rt, "multistart", multistart):
        try:
            runpy.run_path(str(example), run_name="__main__")
        except _Planned as planned:
            return planned.problem, planned.options
    return None


def kind_of(problem: rt.Problem | rt.Phase) -> str:
    """Say which class of the default's choice a problem belongs to: "fewer controls" than every second state."""
    phases = (problem,) if isinstance(problem, rt.Phase) else problem.phases
    kinds = set()
    for phase in phases:
        robot = phase.robot
        if robot is None:
            few = 2 * len(phase.body.controls) < len(phase.body.states)
            kinds.add(("DAE" if phase.dae.algebraic else "ODE") + (", fewer controls" if few else ""))
        elif phase.contacts or robot.root != "fixed":
            kinds.add("legs")
        else:
            kinds.add("arm" if robot.nu == robot.nv else "robot without all motors")
    return ", ".join(sorted(kinds)) + (f", {len(phases)} phases" if len(phases) > 1 else "")


def held() -> Iterator[Task]:
    """Hold a tool at one height, from joint positions to others or to a point, by effort and by time."""
    robot = rt.load("ur5")
    first, last = np.array([0.3, -1.2, 1.4, -1.7, -1.57, 0.0]), np.array([-0.9, -1.2, 1.4, -1.7, -1.57, 0.0])
    frame, data = robot.model.getFrameId("tool0"), robot.model.createData()
    places = []
    for q in (first, last):
        pin.framesForwardKinematics(robot.model, data, q)
        places.append(data.oMf[frame].translation.copy())
    level = rt.FramePosition("tool0", {"z": places[0][2]})
    start, there = rt.State(q=first, v=0), rt.State(q=last, v=0)
    point = rt.AtEnd(rt.FramePosition("tool0", places[1]))
    posed = {
        "held at a height": rt.Phase(robot, 1.5, start, there, rt.Effort(), [level]),
        "held at a height, minimum time": rt.Phase(robot, (0.3, 4.0), start, there, rt.Duration(), [level]),
        "held at a height, to a point": rt.Phase(robot, 1.5, start, rt.State(v=0), rt.Effort(), [level, point]),
        "to a point": rt.Phase(robot, 1.5, start, rt.State(v=0), rt.Effort(), [point]),
    }
    for name, phase in posed.items():
        yield Task(f"ur5, {name}", "arm, tool held", phase, {"mesh": UNIFORM}, float("nan"))


def smooth() -> Iterator[Task]:
    """Move arms by rates of torques or by jerks, in a given time and in a free one."""
    posed = {
        "torque rates": (False, 1e-3 * rt.Effort() + 1e-4 * rt.objectives.TorqueRate()),
        "jerks": (False, 1e-3 * rt.Effort() + 1e-4 * rt.objectives.Jerk()),
        "time and torque rates": (True, rt.Duration() + 1e-6 * rt.objectives.TorqueRate()),
        "time and jerks": (True, rt.Duration() + 1e-6 * rt.objectives.Jerk()),
    }
    for number, name in enumerate(SMOOTH):
        robot, rng = rt.load(name), np.random.default_rng(number)
        lower = np.maximum(robot.limits.position_lower, -3.0)
        upper = np.minimum(robot.limits.position_upper, 3.0)
        first, last = (0.5 * (lower + upper) + 0.35 * (upper - lower) * rng.uniform(-1, 1, robot.nq) for _ in range(2))
        seconds = max(1.0, 2.0 * float(np.max(np.abs(last - first) / np.minimum(robot.limits.velocity, 10.0))))
        for title, (free, objective) in posed.items():
            duration = (seconds / 3, 3 * seconds) if free else seconds
            phase = rt.Phase(robot, duration, rt.State(q=first, v=0), rt.State(q=last, v=0), objective)
            yield Task(f"{name}, {title}", "arm, rates of torques", phase, {"mesh": UNIFORM}, float("nan"))


def tasks() -> Iterator[Task]:
    """Every case to the tolerance and on a uniform mesh, held tools, smooth motions, first problems of examples."""
    for case in cases():
        kind = kind_of(case.problem)
        adaptive = {"guess": case.guess, "tolerance": TOLERANCE}
        yield Task(case.name, kind, case.problem, adaptive, case.exact)
        yield Task(f"{case.name}, uniform", kind, case.problem, {"guess": case.guess, "mesh": UNIFORM}, case.exact)
    yield from held()
    yield from smooth()
    for example in EXAMPLES:
        planned = first_plan(example)
        if planned is not None:
            problem, options = planned
            posed = rt.Problem([problem]) if isinstance(problem, rt.Phase) else problem
            mesh = options.get("mesh") or rt.Mesh()
            if len(rt.transcription.transcribe(posed, mesh, rt.guess.default_guess(posed)).variables) <= LARGEST:
                yield Task(f"example {example.stem}", kind_of(posed), posed, options, float("nan"))


def run(task: Task, solver: Solver) -> Run:
    """Plan a task with a solver."""
    timed = Timed(solver)
    try:
        solution = rt.plan(
            task.problem,
            solver=timed,
            interval_limits=rt.interval_limits.ConstraintGeneration(),
            check=False,
            progress=False,
            **task.options,
        )
    except rt.InputError as error:
        return Run("no stages" if "stages" in str(error) else "refused", float("inf"), 0, timed.seconds)
    objective = solution.objective if solution.success else float("inf")
    return Run(solution.status.value, objective, timed.iterations, timed.seconds)


def cells(line: Line) -> str:
    """Format a row of the table."""
    exact = line.task.exact
    parts = [line.task.name, line.task.kind, "" if np.isnan(exact) else f"{exact:.9g}"]
    for each in line.runs.values():
        cost = f"{each.objective:.9g}" if np.isfinite(each.objective) else each.status
        parts += [cost, str(each.iterations), f"{each.seconds:.3f}"]
    return f"| {' | '.join([*parts, line.better])} |"


def counts(lines: list[Line]) -> list[str]:
    """Count, by kind of problem, the solved ones and their processor time for each solver."""
    rows = [
        f"| kind | problems | IPOPT solved | {OWN} solved | IPOPT better | {OWN} better "
        f"| {OWN}'s seconds over IPOPT's, median |",
        "|---|---|---|---|---|---|---|",
    ]
    for kind in [*sorted({line.task.kind for line in lines}), "all"]:
        mine = [line for line in lines if kind in (line.task.kind, "all")]
        solved = [sum(np.isfinite(line.runs[name].objective) for line in mine) for name in SOLVERS]
        better = Counter(line.better for line in mine)
        both = [line for line in mine if all(np.isfinite(each.objective) for each in line.runs.values())]
        ratios = [line.runs[OWN].seconds / max(line.runs["IPOPT"].seconds, 1e-3) for line in both]
        ratio = f"{np.median(ratios):.2f}" if ratios else ""
        rows.append(
            f"| {kind} | {len(mine)} | {solved[0]} | {solved[1]} | {better['IPOPT']} | {better[OWN]} | {ratio} |"
        )
    return rows


def searched() -> list[str]:
    """Plan problems with many optima from perturbed guesses with each solver."""
    rows = [
        "| problem | solver | solved | lowest objective | median | processor [s] |",
        "|---|---|---|---|---|---|",
    ]
    for case in cases():
        if case.name not in MANY_OPTIMA:
            continue
        for name, solver in SOLVERS.items():
            began = time.process_time()
            with ThreadPoolExecutor(1) as here:
                found = rt.multistart(
                    case.problem, STARTS, executor=here, guess=case.guess, mesh=UNIFORM, solver=solver
                )
            spent = time.process_time() - began
            costs = [optimum.objective for optimum in found.optima for _ in optimum.starts]
            rows.append(
                f"| {case.name} | {name} | {len(costs)} | {min(costs):.2f} | {np.median(costs):.2f} | {spent:.2f} |"
            )
            print(rows[-1], flush=True)
    return rows


def swings() -> list[str]:
    """Compare both solvers on the acrobot's swing-ups, from the straight line."""
    robot = rt.load("acrobot")
    lines = []
    for duration in DURATIONS:
        ends = rt.State(q=[0, 0], v=0), rt.State(q=[np.pi, 0], v=0)
        phase = rt.Phase(robot, duration, *ends, rt.Effort(), limits=None)
        for count in INTERVALS:
            task = Task(f"{duration} s, {count} intervals", "", phase, {"mesh": rt.Mesh(count)}, float("nan"))
            lines.append(Line(task, {name: run(task, solver) for name, solver in SOLVERS.items()}))
    better = Counter(line.better for line in lines)
    iterations = [sum(line.runs[name].iterations for line in lines) for name in SOLVERS]
    spans = f"{DURATIONS[0]} to {DURATIONS[-1]} s on {INTERVALS[0]} to {INTERVALS[-1]} intervals"
    return [
        f"Acrobot, {len(lines)} swing-ups from the straight line ({spans}): both find the same optimum "
        f"{better['same']} times, InteriorPoint a better one {better[OWN]} times and IPOPT {better['IPOPT']} times, in "
        f"{iterations[1]} and {iterations[0]} iterations."
    ]


def written() -> tuple[dict[str, Line], list[str]]:
    """Read the rows of ``TABLE`` by name, and what stands between its tables."""
    text = TABLE.read_text().splitlines()
    first = next(i for i, line in enumerate(text) if line.startswith("Fewer controls"))
    head = next(i for i, line in enumerate(text) if line.startswith("| problem | kind"))
    rows = (_line_of([cell.strip() for cell in row.split("|")[1:-1]]) for row in text[head + 2 :])
    return {line.task.name: line for line in rows}, text[first:head]


def _line_of(parts: list[str]) -> Line:
    name, kind, exact, *results = parts[:-1]
    runs = {}
    for i, solver in enumerate(SOLVERS):
        cost, iterations, seconds = results[3 * i : 3 * i + 3]
        solved = cost.replace(".", "").replace("-", "").replace("e", "").replace("+", "").isdigit()
        status, objective = ("solved", float(cost)) if solved else (cost, float("inf"))
        runs[solver] = Run(status, objective, int(iterations), float(seconds))
    problem = cast(rt.Problem, None)
    return Line(Task(name, kind, problem, {}, float(exact) if exact else float("nan")), runs)


def write(lines: list[Line], between: list[str]) -> None:
    """Write ``TABLE``: counts, what stands ``between`` the tables, and the rows."""
    head = " | ".join(f"{name} | iterations | processor [s]" for name in SOLVERS)
    text = [
        "# IPOPT and rt.InteriorPoint",
        "",
        f"`python benchmarks/solvers.py`, {datetime.date.today().isoformat()}. The same guess, mesh or tolerance "
        f"({TOLERANCE:g}) and `interval_limits=rt.interval_limits.ConstraintGeneration()` for both, each with "
        f"its own engine, one thread, {OWN} without "
        f"anything to fall back on, {LIMIT:.0f} s a mesh. Processor seconds inside the solver, set-up included. "
        f"*uniform*: {UNIFORM.count} intervals of Hermite-Simpson; examples: their first plan, where it has at "
        f"most {LARGEST} variables. Objectives within {EQUAL:g} are the same optimum. Problems without "
        "a row were not run.",
        "",
        *counts(lines),
        "",
        *between,
        f"| problem | kind | known optimum | {head} | better |",
        "|" + "---|" * (4 + 3 * len(SOLVERS)),
        *map(cells, lines),
    ]
    TABLE.write_text("\n".join(text) + "\n")


def searches() -> list[str]:
    """Return what stands between the tables: searches of the problems with many optima, and swing-ups."""
    title = f"Fewer controls than every second state, {STARTS} starts (`rt.multistart`, seed 0) on the uniform mesh:"
    return [title, "", *searched(), "", *swings(), ""]


def main() -> None:
    """Run the problems named on the command line, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="problems whose names contain one of these; all by default")
    options = parser.parse_args()
    lines, between = written()
    seen = []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        if not options.names:
            between = searches()
        for task in tasks():
            if options.names and not any(name in task.name for name in options.names):
                continue
            lines[task.name] = Line(task, {name: run(task, solver) for name, solver in SOLVERS.items()})
            seen.append(task.name)
            print(cells(lines[task.name]), flush=True)
            write(list(lines.values()), between)
    print("\n".join(counts([lines[name] for name in seen])))
    if not options.names:
        write([lines[name] for name in seen], between)


if __name__ == "__main__":
    main()
