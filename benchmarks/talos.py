"""Whole-body Talos, 32 motors and a floating base, stands up and walks: default calls, proved and simulated.

python benchmarks/talos.py            writes benchmarks/talos.md
python benchmarks/talos.py --html     writes talos_stand_up.html and talos_walk.html as well
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import robotraj as rt

FEET = ("left_sole_link", "right_sole_link")
SOLE = partial(rt.FlatFoot, length=0.2, width=0.12, friction=0.6)
TABLE = Path(__file__).with_suffix(".md")
HEAD = """# Whole-body Talos

`python benchmarks/talos.py`: default calls in one process, after the imports, one thread. Talos has 32 motors, a
floating base (38 velocities) and two flat feet with six forces each. Every position, velocity and effort limit of the
URDF holds, and its dry friction is part of the dynamics. The guess is the default for legs. The check is `validate`,
which simulates the plan with plain Pinocchio. Linear algebra is part of the processor time.

| motion | proved | processor [s] | linear algebra | meshes | intervals | iterations | error | simulated | check [s] |
|---|---|---|---|---|---|---|---|---|---|
"""


def stand_up(robot: rt.Robot) -> rt.Phase:
    """Stand up from a crouch in 1.2 s."""
    low, high = rt.gait.stand(robot, FEET, SOLE, height=0.75), rt.gait.stand(robot, FEET, SOLE)
    return rt.Phase(
        robot,
        duration=1.2,
        start=rt.State(q=low, v=0),
        end=rt.State(q=high, v=0),
        objective=rt.gait.gait_objective(robot, high),
        contacts=[SOLE(foot) for foot in FEET],
        name="stand up",
    )


def walk(robot: rt.Robot) -> rt.Problem:
    """Two steps of 0.2 m that repeat, each in 0.8 s, a fifth of it on both feet. Left and right differ in inertia."""
    return rt.gait.walk(
        robot,
        feet=FEET,
        contact=SOLE,
        step_length=0.2,
        duration=0.8,
        double_support=0.2,
        clearance=0.04,
        repeat=rt.Periodic(),
    )


MOTIONS: dict[str, Callable[[rt.Robot], rt.Phase | rt.Problem]] = {"stand up": stand_up, "walk": walk}


def main() -> None:
    """Write a row of the table for each motion."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--html", action="store_true", help="write a replay of each motion")
    arguments = parser.parse_args()
    robot = rt.load("talos", root="floating")
    lines = []
    for name, motion in MOTIONS.items():
        began = time.process_time()
        solution = rt.plan(motion(robot), check=False)
        planned = time.process_time()
        report = rt.validate(solution)
        checked = time.process_time() - planned
        proof = solution.proof
        lines.append(
            f"| {name} | {'yes' if proof is not None and proof.holds else 'no'} | {planned - began:.1f} "
            f"| {solution.times['solve: linear algebra']:.1f} | {len(solution.refinement)} "
            f"| {solution.refinement[-1].intervals} | {solution.iterations} | {solution.refinement[-1].error:.0e} "
            f"| {'passed' if report.passed else 'failed'} | {checked:.1f} |"
        )
        print(lines[-1], flush=True)
        if arguments.html:
            print("wrote", rt.replay(solution, f"talos_{name.replace(' ', '_')}.html"))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    TABLE.write_text(HEAD + "\n".join(lines) + f"\n\nLargest memory of the process: {memory:.0f} MB.\n")


if __name__ == "__main__":
    main()
