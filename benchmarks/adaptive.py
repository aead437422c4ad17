"""Adaptive against uniform meshes of one scheme: `python benchmarks/adaptive.py`.

The first table gives the number of collocation points for a relative error of the objective of 1e-6: by refinement
from 21 equal intervals of Radau IIA with 3 points, and by equal intervals alone, to a quarter. The second gives the
distance of moving knots from the switching times of bang-bang problems. Both are written beside this file as Markdown.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import sqrt
from pathlib import Path

from problems.case import TOLERANCE, Case
from problems.switching import arcs, bangs, plan
from problems.written import TABLE, written
from rich.console import Console
from rich.table import Table

import robotraj as rt

SCHEME = rt.schemes.RadauIIA(3)
HEAD = "# Adaptive and uniform meshes\n\n`python benchmarks/adaptive.py`, whose docstring defines the columns.\n\n"
INTERVALS = [21, 27, 35, 45, 57, 73, 93, 117, 147, 187, 235, 295, 371, 465, 583]
"""Odd numbers, each a quarter more than the last: no knot is at a switch at half time."""


def block(pull: float) -> Case:
    """Bring a block from 10 m to rest at 0 in minimum time, -1 <= u <= pull: one switch, at pull / (1 + pull) T."""
    system = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    ends = rt.State([10, 0]), rt.State([0, 0])
    phase = rt.Phase(system, (0.1, 200), *ends, rt.Duration(), controls={"u": rt.between(-1, pull)})
    guess = rt.guess.Keyframes([0, 1], ends, duration=10)
    return Case(f"block, u <= {pull:.4g}", phase, guess, sqrt(20 * (1 + 1 / pull)), 0.0, "closed form")


def hypersensitive() -> Case:
    """Rest for 50 s between two steep ends."""
    (case,) = (case for case in written(TABLE) if case.name == "hypersensitive")
    # The table has it to 1e-5; 800 equal intervals with 4 points and 600 with 6 agree in these digits.
    return Case("hyper-sensitive", case.problem, case.guess, 1.33080690495, 1e-10, "two fine meshes")


def cases() -> Iterator[Case]:
    """Return problems with switches at half and at an irrational fraction of the duration, and with boundary layers."""
    yield block(1.0)
    yield block(sqrt(2))
    yield hypersensitive()


@dataclass(frozen=True)
class Reach:
    """Points and error of a plan."""

    points: int
    error: float


def adaptive(case: Case) -> Reach:
    """Plan with the tolerance, from a uniform mesh."""
    solution = rt.plan(case.problem, rt.Mesh(INTERVALS[0], SCHEME), case.guess, tolerance=TOLERANCE, progress=False)
    return Reach(len(solution.phases[0].points), abs(solution.objective / case.exact - 1))


def uniform(case: Case, intervals: int) -> Reach:
    """Plan on equal intervals."""
    solution = rt.plan(case.problem, rt.Mesh(intervals, SCHEME), case.guess, progress=False)
    return Reach(len(solution.phases[0].points), abs(solution.objective / case.exact - 1))


def needed(case: Case) -> Reach:
    """Take the coarsest of the equal meshes such that it and all finer ones hold the tolerance."""
    reaches = [uniform(case, intervals) for intervals in INTERVALS]
    missed = [i for i, reach in enumerate(reaches) if reach.error > TOLERANCE]
    first = max(missed, default=-1) + 1
    return reaches[min(first, len(reaches) - 1)]


def ratios(console: Console) -> tuple[str, list[float]]:
    """Show how many times more points the uniform meshes need."""
    rows, found = [], []
    for case in cases():
        ours, theirs = adaptive(case), needed(case)
        found.append(theirs.points / ours.points)
        figures = (str(ours.points), f"{ours.error:.1e}", str(theirs.points), f"{theirs.error:.1e}")
        rows.append((case.name, *figures, f"{found[-1]:.1f}"))
    return rendered(console, ("problem", "adaptive: points", "error", "uniform: points", "error", "ratio"), rows), found


def switches(console: Console) -> tuple[str, list[float]]:
    """Show the switching times found by moving knots and how far they are off."""
    rows, found = [], []
    for bang in bangs():
        solution = plan(bang)
        for control, exact in bang.switches.items():
            times = [time for time, _ in arcs(solution, control)[:-1]]
            off = [abs(time - true) for time, true in zip(times, exact, strict=True)]
            found.append(max(off))
            shown = ", ".join(f"{time:.6f}" for time in times)
            rows.append((bang.case.name, str(bang.mesh.count), control, shown, f"{max(off):.1e}"))
    return rendered(console, ("problem", "intervals", "control", "switches at (s)", "off by (s)"), rows), found


def rendered(console: Console, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Print a table and give it as Markdown."""
    table = Table(*heads)
    for row in rows:
        table.add_row(*row)
    console.print(table)
    ruler = ["---" for _ in heads]
    return "".join(f"| {' | '.join(row)} |\n" for row in (heads, ruler, *rows))


def main() -> int:
    """Print both tables; fail above a quarter of the points, or farther than 1e-4 s from a switch."""
    console = Console(width=None if sys.stdout.isatty() else 120)
    meshes, times = ratios(console), switches(console)
    Path(__file__).with_suffix(".md").write_text(f"{HEAD}{meshes[0]}\n{times[0]}")
    return 0 if min(meshes[1]) >= 4 and max(times[1]) <= 1e-4 else 1


if __name__ == "__main__":
    sys.exit(main())
