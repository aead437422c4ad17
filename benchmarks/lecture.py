"""The lecture's experiment, timed: a double integrator moved 10 m in minimum time with |u| <= 1.

Direct collocation by the lecture's scheme at 51, 101 and 201 points, multiple and single shooting at 21, and an
adaptive mesh against uniform ones. Seconds are medians of the processor time of five runs of
``rt.plan``, taken in turn. Ratios are of this run. The lecture reports 2, 7 and 55 s for 51, 101 and
201 points, and 290 times the seconds of multiple shooting at 21 points for the last.

``python benchmarks/lecture.py`` prints the tables and writes figures 3 to 10 (see ``lecture_figures``) into the working
directory, as ``lecture_03.png`` to ``lecture_10.png``. With ``--results FILE`` it measures the methods only, and writes
their table and ratios between that file's lecture markers.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lecture_figures import draw_costs, draw_meshes, draw_motion, draw_seconds

import robotraj as rt
from robotraj._util.arrays import Array

RUNS = 5
DISTANCE = 10.0
LECTURE = rt.HermiteSimpson(control=rt.schemes.LinearControl(), quadrature=rt.schemes.TrapezoidalQuadrature())
REPORTED = (2.0, 7.0, 55.0)
"""Seconds in the lecture of the first three ``METHODS``."""
BLOCK = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])


def move(brake: float = 1.0) -> rt.Phase:
    return rt.Phase(
        BLOCK,
        duration=(0.1, 200.0),
        start=rt.State([0, 0]),
        end=rt.State([DISTANCE, 0]),
        controls={"u": rt.between(-brake, 1)},
        objective=rt.Duration(),
    )


def optimum(brake: float = 1.0) -> float:
    """sqrt(2 D (1 + 1 / brake)): v = t1 = brake t2 and v (t1 + t2) / 2 = D."""
    return float(np.sqrt(2 * DISTANCE * (1 + 1 / brake)))


def exact(t: Array) -> tuple[Array, Array, Array]:
    """Position, velocity and force: full ahead to half of the duration, full back after it, with a brake of 1."""
    left = np.maximum(optimum() - t, 0)
    ahead = t < optimum() / 2
    return np.where(ahead, t**2 / 2, DISTANCE - left**2 / 2), np.where(ahead, t, left), np.where(ahead, 1.0, -1.0)


@dataclass(frozen=True)
class Run:
    """One method: how it is planned, and the duration it should find."""

    name: str
    plan: Callable[[], rt.Solution]
    exact: float


def fixed(name: str, intervals: int, scheme: object, brake: float = 1.0) -> Run:
    return Run(name, lambda: rt.plan(move(brake), rt.Mesh(intervals, scheme)), optimum(brake))


def adaptive(name: str, intervals: int, brake: float) -> Run:
    first = rt.Mesh(intervals, rt.schemes.RadauIIA(3))
    return Run(name, lambda: rt.plan(move(brake), first, tolerance=1e-6), optimum(brake))


METHODS = [
    fixed("collocation, lecture's scheme, 51 points", 50, LECTURE),
    fixed("collocation, lecture's scheme, 101 points", 100, LECTURE),
    fixed("collocation, lecture's scheme, 201 points", 200, LECTURE),
    fixed("collocation, free mid-point, 51 points", 50, rt.HermiteSimpson()),
    fixed("multiple shooting, RK4, 21 points", 20, rt.schemes.MultipleShooting()),
    fixed("multiple shooting, CVODES, 21 points", 20, rt.schemes.MultipleShooting(rt.schemes.Adaptive())),
    fixed("single shooting, RK4, 21 points", 20, rt.schemes.SingleShooting()),
]
BRAKE = 2.0
MESHES = [
    adaptive("adaptive, tolerance 1e-6", 10, BRAKE),
    *(
        fixed(f"uniform, {k} intervals of Radau 3", k, rt.schemes.RadauIIA(3), BRAKE)
        for k in (10, 20, 40, 80, 160, 320)
    ),
]
"""Braking twice as hard as driving: the switch, at 2/3 of the duration, is at no knot of a uniform mesh of these."""


SCHEMES = {
    "trapezoid": rt.schemes.Trapezoidal(),
    "lecture's scheme": LECTURE,
    "Hermite-Simpson, free mid-point": rt.HermiteSimpson(),
    "Radau IIA, 3 points": rt.schemes.RadauIIA(3),
    "multiple shooting, constant control": rt.schemes.MultipleShooting(),
}
"""What is drawn against points, on the problem of ``MESHES``."""


@dataclass(frozen=True)
class Measured:
    """Last solution and median seconds of a run."""

    solution: rt.Solution
    seconds: float
    error: float


def measure(runs: list[Run]) -> dict[str, Measured]:
    """Solve every run several times, in turn."""
    seconds: dict[str, list[float]] = {run.name: [] for run in runs}
    found: dict[str, rt.Solution] = {}
    for _ in range(RUNS):
        for run in runs:
            began = time.process_time()
            found[run.name] = run.plan()
            seconds[run.name].append(time.process_time() - began)
    return {
        run.name: Measured(
            found[run.name],
            float(np.median(seconds[run.name])),
            abs(found[run.name].duration / run.exact - 1),
        )
        for run in runs
    }


def table(measured: dict[str, Measured]) -> str:
    lines = ["| method | points | iterations | seconds | relative error |", "|---|---|---|---|---|"]
    for name, each in measured.items():
        steps = each.solution.refinement
        iterations = sum(step.iterations for step in steps) if steps else each.solution.iterations
        points = len(each.solution.phases[0].points)
        lines.append(f"| {name} | {points} | {iterations} | {each.seconds:.4f} | {each.error:.1e} |")
    return "\n".join(lines) + "\n"


def ratios(methods: dict[str, Measured]) -> str:
    """Compare ratios of times with the lecture's and with the requirement."""
    small, middle, large = (methods[run.name].seconds for run in METHODS[:3])
    multiple, single = methods[METHODS[4].name].seconds, methods[METHODS[6].name].seconds
    rows = (
        ("101 points by collocation against 51", middle / small, f"{7 / 2:.1f}", ""),
        ("201 points by collocation against 51", large / small, f"{55 / 2:.1f}", "at most 4.2"),
        ("201 points by collocation against multiple shooting at 21", large / multiple, "290", ""),
        ("single against multiple shooting, 21 points", single / multiple, "", ""),
    )
    lines = ["| seconds of | here | lecture | required |", "|---|---|---|---|"]
    lines += [f"| {what} | {ratio:.2f} | {theirs} | {goal} |" for what, ratio, theirs, goal in rows]
    return "\n".join(lines) + "\n"


