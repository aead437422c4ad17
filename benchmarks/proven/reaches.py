"""Random reaches of arms, each planned by the default call: `python benchmarks/proven/reaches.py [robot ...]`.

Ends are drawn within the limits of the URDF. Every second reach has the least effort and a fixed duration of 1.05 to 3
times its bound by speed limits. The others take the least time. A reach counts as proved where ``solution.proof`` holds
and the judgement from outside (``outside.py``) agrees; a claimed proof that it refutes is a false success. A reach of
fixed duration that was not proved is called infeasible where the least time found for its ends, from several guesses,
is longer. The table goes to ``REACHES.md``, with ``--log FILE`` also a line of JSON for every reach. A run that was
stopped goes on with the same log: reaches of the log are not planned again.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

TABLE = Path(__file__).with_name("REACHES.md")
ROBOTS = ("ur5", "ur10", "panda", "z1", "kinova", "xarm7")
COUNT = 300
LOCKED = {"panda": {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}, "z1": {"jointGripper": 0.0}}
WIDEST = 3.0
"""Joints that may turn further are moved within this [rad]."""
ROOM = 0.05
"""Share of a joint's range that is left free at either end of it."""
UNLIMITED_SPEED = 3.0
"""Speed [rad/s] for the bound on durations of joints without a limit."""
INTERVALS, EVERY = 50, 6
"""Intervals of the fixed mesh that the seconds are compared with; for every sixth pair of reaches."""
HEAD = (
    "| robot | objective | reaches | feasible | proved | share | false | median [s] | 99 % [s] | worst [s] "
    "| ratio to a fixed mesh | meshes | iterations |"
)


def reaches(name: str, count: int, seed: int) -> Iterator[tuple[object, object]]:
    """Yield pairs of robot and phase."""
    import robotraj as rt

    robot = rt.load(name, locked=LOCKED.get(name))
    model, random = robot.model, np.random.default_rng([seed, len(name), *name.encode()])
    low = np.maximum(model.lowerPositionLimit, -WIDEST)
    high = np.minimum(model.upperPositionLimit, WIDEST)
    speeds = np.where(model.upperVelocityLimit < 1e20, model.upperVelocityLimit, UNLIMITED_SPEED)
    for number in range(count):
        start, end = low + (ROOM + (1 - 2 * ROOM) * random.random((2, robot.nq))) * (high - low)
        bound = float(np.max(np.abs(end - start) / speeds))
        factor = 1.05 + 1.95 * random.random()
        least_effort = number % 2 == 0
        duration = factor * bound if least_effort else (0.5 * bound, 20.0 * bound + 1.0)
        objective = rt.Effort() if least_effort else rt.Duration()
        ends = rt.State(q=start, v=0), rt.State(q=end, v=0)
        yield robot, rt.Phase(robot, duration, *ends, objective, name=f"{name} {number}")


def of_one(robot: object, phase: object, compared: bool) -> dict[str, object]:
    """Plan and judge a reach; also solve it on the fixed mesh if ``compared``."""
    from outside import judged

    import robotraj as rt

    began = time.process_time()
    solution = rt.plan(phase, check=False, progress=False)
    seconds = time.process_time() - began
    fixed = np.nan
    if compared:
        began = time.process_time()
        rt.plan(phase, rt.Mesh(INTERVALS, rt.HermiteSimpson()), check=False, progress=False)
        fixed = time.process_time() - began
    claimed = bool(solution.success and solution.proof is not None and solution.proof.motion_holds)
    settled = bool(claimed and solution.proof.holds)
    seen = judged(robot, solution) if claimed else None
    low, high = phase.duration_bounds
    found = {
        "seconds": seconds,
        "ratio": seconds / fixed,
        "status": solution.status.value,
        "message": solution.message,
        "claimed": claimed,
        "settled": settled,
        "error": seen.error if seen else None,
        "excess": seen.excess if seen else None,
        "right": bool(seen and seen.right),
        "meshes": len(solution.refinement),
        "iterations": solution.iterations,
        "feasible": True,
        "proof": None if solution.proof is None else str(solution.proof),
    }
    if not claimed and low == high:
        found["least"] = least_time(phase)
        found["feasible"] = found["least"] <= high
    return found


