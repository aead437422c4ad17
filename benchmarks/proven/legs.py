"""Default plans of every legged robot of example-robot-data: `python benchmarks/proven/legs.py [part of a name ...]`.

One step of a walk or trot at three speeds, each planned and validated in a fresh process as in ``run.py``. ``root`` is
the largest force on the root that the planned motion leaves unbalanced between its points, in percent of the weight.
Without arguments the table is written to ``LEGS.md`` beside this file.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
import warnings
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import robotraj as rt

LIMIT = 400
"""Wall-clock seconds of one motion, validation included."""
SPEEDS = (0.05, 0.1, 0.25)
"""Relative to the square root of g h, h the height of the centre of mass."""
QUADRUPEDS = {
    "solo12": "FOOT",
    "solo8": "FOOT",
    "a1": "foot",
    "go1": "foot",
    "go2": "foot",
    "b1": "foot",
    "laikago": "foot",
    "hyq": "foot",
    "anymal": "FOOT",
    "anymal_c": "FOOT",
}
"""The last part of the names of feet."""
SOLES = {
    "alexander": (("LEFT_FOOT", "RIGHT_FOOT"), {"length": 0.2, "width": 0.1}),
    "g1": (
        ("left_ankle_roll_link", "right_ankle_roll_link"),
        {"length": 0.15, "width": 0.05, "offset": (0.03, 0, -0.03)},
    ),
    "human": (("right_foot", "left_foot"), {"length": 0.2, "width": 0.08}),
    "icub": (("l_sole", "r_sole"), {"length": 0.12, "width": 0.06}),
    "icub_reduced": (("l_sole", "r_sole"), {"length": 0.12, "width": 0.06}),
    "romeo": (("l_sole", "r_sole"), {"length": 0.2, "width": 0.1}),
    "simple_humanoid": (("l_ankle", "r_ankle"), {"length": 0.2, "width": 0.1, "offset": (0, 0, -0.1)}),
    "talos_legs": (("left_sole_link", "right_sole_link"), {"length": 0.2, "width": 0.12}),
    "talos": (("left_sole_link", "right_sole_link"), {"length": 0.2, "width": 0.12}),
}
"""Feet of humanoids and their soles [m]."""
ROBOTS = (*QUADRUPEDS, "bolt", *SOLES)
HEAD = (
    "| robot | speed | proved | processor [s] | meshes | intervals | iterations | error | excess | root [%] | remark |"
)
RULE = "|---|---|---|---|---|---|---|---|---|---|---|"


def step(name: str, froude: float) -> rt.Problem:
    """Return one step at a speed of froude sqrt(g h)."""
    robot = rt.load(name, root="floating")
    if name in SOLES:
        feet, sole = SOLES[name]
        contact, gait, more = partial(rt.FlatFoot, **sole), rt.gait.walk, {"double_support": 0.2}
    elif name == "bolt":
        feet, contact, gait, more = ("FL_FOOT", "FR_FOOT"), rt.PointContact, rt.gait.walk, {}
    else:
        feet = tuple(n for n in rt.gait.limb_ends(robot) if n.endswith(QUADRUPEDS[name]))
        contact, gait, more = rt.PointContact, rt.gait.trot, {}
    h = standing_height(robot, rt.gait.stand(robot, feet, contact), feet)
    return gait(
        robot,
        feet=feet,
        contact=contact,
        duration=1.6 * np.sqrt(h / 9.81),
        speed=froude * np.sqrt(9.81 * h),
        clearance=0.06 * h,
        **more,
    )


def standing_height(robot: rt.Robot, q: np.ndarray, feet: tuple[str, ...]) -> float:
    """Height of the centre of mass above the mean of the feet's frames [m]."""
    data = robot.model.createData()
    height = float(pin.centerOfMass(robot.model, data, q)[2])
    pin.framesForwardKinematics(robot.model, data, q)
    return height - float(np.mean([data.oMf[robot.frame(f)].translation[2] for f in feet]))


