"""Cost of 1, 2, 5 and 10 steps from rest to rest: `python benchmarks/proven/steps.py [robot ...]`.

``rt.gait.steps`` by the default call, each in a fresh process: bipeds move one foot a step, quadrupeds a diagonal pair,
by 0.2 times the height of the centre of mass, the first step by half. Validation is left out. Without arguments the
table is written to ``STEPS.md`` beside this file.
"""

from __future__ import annotations

import json
import sys
import time
import warnings
from pathlib import Path

import pinocchio as pin
from gaits import SECONDS, Walker, in_a_fresh_process

import robotraj as rt

ROBOTS = ("five_link", "solo12", "talos_legs")
COUNTS = (1, 2, 5, 10)
LENGTH = 0.2
HEAD = "| robot | steps | proved | processor [s] | times one step | phases | intervals | iterations |"
RULE = "|---|---|---|---|---|---|---|---|"


def walk(walker: Walker, count: int) -> rt.Problem:
    """Return a walk of that many steps from rest to rest."""
    robot, length = walker.robot, LENGTH * walker.height
    q = rt.gait.stand(robot, walker.names, walker.feet.get("contact", rt.PointContact))
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    home = {name: data.oMf[robot.frame(name)].translation for name in walker.names}
    groups = [walker.names[:1], walker.names[1:]]
    if len(walker.names) == 4:
        slants = {name: home[name][1] * (home[name][0] - q[0]) > 0.0 for name in walker.names}
        groups = [[name for name in walker.names if slants[name] == side] for side in (True, False)]
    footholds = [
        {name: (home[name][0] + length * (k + 1) / 2, home[name][1]) for name in groups[k % 2]} for k in range(count)
    ]
    return rt.gait.steps(robot, footholds, **walker.feet)


def one(name: str, count: int) -> dict[str, object]:
    """Plan in this process."""
    warnings.simplefilter("ignore")
    walker = Walker(name)
    problem = walk(walker, count)
    began = time.process_time()
    solution = rt.plan(problem, check=False, progress=False, time_limit=4 * SECONDS)
    return {
        "proved": bool(solution.success and solution.proof is not None and solution.proof.holds),
        "seconds": time.process_time() - began,
        "phases": len(solution.phases),
        "intervals": sum(part.mesh.count for part in solution.phases),
        "iterations": solution.iterations,
    }


def main(arguments: list[str]) -> None:
    """Print a row a plan."""
    if arguments[:1] == ["--one"]:
        name, count = arguments[1].split(":")
        print(json.dumps(one(name, int(count))))
        return
    lines = [HEAD, RULE]
    print("\n".join(lines))
    for name in arguments or ROBOTS:
        first = float("nan")
        for count in COUNTS:
            found = in_a_fresh_process(__file__, f"{name}:{count}")
            seconds = float(str(found["seconds"]))
            first = seconds if count == COUNTS[0] else first
            cells = [name, str(count), "yes" if found["proved"] else "no", f"{seconds:.2f}", f"{seconds / first:.1f}"]
            cells += [str(found.get(key, "")) for key in ("phases", "intervals", "iterations")]
            lines.append(f"| {' | '.join(cells)} |")
            print(lines[-1], flush=True)
    if not arguments:
        head = (
            "Written by `python benchmarks/proven/steps.py`: `rt.gait.steps` from rest to rest. A foot, or a diagonal"
            "\npair, moves by 0.2 times the height of the centre of mass a step. Default calls, each in a fresh"
            "\nprocess, one thread, without validation."
        )
        table = "\n".join(["# Many steps", "", head, "", *lines, ""])
        Path(__file__).with_name("STEPS.md").write_text(table)


if __name__ == "__main__":
    main(sys.argv[1:])
