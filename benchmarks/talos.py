"""Whole-body Talos, 32 motors and a floating base, walks one step on flat feet: time and memory of its plan.

python benchmarks/talos.py            prints the figures of benchmarks/talos.md; writes talos.html on request
python benchmarks/talos.py --html     a replay of four steps as well
"""

from __future__ import annotations

import argparse
import resource
import time
from functools import partial

import casadi as ca
import numpy as np

import robotraj as rt

LENGTH, DURATION, DOUBLE = 0.2, 0.8, 0.2
"""Step [m], its time [s], and the share of it on both feet."""
FEET = ("left_sole_link", "right_sole_link")
MESH = [rt.Mesh(n, rt.schemes.LobattoIIIA(4)) for n in (3, 5)]


def step() -> rt.Problem:
    """Double support and single support, mirrored; every limit of the URDF holds."""
    robot = rt.load("talos", root="floating")
    foot = partial(rt.FlatFoot, length=0.2, width=0.12, friction=0.6)
    posture = rt.gait.gait_objective(robot, rt.gait.stand(robot, FEET, foot))
    calm = rt.Lagrange(lambda point: 10 * ca.sumsqr(point.v[6:]) + 0.3 * ca.sumsqr(point.a[6:]))
    return rt.gait.walk(
        robot,
        feet=FEET,
        step_length=LENGTH,
        duration=DURATION,
        double_support=DOUBLE,
        clearance=0.04,
        contact=foot,
        objective=posture + calm,
    )


def memory() -> float:
    """Largest memory of this process so far [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def main() -> None:
    """Plan, check, report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--html", action="store_true", help="write talos.html")
    parser.add_argument("--check", action="store_true", help="simulate it, which takes minutes: the grippers are stiff")
    arguments = parser.parse_args()
    before = memory()
    began, used = time.perf_counter(), time.process_time()
    problem = step()
    robot = problem.phases[0].robot
    assert robot is not None
    solution = rt.plan(problem, mesh=MESH, check=False)
    took, busy = time.perf_counter() - began, time.process_time() - used
    print(solution)
    print(f"{robot.nu} motors, {robot.nv} velocities; {took:.1f} s, {busy:.1f} s of processor time")
    print(f"memory {memory():.0f} MB at most, {before:.0f} MB of them before")
    times = np.linspace(0, solution.duration, 2001)
    sample = solution.at(times)
    work = np.trapezoid(np.maximum(sample.tau * sample.v[:, 6:], 0).sum(axis=1), times)
    weight = 9.81 * sum(inertia.mass for inertia in robot.model.inertias)
    print(f"cost of transport {work / (weight * LENGTH):.3f}")
    if arguments.check:
        print(rt.validate(solution))
        print(rt.witness.second_opinion(solution, periods=3))
    if arguments.html:
        print("wrote", rt.replay(solution, "talos.html", periods=4))


if __name__ == "__main__":
    main()