def unbalanced(report: rt.witness.Report, robot: rt.Robot) -> float:
    """Largest unbalanced force on the root [% of the weight]."""
    weight = 9.81 * pin.computeTotalMass(robot.model)
    peaks = report.residual.dynamics
    return 100.0 * max(abs(peaks[name].value) for name in robot.velocity_names[:3]) / weight


def judged(problem: rt.Phase | rt.Problem, time_limit: float | None = None) -> tuple[rt.Solution, Any, dict[str, Any]]:
    """Plan and validate; return the solution, the report and the cells of the table that every gait has."""
    began = time.process_time()
    solution = rt.plan(problem, check=False, progress=False, time_limit=time_limit)
    seconds = time.process_time() - began
    report = rt.validate(solution)
    proof = solution.proof
    remark = "" if solution.success else f"{solution.status.value}: {solution.cause}"
    if solution.success and not report.passed:
        remark = " ".join(report.failures(report.tolerances)).split(". ")[0]
    cells = {
        "proved": solution.success and report.passed and proof is not None and proof.motion_holds,
        "seconds": seconds,
        "meshes": len(solution.refinement),
        "intervals": sum(part.mesh.count for part in solution.phases),
        "iterations": solution.iterations,
        "remark": remark.splitlines()[0][:150] if remark else "",
    }
    return solution, report, cells


def one(name: str, froude: float) -> dict[str, object]:
    """Plan and validate a step in this process."""
    warnings.simplefilter("ignore")
    problem = step(name, froude)
    solution, report, cells = judged(problem)
    proof = solution.proof
    return cells | {
        "error": None if proof is None else proof.error,
        "excess": None if proof is None else proof.excess,
        "root": unbalanced(report, problem.phases[0].robot),
    }


def in_a_fresh_process(name: str, froude: float) -> dict[str, object]:
    """Plan a step in a separate process."""
    command = [sys.executable, __file__, "--one", name, str(froude)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return {"proved": False, "seconds": float(LIMIT), "remark": f"stopped after {LIMIT} s"}
    if done.returncode:
        lines = done.stderr.strip().splitlines() or [f"ended with code {done.returncode}"]
        return {"proved": False, "seconds": float("nan"), "remark": lines[-1][:120]}
    found: dict[str, object] = json.loads(done.stdout.splitlines()[-1])
    return found


def line(name: str, froude: float, found: dict[str, object]) -> str:
    """Return a row of the table."""
    forms = {
        "seconds": ".2f",
        "meshes": "d",
        "intervals": "d",
        "iterations": "d",
        "error": ".0e",
        "excess": ".0e",
        "root": ".2g",
    }
    cells = [name, f"{froude:g}", "yes" if found["proved"] else "no"]
    cells += ["" if found.get(key) is None else format(found[key], form) for key, form in forms.items()]
    return f"| {' | '.join([*cells, str(found['remark'])])} |"


def main(arguments: list[str]) -> None:
    """Print a row a robot and speed, then the share that is proved."""
    if arguments[:1] == ["--one"]:
        print(json.dumps(one(arguments[1], float(arguments[2]))))
        return
    names = [name for name in ROBOTS if not arguments or any(part in name for part in arguments)]
    lines, proved = [HEAD, RULE], 0
    print(f"{HEAD}\n{RULE}")
    for name in names:
        for froude in SPEEDS:
            found = in_a_fresh_process(name, froude)
            proved += bool(found["proved"])
            lines.append(line(name, froude, found))
            print(lines[-1], flush=True)
    end = f"{proved} of {len(names) * len(SPEEDS)} proved."
    print(f"\n{end}")
    if not arguments:
        head = (
            "Written by `python benchmarks/proven/legs.py`: default calls, each in a fresh process, one thread. Speeds"
            "\nare relative to sqrt(g h), h the height of the centre of mass."
        )
        Path(__file__).with_name("LEGS.md").write_text(
            "\n".join(["# Default plans of legged robots", "", head, "", *lines, "", end, ""])
        )


if __name__ == "__main__":
    main(sys.argv[1:])