def least_time(phase: object) -> float:
    """Return the least time [s] found between the ends of a reach, from the default and from longer guesses."""
    import robotraj as rt

    (duration, _), best = phase.duration_bounds, np.inf
    free = phase.with_(duration=(0.5 * duration, 20.0 * duration), objective=rt.Duration())
    for factor in (None, 1.5, 3.0):
        guess = None if factor is None else rt.guess.StraightLine(duration=factor * duration)
        solution = rt.plan(free, guess=guess, check=False, progress=False)
        if solution.success:
            best = min(best, solution.duration)
    return best


def lines_of(name: str, found: list[dict[str, object]]) -> Iterator[str]:
    """Yield a row of the table for each objective."""
    for objective in ("effort", "time"):
        own = [each for each in found if each["objective"] == objective]
        if not own:
            continue
        feasible = [each for each in own if each["feasible"]]
        proved = [each for each in feasible if each["settled"] and each["right"]]
        false = [each for each in own if each["claimed"] and not each["right"]]
        seconds = np.array([each["seconds"] for each in feasible])
        ratios = np.array([each["ratio"] for each in feasible if np.isfinite(each["ratio"])] or [np.nan])
        means = [np.mean([each[key] for each in feasible]) for key in ("meshes", "iterations")]
        yield (
            f"| {name} | {objective} | {len(own)} | {len(feasible)} | {len(proved)} | "
            f"{100 * len(proved) / max(len(feasible), 1):.1f} % | {len(false)} | {np.median(seconds):.3f} | "
            f"{np.quantile(seconds, 0.99):.2f} | {seconds.max():.2f} | {np.median(ratios):.1f} | {means[0]:.1f} | "
            f"{means[1]:.0f} |"
        )


def logged(log: Path | None, name: str, seed: int) -> dict[int, dict[str, object]]:
    """Return the lines of a log that hold reaches of a robot from this seed, by their numbers."""
    if log is None or not log.exists():
        return {}
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    return {each["number"]: each for each in lines if each["robot"] == name and each.get("seed") == seed}


def child(name: str, count: int, seed: int, only: list[int]) -> None:
    """Print a line of JSON for every reach of a robot."""
    warnings.simplefilter("ignore")
    for number, (robot, phase) in enumerate(reaches(name, count, seed)):
        if number not in only:
            continue
        found = of_one(robot, phase, number // 2 % EVERY == EVERY - 1)
        head = {"robot": name, "number": number, "seed": seed, "objective": "time" if number % 2 else "effort"}
        print(json.dumps(head | found), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("robots", nargs="*", default=list(ROBOTS))
    parser.add_argument("--count", type=int, default=COUNT)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, nargs="*", default=[], help="numbers of reaches")
    parser.add_argument("--log", type=Path)
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument(
        "--read", type=Path, nargs="+", help="write the table of these logs; later lines replace earlier"
    )
    given = parser.parse_args()
    if given.child:
        return child(given.robots[0], given.count, given.seed, given.only)
    rows = [HEAD, "|---|---|" + "---:|" * 11]
    if given.read:
        lines = [json.loads(line) for log in given.read for line in log.read_text().splitlines()]
        known = {(each["robot"], each["number"]): each for each in lines}
        for name in dict.fromkeys(each["robot"] for each in lines):
            rows += lines_of(name, [each for (robot, _), each in sorted(known.items()) if robot == name])
        return write(rows, given.seed)
    for name in given.robots:
        wanted = given.only or range(given.count)
        known = logged(given.log, name, given.seed)
        found = [known[number] for number in wanted if number in known]
        missing = [str(number) for number in wanted if number not in known]
        command = [sys.executable, __file__, name, "--child", "--count", str(given.count), "--seed", str(given.seed)]
        command += ["--only", *missing]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            for line in process.stdout:
                found.append(json.loads(line))
                if given.log:
                    with given.log.open("a") as log:
                        log.write(line)
        rows += lines_of(name, found)
        print("\n".join(rows[-2:]), flush=True)
    if given.robots == list(ROBOTS) and not given.only:
        write(rows, given.seed)


def write(rows: list[str], seed: int) -> None:
    """Write the table."""
    head = (
        "Written by `python benchmarks/proven/reaches.py`: default calls, processor seconds in one process a robot, "
        f"reaches drawn from seed {seed}. That file describes the columns."
    )
    TABLE.write_text("\n".join(["# Random reaches of arms", "", head, "", *rows, ""]))
    print("\n".join(rows))


if __name__ == "__main__":
    main()
