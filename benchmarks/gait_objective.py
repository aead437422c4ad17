"""Iterations of one step of legged robots, by the weight of accelerations in the default objective of gaits.

    python benchmarks/gait_objective.py [robot ...]

Prints the table of benchmarks/gait_objective.md: iterations (and processor seconds) of a step for each factor c of
c (h / g)^2 (0.2 m g h)^2 sum a^2, h the height of the centre of mass. A dash: not solved in LIMIT iterations.
"""

from __future__ import annotations

import sys
import time
import warnings
from functools import partial

import numpy as np
import pinocchio as pin

import robotraj as rt
from robotraj.gait import posture

LIMIT = 300
FACTORS = (0.0, 2e-4, 2e-3, 2e-2)
SOLES = {
    "g1": (
        ("left_ankle_roll_link", "right_ankle_roll_link"),
        {"length": 0.15, "width": 0.05, "offset": (0.03, 0, -0.03)},
    ),
    "talos_legs": (("left_sole_link", "right_sole_link"), {"length": 0.2, "width": 0.12}),
    "icub": (("l_sole", "r_sole"), {"length": 0.12, "width": 0.06}),
    "alexander": (("LEFT_FOOT", "RIGHT_FOOT"), {"length": 0.2, "width": 0.1}),
}
QUADRUPEDS = {
    "solo12": "FOOT",
    "anymal": "FOOT",
    "hyq": "foot",
    "a1": "foot",
    "go1": "foot",
    "b1": "foot",
    "laikago": "foot",
}


def step(name: str, froude: float, repeat: rt.Periodic | None = None) -> rt.Problem:
    """One step at a speed of froude sqrt(g h); two where ``repeat`` is given, as halves of unlike inertia need."""
    robot = rt.load(name, root="floating")
    if name in SOLES:
        feet, sole = SOLES[name]
        contact = partial(rt.FlatFoot, **sole)
        gait, more = rt.gait.walk, {"double_support": 0.2}
    elif name == "bolt":
        feet, contact, gait, more = ("FL_FOOT", "FR_FOOT"), rt.PointContact, rt.gait.walk, {}
    else:
        feet = tuple(n for n in rt.gait.limb_ends(robot) if n.endswith(QUADRUPEDS[name]))
        contact, gait, more = rt.PointContact, rt.gait.trot, {}
    q = rt.gait.stand(robot, feet, contact)
    data = robot.model.createData()
    h = float(pin.centerOfMass(robot.model, data, q)[2])
    pin.framesForwardKinematics(robot.model, data, q)
    h -= float(np.mean([data.oMf[robot.frame(f)].translation[2] for f in feet]))
    duration = 1.6 * np.sqrt(h / 9.81)
    return gait(
        robot,
        feet=feet,
        contact=contact,
        duration=duration,
        speed=froude * np.sqrt(9.81 * h),
        clearance=0.06 * h,
        repeat=repeat,
        **more,
    )


def main() -> None:
    """Print a row a robot and speed."""
    warnings.simplefilter("ignore")
    names = sys.argv[1:] or ["solo12", "bolt", *[n for n in QUADRUPEDS if n != "solo12"], *SOLES]
    print("| robot | speed / sqrt(g h) |" + "".join(f" c = {c:g} |" for c in FACTORS), flush=True)
    print("|---|---|" + "---|" * len(FACTORS), flush=True)
    for name in names:
        for froude in (0.1, 0.25):
            cells = []
            for factor in FACTORS:
                posture.CALM = factor
                try:
                    problem = step(name, froude)
                except rt.InputError as error:
                    cells.append(str(error)[:60])
                    break
                began = time.process_time()
                plan = rt.plan(
                    problem,
                    rt.Mesh(10),
                    solver=rt.Ipopt(max_iterations=LIMIT),
                    restarts=rt.planning.Restarts(0),
                    check=False,
                )
                took = time.process_time() - began
                cells.append(f"{plan.iterations if plan.success else '-'} ({took:.1f} s)")
            print(f"| {name} | {froude:g} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
