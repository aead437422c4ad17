"""Markdown from the record of a run."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import goals
import plots
from figures import good, median, of, off_the_line, over, seconds
from tasks import task_of
from tools import TOOLS

PACKAGES = ("drake", "crocoddyl", "pin", "casadi", "robotraj", "dymos", "openmdao", "opty")


def commit(root: Path) -> str:
    """Tell what is checked out, with a + where it was changed since."""
    command = ["git", "-C", str(root), "describe", "--always", "--dirty=+", "--abbrev=7"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def versions(pythons: Mapping[str, Path]) -> dict[str, str]:
    """Return the versions of the measured packages in each interpreter."""
    code = (
        "import importlib.metadata as m\n"
        f"for name in {PACKAGES!r}:\n"
        "    try: print(name, m.version(name))\n"
        "    except m.PackageNotFoundError: pass"
    )
    found: dict[str, str] = {}
    for python in dict.fromkeys(pythons.values()):
        lines = subprocess.run([str(python), "-c", code], capture_output=True, text=True, check=True).stdout
        who = next(TOOLS[name].environment for name, path in pythons.items() if path == python)
        found[who or "robotraj, by hand, Opti"] = ", ".join(lines.splitlines())
    return found


def title_of(key: str) -> str:
    """Task, motion and mesh."""
    return f"{key.partition('@')[0]} {task_of(key).title}, {task_of(key).intervals} intervals"


def repeats(record: Mapping[str, Any]) -> str:
    """How often things were run."""
    return (
        f"medians of {record['repeats']} ({record['slow repeats']} of slow tools, 1 where a run takes over "
        f"{record['once']:.0f} s)"
    )


def full(record: Mapping[str, Any]) -> str:
    """Every figure of every task and tool, the goals, the plots."""
    lines = [
        f"Run of {record['date']} at commit {record['commit']}: {repeats(record)}, interleaved, fresh processes, one "
        "thread. **Processor seconds**, with the clock's in brackets, since the machine was not idle; ratios hold "
        "within this run only.",
        "",
        *(f"- {who}: {text}" for who, text in record["versions"].items()),
        "",
        f"![solve seconds by task]({plots.BARS})",
        "",
        f"![seconds against intervals]({plots.SWEEP})",
        "",
    ]
    for key, tools in record["results"].items():
        lines += [
            f"### {title_of(key)}",
            "",
            "| tool | solve [s] | build + solve [s] | process [s] | second plan, solve [s] | other goal, plan [s] "
            "| iterations | objective | over a limit | goal missed by | drift | memory [MB] | runs |",
            "|---|---|---|---|---|---|---|---|---|---|---|---|---|",
        ]
        for name, runs in tools.items():
            head = f"| {TOOLS[name].title} "
            if not good(runs):
                lines.append(head + f"| {runs[0]['failed']} |" + " |" * 11)
                continue
            times = [
                f"{seconds(median(runs, cpu))} ({seconds(median(runs, clock))})"
                for cpu, clock in (("solve cpu", "solve"), ("work cpu", "work"), ("process cpu", "total"))
            ]
            iterations = median(runs, "iterations")
            lines.append(
                head + f"| {' | '.join(times)} | {seconds(median(runs, 'again solve cpu'))} "
                f"| {seconds(median(runs, 'moved cpu'))} "
                f"| {'not reported' if iterations < 0 else round(iterations)} | {median(runs, 'objective'):.7g} "
                f"| {over(runs)} | {median(runs, 'goal'):.1g} | {median(runs, 'drift'):.1g} "
                f"| {median(runs, 'memory'):.0f} | {len(good(runs))} |"
            )
        lines.append("")
    lines += growth(record)
    titles = {name: tool.title for name, tool in TOOLS.items()}
    lines += ["### Ratios", "", "Processor seconds, peer over robotraj.", "", *goals.rows(record, titles), ""]
    return "\n".join(lines)


def growth(record: Mapping[str, Any]) -> list[str]:
    """T4: build and solve for each iteration, against the number of intervals."""
    keys = sorted((key for key in record["results"] if key.startswith("T4")), key=lambda key: task_of(key).intervals)
    counts = [task_of(key).intervals for key in keys]
    lines = [
        "### T4: build + solve for each iteration [ms] against intervals",
        "",
        "The last column is the largest distance from the nearest straight line.",
        "",
        f"| tool | {' | '.join(map(str, counts))} | off the line |",
        "|---" * (len(keys) + 2) + "|",
    ]
    for name, tool in TOOLS.items():
        each = [1e3 * of(record, key, name, "work cpu") / of(record, key, name, "iterations") for key in keys]
        known = [(n, value) for n, value in zip(counts, each, strict=True) if value > 0]
        if len(known) > 2:
            cells = " | ".join("" if not value > 0 else f"{value:.3g}" for value in each)
            lines.append(f"| {tool.title} | {cells} | {100 * off_the_line(*zip(*known, strict=True)):.0f} % |")
    return [*lines, ""]


def between_markers(path: Path, text: str, name: str) -> None:
    """Replace the text between a file's markers of that name."""
    begin, end = f"<!-- {name}:begin -->", f"<!-- {name}:end -->"
    before, rest = path.read_text().split(begin)
    path.write_text(f"{before}{begin}\n{text}{end}{rest.split(end)[1]}")


def write_all(record: Mapping[str, Any], results: Path) -> None:
    """Fill the file of results, plots beside it."""
    between_markers(results, full(record), "tasks")
    plots.bars(record, results.parent / plots.BARS)
    plots.sweep(record, results.parent / plots.SWEEP)
