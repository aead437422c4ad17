"""Markdown from the record of a run."""

from __future__ import annotations

import statistics
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tasks import TASKS

PACKAGES = ("drake", "crocoddyl", "pin", "casadi", "robotraj")
NAMES = {
    "robotraj": "robotraj", "opti": "CasADi Opti", "drake-ipopt": "Drake, IPOPT", "drake-snopt": "Drake, SNOPT",
    "crocoddyl": "Crocoddyl",
}  # fmt: skip


def versions(pythons: Mapping[str, Path]) -> dict[str, str]:
    """Versions of the packages that are measured, asked of each interpreter."""
    code = (
        "import importlib.metadata as m\n"
        f"for name in {PACKAGES!r}:\n"
        "    try: print(name, m.version(name))\n"
        "    except m.PackageNotFoundError: pass"
    )
    found = {}
    for peer, python in pythons.items():
        lines = subprocess.run([str(python), "-c", code], capture_output=True, text=True, check=True).stdout
        found[peer] = ", ".join(lines.splitlines())
    return found


def median(runs: list[dict[str, Any]], key: str) -> float:
    """Median of a figure over the runs that ended well."""
    return statistics.median(run[key] for run in runs if "failed" not in run)


def seconds(value: float) -> str:
    """Two significant digits below 10 s."""
    return f"{value:.2g}" if value < 10 else f"{value:.0f}"


def ended_well(runs: list[dict[str, Any]]) -> bool:
    """Whether any run gave a plan."""
    return any("failed" not in run for run in runs)


def over(runs: list[dict[str, Any]]) -> str:
    """Largest excess over a limit, in percent of it, and which limit."""
    value, kind = max((median(runs, f"over {kind}"), kind) for kind in ("position", "speed", "torque"))
    digits = ".0f" if value > 0.1 else ".2g"
    return "0" if value < 1e-6 else f"{100 * value:{digits}} % {kind}"


def times(ratio: float) -> str:
    """Form a ratio to robotraj's time."""
    return f"{ratio:.2g}x"


def full(record: Mapping[str, Any]) -> str:
    """Every figure of every task and tool."""
    lines = [
        f"Run of {record['date']}, medians of {record['repeats']} (1 where a run takes over 40 s), "
        "interleaved, fresh processes, one thread; ratios hold within this run only.",
        "",
        *(f"- {NAMES[peer]}: {text}" for peer, text in record["versions"].items()),
        "",
        "| task | tool | solve [s] | total [s] | total, ratio | iterations | objective | over a limit "
        "| goal missed by | drift | memory [MB] | runs |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for task, peers in record["results"].items():
        ours = median(peers["robotraj"], "total") if ended_well(peers.get("robotraj", [])) else float("nan")
        for peer, runs in peers.items():
            head = f"| {task} {TASKS[task].title} | {NAMES[peer]} "
            if not ended_well(runs):
                lines.append(head + f"| {runs[0]['failed']} |" + " |" * 9)
                continue
            m = {key: median(runs, key) for key in ("solve", "total", "objective", "goal", "drift", "memory")}
            iterations = median(runs, "iterations")
            lines.append(
                head + f"| {seconds(m['solve'])} | {seconds(m['total'])} | {times(m['total'] / ours)} "
                f"| {'not told' if iterations < 0 else round(iterations)} "
                f"| {m['objective']:.7g} | {over(runs)} | {m['goal']:.1g} | {m['drift']:.1g} "
                f"| {m['memory']:.0f} | {sum('failed' not in run for run in runs)} |"
            )
    return "\n".join(lines) + "\n"


def short(record: Mapping[str, Any]) -> str:
    """Total and solve seconds, ratio of totals and excess over limits; Drake by its quicker solver."""
    columns = {"robotraj": ["robotraj"], "CasADi Opti": ["opti"], "Drake": ["drake-ipopt", "drake-snopt"]}
    columns["Crocoddyl"] = ["crocoddyl"]
    lines = [
        "Total / solve seconds (total: a fresh process, imports included), total relative to robotraj's, and the "
        f"largest excess over a limit between the knots; medians of {record['repeats']}, {record['date']}. "
        "Crocoddyl takes speed "
        "limits and the goal as penalties. More in [RESULTS.md](benchmarks/peers/RESULTS.md).",
        "",
        "| task | " + " | ".join(columns) + " |",
        "|---" * (len(columns) + 1) + "|",
    ]
    for task, peers in record["results"].items():
        cells = [f"{task} {TASKS[task].title}"]
        ours = median(peers["robotraj"], "total") if ended_well(peers["robotraj"]) else float("nan")
        for candidates in columns.values():
            good = [peers[peer] for peer in candidates if ended_well(peers.get(peer, []))]
            if not good:
                cells.append(str(peers[candidates[0]][0]["failed"]))
                continue
            best = min(good, key=lambda runs: median(runs, "total"))
            total, solve = median(best, "total"), median(best, "solve")
            ratio = "" if best is peers["robotraj"] else f", {times(total / ours)}"
            cells.append(f"{seconds(total)} / {seconds(solve)} s{ratio}; {over(best)}")
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def between_markers(path: Path, text: str, name: str = "peers") -> None:
    """Replace what stands between a file's markers of that name."""
    begin, end = f"<!-- {name}:begin -->", f"<!-- {name}:end -->"
    before, rest = path.read_text().split(begin)
    path.write_text(f"{before}{begin}\n{text}{end}{rest.split(end)[1]}")
