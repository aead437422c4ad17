"""Plan 300 drawn problems again and compare: `python benchmarks/frozen/run.py [--kind KIND ...] [--each 5]`.

The problems are drawn from a fixed seed and are never changed or tuned to. Each is planned once, in one process, within
``SECONDS`` of processor time. ``RESULTS.csv`` holds the results of a past commit, which ``--write`` replaces for the
kinds that were run. A comparison prints the problems that are no longer proved, objectives that rose by more than their
goal, causes that no longer name the conflicting row, and processor seconds by kind. It fails where there are any of the
first three. To judge one change, write a table of the commit before it with ``--table FILE --write``, and compare with
that: a plan is the same if its iterations and its objective are.
"""

from __future__ import annotations

import argparse
import csv
import gc
import sys
import time
import warnings
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import numpy as np

sys.path.extend(
    [str(Path(__file__).parents[0]), str(Path(__file__).parents[1]), str(Path(__file__).parents[1] / "proven")]
)

import arms
import others
from drawn import Draw, Drawn
from infeasible import infeasible

import robotraj as rt

TABLE = Path(__file__).with_name("RESULTS.csv")
SEED = 2026
SECONDS = 20.0
"""Limit of a plan's processor time."""
COLUMNS = ("kind", "number", "proved", "named", "seconds", "iterations", "meshes", "objective", "cause")
KINDS: Mapping[str, tuple[int, Draw]] = {
    "effort": (24, arms.effort),
    "time": (24, arms.time),
    "work": (16, arms.work),
    "jerk": (14, arms.jerk),
    "mixture": (22, arms.mixture),
    "friction": (24, arms.friction),
    "payload": (14, arms.payload),
    "obstacles": (20, arms.obstacles),
    "path": (18, arms.path),
    "waypoints": (14, arms.waypoints),
    "system": (36, others.system),
    "swing-up": (22, others.swinging),
    "phases": (15, others.phases),
    "planar legs": (11, others.planar_legs),
    "floating legs": (10, others.floating_legs),
    "infeasible": (16, infeasible),
}
"""Number of problems of each kind, and how one is drawn."""
Row = dict[str, str]


def places(kinds: Iterable[str], every: int, each: int | None = None) -> list[tuple[str, int]]:
    """Return kind and number of the problems that are run: every n-th, and of each kind so many, evenly spread."""
    chosen = []
    for kind, (count, _) in KINDS.items():
        spread = np.arange(count) if each is None else np.linspace(0, count - 1, min(each, count)).round()
        chosen += [(kind, int(number)) for number in spread]
    return [place for place in chosen[::every] if place[0] in kinds]


def drawn(kind: str, number: int) -> Drawn:
    """Draw one problem; it depends on the seed, its kind and its number alone."""
    return KINDS[kind][1](np.random.default_rng([SEED, number, *kind.encode()]), number)


def planned(kind: str, number: int) -> Row:
    """Plan a problem and return its row of the table."""
    began, names, solution = time.process_time(), (), None
    try:
        each = drawn(kind, number)
        names = each.names
        problem = each.problem() if callable(each.problem) else each.problem
        problem = _alone(problem)
        began = time.process_time()
        solution = rt.plan(problem, time_limit=SECONDS, check=False, progress=False, **each.options)
        cause = "" if solution.success else solution.cause
    except rt.RobotrajError as error:
        cause = str(error)
    seconds, row = time.process_time() - began, {"kind": kind, "number": str(number), "proved": "no"}
    if solution is not None and solution.success:
        settled = solution.proof is None or solution.proof.holds
        row["proved"] = "yes" if settled else "unsettled"
    row["named"] = "" if not names else _yes(all(any(w in cause for w in word.split("|")) for word in names))
    row["seconds"] = f"{seconds:.3f}"
    row["iterations"] = "" if solution is None else str(solution.iterations)
    row["meshes"] = "" if solution is None else str(len(solution.refinement))
    row["objective"] = "" if solution is None else f"{solution.objective:.9g}"
    row["cause"] = " ".join(cause.split())[:160]
    return row


def _alone(problem: rt.Phase | rt.Problem) -> rt.Problem:
    """Let links of fixed robots touch each other: ends are drawn without regard to that."""
    problem = rt.Problem([problem]) if isinstance(problem, rt.Phase) else problem
    phases = [
        phase.with_(self_collision=False) if phase.robot is not None and phase.robot.root == "fixed" else phase
        for phase in problem.phases
    ]
    return rt.Problem(phases, problem.links)


