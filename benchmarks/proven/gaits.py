"""Every gait call on every robot: `python benchmarks/proven/gaits.py [--robot NAME] [--gait NAME] [--resume]`.

Default calls of ``rt.gait`` and ``rt.plan``: only sizes are given (step length, speed, rise, width, angle). They are
drawn with a fixed seed in parts of the height h of the centre of mass. Each robot is planned in a fresh process, and
each plan validated. Every row is written to ``GAITS.md`` beside this file as soon as it is known. A run of one robot or
one gait replaces its own rows there and keeps the others. ``--resume`` runs only what has no row yet.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import warnings
import zlib
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from legs import QUADRUPEDS, SOLES, judged, standing_height

import robotraj as rt

SECONDS = 90.0
"""Processor time of one plan."""
WALL = 280.0
"""Wall-clock time of one call, loading and validation included."""
TABLE = Path(__file__).with_name("GAITS.md")
GAITS = (
    "walk",
    "trot",
    "crawl",
    "start",
    "stop",
    "start_stop",
    "sidestep",
    "turn",
    "stairs",
    "gap",
    "jump",
)
ROBOTS = (
    "five_link",
    "solo12",
    "solo8",
    "go1",
    "a1",
    "hyq",
    "anymal",
    "laikago",
    "bolt",
    "alexander",
    "talos_legs",
    "g1",
    "talos",
)
HEAD = "| robot | gait | proved | processor [s] | meshes | intervals | iterations | remark |"
RULE = "|---|---|---|---|---|---|---|---|"


class Walker:
    """A robot, the options of its feet, and the calls that fit it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.robot = rt.load(name, root="planar" if name == "five_link" else "floating")
        self.feet: dict[str, Any] = {}
        sole = 0.0
        if name in SOLES:
            frames, size = SOLES[name]
            self.feet = {"feet": frames, "contact": partial(rt.FlatFoot, **size)}
            sole = float(size["length"])
        elif name in QUADRUPEDS:
            frames = tuple(n for n in rt.gait.limb_ends(self.robot) if n.endswith(QUADRUPEDS[name]))
            self.feet = {"feet": frames}
        elif name == "bolt":
            self.feet = {"feet": ("FL_FOOT", "FR_FOOT")}
        self.names = rt.gait.feet_of(self.robot, self.feet.get("feet"))
        q = rt.gait.stand(self.robot, self.names, self.feet.get("contact", rt.PointContact))
        self.height = standing_height(self.robot, q, self.names)
        self.front = self._front(q) + 0.5 * sole
        self.sole = sole
        self.rng = np.random.default_rng(zlib.crc32(name.encode()))

    def _front(self, q: np.ndarray) -> float:
        data = self.robot.model.createData()
        pin.framesForwardKinematics(self.robot.model, data, q)
        return max(float(data.oMf[self.robot.frame(name)].translation[0]) for name in self.names)

    def part(self, low: float, high: float) -> float:
        """Return a random length between these parts of the height [m]."""
        return float(self.rng.uniform(low, high)) * self.height

    def calls(self) -> dict[str, Callable[[], rt.Problem]]:
        """Return the problems by name of the call; start and stop plan the walk first."""
        robot, feet, h = self.robot, self.feet, self.height
        pendulum = float(np.sqrt(h / 9.81))
        pace = {"step_length": self.part(0.15, 0.3), "duration": 1.6 * pendulum, "clearance": 0.06 * h}
        length, high = self.part(0.15, 0.3), 0.06 * h
        rise, width, way = self.part(0.05, 0.1), self.part(0.05, 0.12), self.part(0.08, 0.15)
        angle, leap = float(self.rng.uniform(0.2, 0.5)), self.part(0.05, 0.12)
        biped = len(self.names) == 2
        # The legs of solo8 move in parallel planes, so that it neither turns nor steps sideways.
        space = robot.root == "floating" and self.name != "solo8"
        tread = max(0.45 * h, self.sole + 0.12)
        over = {"start": self.front + 0.1 * h + 0.08, "step_length": tread, "clearance": high}

        def planned() -> rt.Solution:
            more = {"double_support": 0.2} if self.sole else {}
            gait = rt.gait.walk if biped else rt.gait.trot
            return rt.plan(gait(robot, **pace, **feet, **more), progress=False)

        calls: dict[str, Callable[[], rt.Problem]] = {}
        if biped:
            more = {"double_support": 0.2} if self.sole else {}
            calls["walk"] = lambda: rt.gait.walk(robot, **pace, **feet, **more)
        else:
            calls["trot"] = lambda: rt.gait.trot(robot, **pace, **feet)
            slow = pace | {"duration": 4.0 * pendulum, "step_length": 0.5 * pace["step_length"]}
            calls["crawl"] = lambda: rt.gait.crawl(robot, **{**slow, "clearance": 0.0}, **feet, full_support=0.2)
        calls["start"] = lambda: rt.gait.start(planned())
        calls["stop"] = lambda: rt.gait.stop(planned())
        calls["start_stop"] = lambda: rt.gait.start_stop(robot, step_length=length, clearance=high, **feet)
        if space:
            calls["sidestep"] = lambda: rt.gait.sidestep(robot, distance=way, clearance=high, **feet)
            calls["turn"] = lambda: rt.gait.turn(robot, angle=angle, clearance=high, **feet)
        calls["stairs"] = lambda: rt.gait.stairs(robot, run=tread, rise=rise, count=1, **over, **feet)
        calls["gap"] = lambda: rt.gait.gap(robot, width=width, **over, **feet)
        calls["jump"] = lambda: rt.gait.jump(robot, height=leap, **feet)
        return calls