def figures(methods: dict[str, Measured], meshes: dict[str, Measured]) -> None:
    names = [run.name for run in METHODS]
    drawn = [names[0], names[1], names[2], names[4], names[6]]
    paths = [draw_motion(n, name, methods[name].solution, exact) for n, name in enumerate(drawn, start=3)]
    solutions = {name: methods[name].solution for name in names}
    seconds = {name: methods[name].seconds for name in names}
    paths.append(draw_seconds(8, solutions, seconds, dict(zip(names, REPORTED, strict=False)), exact))
    own, *uniform = (meshes[run.name].solution for run in MESHES)
    near = min(uniform, key=lambda other: abs(len(other.phases[0].points) - len(own.phases[0].points)))
    paths += [draw_meshes(9, own, near), draw_costs(10, against_points(own))]
    print("\nwrote", ", ".join(str(path) for path in paths))


def against_points(adaptive_run: rt.Solution) -> dict[str, list[tuple[int, float, float]]]:
    """Points, error and seconds of uniform meshes by scheme, and of the meshes of an adaptive run."""
    series = {}
    for name, scheme in SCHEMES.items():
        runs = [fixed(str(n), n, scheme, BRAKE) for n in (10, 20, 40, 80, 160)]
        each = measure(runs).values()
        series[name] = [(len(m.solution.phases[0].points), m.error, m.seconds) for m in each]
    steps = adaptive_run.refinement
    spent = np.cumsum([step.seconds for step in steps])
    series["adaptive, Radau IIA"] = [
        (step.points, abs(step.objective / optimum(BRAKE) - 1), float(total))
        for step, total in zip(steps, spent, strict=True)
    ]
    return series


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--results", type=Path, help="write the methods' table between this file's lecture markers")
    options = parser.parse_args(arguments)
    methods = measure(METHODS)
    text = (
        f"Minimum time, |u| <= 1, exactly {optimum():.7f} s; `rt.plan` in one process, medians of {RUNS}, processor "
        f"seconds.\nPoints are collocation points, or knots of shooting.\n\n{table(methods)}\n{ratios(methods)}"
    )
    print(text)
    if options.results is not None:
        begin, end = "<!-- lecture:begin -->", "<!-- lecture:end -->"
        before, rest = options.results.read_text().split(begin)
        options.results.write_text(f"{before}{begin}\n{text}{end}{rest.split(end)[1]}")
        return
    print(f"Adaptive against uniform, -{BRAKE:g} <= u <= 1, exactly {optimum(BRAKE):.7f} s.\n")
    meshes = measure(MESHES)
    print(table(meshes))
    fine, own = MESHES[-1].name, meshes[MESHES[0].name]
    print(f"{fine} against adaptive: {meshes[fine].seconds / own.seconds:.2f} times the seconds")
    figures(methods, meshes)


if __name__ == "__main__":
    main()
