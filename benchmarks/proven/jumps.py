"""Forty jumps: `python benchmarks/proven/jumps.py [number ...]`.

Heights are 0.05 to 0.5 and lengths 0 to 0.8 times the height of the centre of mass, drawn with a fixed seed. Three of
ten jumps are straight up. Only these two sizes are given. Each jump is planned and validated in a fresh process.
Without arguments the table is written to ``JUMPS.md`` beside this file.
"""

from __future__ import annotations

import json
import sys
import warnings
from pathlib import Path

import numpy as np
from gaits import SECONDS, Walker, in_a_fresh_process
from legs import judged

import robotraj as rt

ROBOTS = ("five_link", "monopod", "solo12", "a1", "go1", "bolt", "talos_legs", "anymal", "hyq", "solo8")
JUMPS = 40
HEAD = "| number | robot | height | length | proved | processor [s] | meshes | intervals | iterations | remark |"
RULE = "|---|---|---|---|---|---|---|---|---|---|"


def drawn() -> list[tuple[str, float, float]]:
    """Return robots, and heights and lengths relative to the height of the centre of mass."""
    rng, found = np.random.default_rng(20261126), []
    for number in range(JUMPS):
        height, length = float(rng.uniform(0.05, 0.5)), float(rng.uniform(0.0, 0.8))
        found.append((ROBOTS[number % len(ROBOTS)], height, length * float(rng.random() < 0.7)))
    return found


def one(number: int) -> dict[str, object]:
    """Plan and validate a jump in this process."""
    warnings.simplefilter("ignore")
    name, height, length = drawn()[number]
    walker = Walker(name)
    problem = rt.gait.jump(walker.robot, height=height * walker.height, length=length * walker.height, **walker.feet)
    return judged(problem, SECONDS)[2]


def line(number: int, found: dict[str, object]) -> str:
    """Return a row of the table."""
    name, height, length = drawn()[number]
    forms = {"seconds": ".2f", "meshes": "d", "intervals": "d", "iterations": "d"}
    cells = [str(number), name, f"{height:.2f}", f"{length:.2f}", "yes" if found["proved"] else "no"]
    cells += ["" if found.get(key) is None else format(found[key], form) for key, form in forms.items()]
    return f"| {' | '.join([*cells, str(found['remark']).replace('|', '/')])} |"


def main(arguments: list[str]) -> None:
    """Print a row a jump, then the share that is proved and the median of the seconds."""
    if arguments[:1] == ["--one"]:
        print(json.dumps(one(int(arguments[1]))))
        return
    numbers = [int(argument) for argument in arguments] or list(range(JUMPS))
    print(f"{HEAD}\n{RULE}")
    lines, proved, seconds = [HEAD, RULE], 0, []
    for number in numbers:
        found = in_a_fresh_process(__file__, str(number))
        proved += bool(found["proved"])
        seconds.append(float(str(found.get("seconds", np.inf))))
        lines.append(line(number, found))
        print(lines[-1], flush=True)
    end = f"{proved} of {len(numbers)} proved, {np.median(seconds):.2f} s of processor time in the median."
    print(f"\n{end}")
    if not arguments:
        head = (
            "Written by `python benchmarks/proven/jumps.py`: `rt.gait.jump` with a height and a length, relative to the"
            f"\nheight of the centre of mass. Default calls, each in a fresh process, at most {SECONDS:g} s."
        )
        table = "\n".join(["# Jumps", "", head, "", *lines, "", end, ""])
        Path(__file__).with_name("JUMPS.md").write_text(table)


if __name__ == "__main__":
    main(sys.argv[1:])