def one(make: Callable[[], rt.Problem]) -> dict[str, object]:
    """Plan and validate a problem in this process."""
    try:
        _, _, cells = judged(make(), SECONDS)
    except rt.RobotrajError as error:
        return {"proved": False, "remark": str(error).splitlines()[0][:150]}
    return cells


def line(robot: str, gait: str, found: dict[str, object]) -> str:
    """Return a row of the table."""
    forms = {"seconds": ".2f", "meshes": "d", "intervals": "d", "iterations": "d"}
    cells = [robot, gait, "yes" if found["proved"] else "no"]
    cells += ["" if found.get(key) is None else format(found[key], form) for key, form in forms.items()]
    return f"| {' | '.join([*cells, str(found['remark']).replace('|', '/')])} |"


def known_rows() -> dict[tuple[str, str], str]:
    """Return the rows of ``TABLE`` by robot and gait."""
    lines = TABLE.read_text().splitlines() if TABLE.exists() else []
    rows = [text for text in lines if text.startswith("| ") and text != HEAD]
    return {tuple(cell.strip() for cell in text.split("|")[1:3]): text for text in rows}  # type: ignore[misc]


def write(rows: dict[tuple[str, str], str]) -> None:
    """Write the table in the order of ``ROBOTS`` and ``GAITS``."""
    ordered = [rows[key] for key in sorted(rows, key=lambda key: (ROBOTS.index(key[0]), GAITS.index(key[1])))]
    proved = sum(text.split("|")[3].strip() == "yes" for text in ordered)
    head = (
        "Written by `python benchmarks/proven/gaits.py`: default calls, one thread, a fresh process each. Processor"
        f"\ntime of a plan is limited to {SECONDS:g} s. Calls without a row were not run."
    )
    end = f"{proved} of {len(ordered)} proved."
    TABLE.write_text("\n".join(["# Gait calls", "", head, "", HEAD, RULE, *ordered, "", end, ""]))


def in_a_fresh_process(script: str, *arguments: str) -> dict[str, object]:
    """Plan and validate one motion of a script of this folder in a separate process."""
    command = [sys.executable, script, "--one", *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=WALL)
    except subprocess.TimeoutExpired:
        return {"proved": False, "remark": f"stopped after {WALL:g} s of wall time"}
    if done.returncode:
        return {"proved": False, "remark": (done.stderr.strip().splitlines() or ["no message"])[-1][:150]}
    found: dict[str, object] = json.loads(done.stdout.splitlines()[-1])
    return found


def main() -> None:
    """Print a row a robot and gait, and keep it in the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", choices=ROBOTS)
    parser.add_argument("--gait", choices=GAITS)
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    if given.one:
        print(json.dumps(one(Walker(given.robot).calls()[given.gait])))
        return
    # A complete run begins an empty table.
    whole = not (given.robot or given.gait or given.resume)
    rows = {} if whole else known_rows()
    for robot in ROBOTS if given.robot is None else [given.robot]:
        for gait in Walker(robot).calls():
            if given.gait not in (None, gait) or (given.resume and (robot, gait) in rows):
                continue
            found = in_a_fresh_process(__file__, "--robot", robot, "--gait", gait)
            rows[robot, gait] = line(robot, gait, found)
            write(rows)
            print(rows[robot, gait], flush=True)


if __name__ == "__main__":
    main()
