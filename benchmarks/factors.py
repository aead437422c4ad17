"""IPOPT with robotraj's own sparse factors and with MUMPS: `python benchmarks/factors.py`.

The problems of solvers.py, each planned twice, from the same guess, with the same mesh or tolerance. Prints and writes
factors.md: optima, iterations and processor seconds inside the solver.
"""

from __future__ import annotations

import argparse
import datetime
from pathlib import Path

import numpy as np
from solvers import EQUAL, LIMIT, Run, Task, run, tasks

import robotraj as rt

HERE = Path(__file__).resolve().parent
SOLVERS = {name: rt.Ipopt(time_limit=LIMIT, linear_solver=name) for name in ("mumps", "ldl")}


def row(task: Task, mumps: Run, own: Run) -> str:
    """Format a problem's figures."""
    cells = [task.name, task.kind]
    for each in (mumps, own):
        cells += [f"{each.objective:.9g}" if np.isfinite(each.objective) else each.status]
        cells += [str(each.iterations), f"{each.seconds:.3f}"]
    return f"| {' | '.join([*cells, f'{own.seconds / mumps.seconds:.2f}'])} |"


def summary(runs: list[tuple[Run, Run]]) -> str:
    """Say in a sentence or two what all of them show."""
    ratios = [own.seconds / mumps.seconds for mumps, own in runs]
    solved = [sum(np.isfinite(pair[k].objective) for pair in runs) for k in (0, 1)]
    same = sum(
        mumps.status == own.status and abs(mumps.objective - own.objective) <= EQUAL * (1.0 + abs(mumps.objective))
        for mumps, own in runs
    )
    iterations = [sum(pair[k].iterations for pair in runs) for k in (0, 1)]
    seconds = [sum(pair[k].seconds for pair in runs) for k in (0, 1)]
    return (
        f"Of {len(runs)} problems MUMPS solved {solved[0]} and robotraj's factors {solved[1]}; {same} ended at the "
        f"same optimum. Iterations in all: {iterations[0]} and {iterations[1]}; seconds: {seconds[0]:.1f} and "
        f"{seconds[1]:.1f}; ratio of seconds from {min(ratios):.2f} to {max(ratios):.2f}, median "
        f"{np.median(ratios):.2f}."
    )


def main() -> None:
    """Plan, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="problems whose names contain one of these; all by default")
    names = parser.parse_args().names
    runs, rows = [], []
    for task in tasks():
        if names and not any(name in task.name for name in names):
            continue
        mumps, own = (run(task, solver) for solver in SOLVERS.values())
        runs.append((mumps, own))
        rows.append(row(task, mumps, own))
        print(rows[-1], flush=True)
    sentence = summary(runs)
    print(sentence)
    if names:
        return
    text = [
        "# IPOPT's linear systems",
        "",
        f'`python benchmarks/factors.py`, {datetime.date.today().isoformat()}. `rt.Ipopt(linear_solver="mumps")` and '
        '`"ldl"`, the default: same problems, guesses and meshes as in [solvers.md](solvers.md), processor seconds '
        f"inside the solver, evaluations by CasADi's virtual machine included. {sentence}",
        "",
        "| problem | kind | MUMPS | iterations | processor [s] | ldl | iterations | processor [s] | ratio |",
        "|---|---|---|---|---|---|---|---|---|",
        *rows,
    ]
    (HERE / "factors.md").write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    main()
