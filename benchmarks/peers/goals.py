"""Goals of the comparison, and whether this run reaches them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from figures import of

PLAIN = ("robotraj", "robotraj-ipopt", "robotraj-interior-point", "robotraj-bernstein")
"""No compiler, an empty cache."""
WARM = ("robotraj-compiled", "robotraj-bernstein-compiled")
STARTS = ("robotraj-starts", "robotraj-starts-20")
"""The lowest of many optima."""
PEERS = ("opti", "drake-ipopt", "drake-snopt", "crocoddyl", "dymos", "opty", "opty-compiled")
DRAKE = ("drake-ipopt", "drake-snopt")


@dataclass(frozen=True)
class Goal:
    """A ratio of medians within one run: the quickest of the peers over our quickest.

    Attributes
    ----------
    task, figure : str
        "solve cpu", "work cpu" or "process cpu".
    peers, ours : tuple of str
    least : float
    """

    task: str
    figure: str
    peers: tuple[str, ...]
    ours: tuple[str, ...]
    least: float
    again: bool = False


SAME = 1e-3
"""Objectives that differ by no more than this share are equally good."""
WORDS = {"solve cpu": "solve", "work cpu": "build + solve", "process cpu": "whole process"}
GOALS = (
    Goal("T1", "work cpu", ("drake-snopt",), PLAIN, 1.0),
    Goal("T1", "process cpu", ("drake-snopt",), PLAIN, 1.0),
    Goal("T2", "solve cpu", PEERS, PLAIN + WARM, 10.0),
    Goal("T2", "work cpu", PEERS, PLAIN, 10.0),
    Goal("T2", "process cpu", PEERS, PLAIN, 10.0),
    Goal("T3", "work cpu", DRAKE, STARTS, 1.0),
    Goal("T4", "work cpu", DRAKE, PLAIN, 20.0),
    Goal("T4", "process cpu", DRAKE, PLAIN, 20.0),
    Goal("T4", "work cpu", ("crocoddyl",), PLAIN, 6.0),
    Goal("T4", "process cpu", ("crocoddyl",), PLAIN, 6.0),
    Goal("T4", "solve cpu", DRAKE, WARM, 80.0),
    Goal("T4", "solve cpu", DRAKE, PLAIN, 80.0, again=True),
    Goal("T4", "solve cpu", ("crocoddyl",), WARM, 25.0),
    Goal("T4", "solve cpu", ("crocoddyl",), PLAIN, 25.0, again=True),
    Goal("T4@200", "solve cpu", DRAKE, PLAIN + WARM, 80.0),
    Goal("T4@200", "solve cpu", ("crocoddyl",), PLAIN + WARM, 20.0),
    Goal("T5", "work cpu", DRAKE, ("robotraj-ends",), 150.0),
    Goal("T5", "solve cpu", DRAKE, ("robotraj-ends",), 150.0),
)


def quickest(record: Mapping[str, Any], task: str, names: tuple[str, ...], figure: str) -> tuple[float, str]:
    """Return the least median and its tool; infinite where no tool has one."""
    found = [(value, name) for name in names if (value := of(record, task, name, figure)) == value]
    return min(found, default=(float("inf"), ""))


def rows(record: Mapping[str, Any], titles: Mapping[str, str]) -> list[str]:
    """Return a table of goals: the goal, the ratio, and whether it is reached."""
    lines = ["| task | figure | peer | ours | ratio | goal | |", "|---|---|---|---|---|---|---|"]
    for goal in GOALS:
        theirs, peer = quickest(record, goal.task, goal.peers, goal.figure)
        mine, variant = quickest(record, goal.task, goal.ours, f"again {goal.figure}" if goal.again else goal.figure)
        if not peer or not variant:
            continue
        ratio = theirs / mine
        worse = of(record, goal.task, variant, "objective") / of(record, goal.task, peer, "objective") - 1
        verdict = "holds" if ratio >= goal.least else "does not hold"
        if worse > SAME:
            verdict = f"does not hold: objective {100 * worse:.1f} % worse"
        second = ", second plan of a process" if goal.again else ""
        lines.append(
            f"| {goal.task} | {WORDS[goal.figure]} | {titles[peer]} {theirs:.3g} s | {titles[variant]}{second} "
            f"{mine:.3g} s | {ratio:.3g} | {goal.least:g} | {verdict} |"
        )
    return lines