def _yes(holds: bool) -> str:
    return "yes" if holds else "no"


def known(table: Path) -> dict[tuple[str, int], Row]:
    """Return the rows of a table by kind and number."""
    if not table.exists():
        return {}
    with table.open(newline="") as file:
        return {(row["kind"], int(row["number"])): row for row in csv.DictReader(file)}


def write(rows: Iterable[Row], table: Path) -> None:
    """Write rows into a table in the order of the kinds, and keep the others."""
    every = known(table) | {(row["kind"], int(row["number"])): row for row in rows}
    order = [place for place in places(KINDS, 1) if place in every]
    with table.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(every[place] for place in order)


def worse(old: Row, new: Row) -> Iterator[str]:
    """Yield what is worse than before."""
    where = f"{new['kind']} {new['number']}"
    if old["proved"] != "no" and new["proved"] == "no":
        yield f"{where}: no longer proved ({new['cause']})"
    elif old["proved"] == "yes" and new["proved"] == "unsettled":
        yield f"{where}: the objective no longer settles"
    elif old["proved"] != "no":
        before, now = float(old["objective"]), float(new["objective"])
        goal = rt.solution.Goals().objective
        rise = (now - before) / max(abs(before), 1e-2)
        if rise > goal:
            yield f"{where}: objective {before:.6g} -> {now:.6g}, {100 * rise:+.2f} %"
    if old["named"] == "yes" and new["named"] == "no":
        yield f"{where}: the cause no longer names the row ({new['cause']})"


def compare(rows: list[Row], table: Path) -> int:
    """Print the table by kind and what is worse; return the number of the latter."""
    before = known(table)
    pairs = [(before[place], row) for row in rows if (place := (row["kind"], int(row["number"]))) in before]
    print("| kind | problems | proved | before | seconds | before | ratio | iterations | before |")
    print("|---|" + "---:|" * 8)
    for kind in [*KINDS, "all"]:
        own = [pair for pair in pairs if kind in (pair[1]["kind"], "all")]
        if own:
            print(_summary(kind, own))
    found = [text for old, new in pairs for text in worse(old, new)]
    gained = [f"{new['kind']} {new['number']}" for old, new in pairs if old["proved"] == "no" != new["proved"]]
    others = [f"{b['kind']} {b['number']}" for a, b in pairs if any(a[k] != b[k] for k in ("iterations", "objective"))]
    print(f"\n{len(others)} of {len(pairs)} plans differ: {', '.join(others)}")
    print(f"{len(found)} worse", *found, f"{len(gained)} newly proved: {', '.join(gained)}", sep="\n")
    return len(found)


def _summary(kind: str, pairs: list[tuple[Row, Row]]) -> str:
    proved = [sum(pair[k]["proved"] != "no" for pair in pairs) for k in (1, 0)]
    seconds = [sum(float(pair[k]["seconds"]) for pair in pairs) for k in (1, 0)]
    iterations = [sum(int(pair[k]["iterations"] or 0) for pair in pairs) for k in (1, 0)]
    ratio = seconds[0] / max(seconds[1], 1e-3)
    return (
        f"| {kind} | {len(pairs)} | {proved[0]} | {proved[1]} | {seconds[0]:.1f} | {seconds[1]:.1f} | {ratio:.2f} "
        f"| {iterations[0]} | {iterations[1]} |"
    )


def main() -> int:
    """Plan, then compare or write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--kind", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--number", type=int, nargs="+", help="numbers within the kinds")
    parser.add_argument("--every", type=int, default=1, help="run every n-th problem")
    parser.add_argument("--each", type=int, help="run so many problems of each kind")
    parser.add_argument("--table", type=Path, default=TABLE, help="table of results, RESULTS.csv by default")
    parser.add_argument("--write", action="store_true", help="replace rows of the table instead of comparing")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    rt.plan(rt.Phase(rt.load("pendulum"), 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort()))  # imports
    rows = []
    for kind, number in places(given.kind, given.every, given.each):
        if given.number is not None and number not in given.number:
            continue
        rows.append(planned(kind, number))
        gc.collect()
        print(*(rows[-1][name] for name in COLUMNS), sep="  ", flush=True)
        if given.write:
            write(rows[-1:], given.table)
    return 0 if given.write else int(compare(rows, given.table) > 0)


if __name__ == "__main__":
    sys.exit(main())
