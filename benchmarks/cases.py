"""Plan every case to its optimum without a given mesh: `python benchmarks/cases.py`.

Plans each problem with `rt.plan(problem, guess=..., tolerance=1e-6)`, prints one table and writes it beside this file
as Markdown. Exits with 1 where an objective misses its optimum by more than the tolerance, or than the reference is
known to.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from problems.biped import biped
from problems.case import Case, Result, run
from problems.robots import robots
from problems.sliding_mass import sliding_mass
from problems.written import MORE, TABLE, written
from rich.console import Console
from rich.progress import track
from rich.table import Table

HEADS = (
    *["case", "objective", "exact", "error", "reference", "intervals", "points", "order", "meshes", "iterations", "s"],
    "",
)


def cases() -> Iterator[Case]:
    """Return published cases as equations and as URDFs, the biped, the sliding mass in phases, and further problems."""
    systems = {case.name: case for case in written(TABLE)}
    yield from systems.values()
    yield from robots(systems)
    yield from (biped(torso_from_hip=from_hip) for from_hip in (False, True))
    yield from (sliding_mass(count) for count in (1, 2, 3, 4))
    yield from written(MORE)


def line(result: Result) -> tuple[str, ...]:
    """Format one row of the table; order is the number of points per interval."""
    least, most = result.orders
    return (
        result.case.name,
        f"{result.solution.objective:.9g}",
        f"{result.case.exact:.9g}",
        f"{result.error:.1e}",
        f"{result.case.accuracy:.0e}" if result.case.accuracy else "exact",
        str(result.intervals),
        str(result.points),
        f"{least} to {most}" if least < most else str(least),
        str(result.meshes),
        str(result.iterations),
        f"{result.seconds:.1f}",
        "reached" if result.reached else f"missed: {result.solution.status.value}",
    )


def markdown(rows: Sequence[tuple[str, ...]]) -> str:
    """Write the rows as a Markdown table."""
    ruler = tuple("---" for _ in HEADS)
    return "".join(f"| {' | '.join(row)} |\n" for row in (HEADS, ruler, *rows))


def shown(rows: Sequence[tuple[str, ...]]) -> Table:
    """Write the rows as a table of the terminal."""
    table = Table()
    for head in HEADS:
        table.add_column(head, justify="left" if head in ("case", "") else "right", no_wrap=True)
    for row in rows:
        table.add_row(*row, style=None if row[-1] == "reached" else "red")
    return table


def main() -> int:
    """Run the cases named on the command line, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="cases whose names contain one of these; all by default")
    parser.add_argument("--markdown", type=Path, help="where the table is written")
    options = parser.parse_args()
    chosen = [case for case in cases() if not options.names or any(name in case.name for name in options.names)]
    console = Console(width=None if sys.stdout.isatty() else 170)
    results = [run(case) for case in track(chosen, "planning", console=Console(stderr=True), transient=True)]
    rows = [line(result) for result in results]
    console.print(shown(rows))
    out = options.markdown or Path(__file__).parent / "cases.md"
    if options.markdown or not options.names:
        out.write_text(markdown(rows))
        console.print(f"wrote {out}")
    return 0 if results and all(result.reached for result in results) else 1


if __name__ == "__main__":
    sys.exit(main())
