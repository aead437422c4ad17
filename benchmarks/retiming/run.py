"""Retiming beside TOPP-RA, and limits of jerk beside Ruckig: times of the motions and processor seconds.

    python benchmarks/retiming/run.py 100

`toppra` and `ruckig` are no dependencies of robotraj; install them first. Writes RESULTS.md beside this file.
The paths are splines through five random configurations of a panda; all motions start and end at rest. TOPP-RA solves
the same problem, limits of speed and torque, on 100 and on 1000 grid points, with constraints at both ends of each
interval.
Ruckig moves from rest to rest under limits of speed, acceleration and jerk, without torques.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
import pinocchio as pin
from scipy.interpolate import CubicSpline

import robotraj as rt

LOCKED = {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}
GRIDS = (100, 1000)
ACCELERATION, JERK = 10.0, 100.0
"""Limits of the moves from rest to rest [rad/s^2, rad/s^3]."""


def spline(robot: rt.Robot, seed: int) -> CubicSpline:
    """Return a spline through five random configurations in the middle half of the ranges."""
    low, high = robot.limits.positions
    points = np.random.default_rng(seed).uniform(-0.25, 0.25, (5, robot.nq))
    return CubicSpline(np.linspace(0.0, 1.0, 5), 0.5 * (low + high) + points * (high - low))


def within(robot: rt.Robot, path: CubicSpline) -> bool:
    """Whether a spline keeps the limits of position, and the motors hold the robot everywhere on it."""
    q, data = path(np.linspace(0.0, 1.0, 201)), robot.model.createData()
    inside = (q > robot.limits.position_lower).all() and (q < robot.limits.position_upper).all()
    held = all(
        (np.abs(pin.computeGeneralizedGravity(robot.model, data, each)) < 0.9 * robot.limits.effort).all() for each in q
    )
    return bool(inside and held)


def by_toppra(robot: rt.Robot, path: CubicSpline, points: int) -> tuple[float, float]:
    """Return the duration that TOPP-RA finds, and its processor seconds."""
    import toppra
    from toppra import algorithm, constraint

    data = robot.model.createData()
    limits = (np.column_stack([-each, each]) for each in (robot.limits.velocity, robot.limits.effort))
    began = time.process_time()
    speed = constraint.JointVelocityConstraint(next(limits))
    torque = constraint.JointTorqueConstraint(
        lambda *state: pin.rnea(robot.model, data, *state),
        next(limits),
        np.zeros(robot.nv),
        discretization_scheme=constraint.DiscretizationType.Interpolation,
    )
    grid = np.linspace(0.0, 1.0, points + 1)
    own = toppra.SplineInterpolator(path.x, path(path.x), bc_type="not-a-knot")
    found = algorithm.TOPPRA([speed, torque], own, gridpoints=grid, solver_wrapper="seidel").compute_trajectory(0, 0)
    return (found.duration if found is not None else np.nan), time.process_time() - began


def by_ruckig(robot: rt.Robot, first: np.ndarray, last: np.ndarray) -> tuple[float, float]:
    """Return the duration that Ruckig finds, and its processor seconds."""
    import ruckig

    began = time.process_time()
    asked = ruckig.InputParameter(robot.nv)
    asked.current_position, asked.target_position = first, last
    asked.max_velocity = robot.limits.velocity
    asked.max_acceleration, asked.max_jerk = [ACCELERATION] * robot.nv, [JERK] * robot.nv
    found = ruckig.Trajectory(robot.nv)
    ruckig.Ruckig(robot.nv).calculate(asked, found)
    return found.duration, time.process_time() - began


def by_plan(robot: rt.Robot, first: np.ndarray, last: np.ndarray) -> tuple[float, float]:
    """Return the duration of a plan under the limits of Ruckig, and its processor seconds."""
    limits = robot.limits.with_(acceleration=ACCELERATION, effort=np.inf)
    still = rt.constraints.JointAcceleration(0.0)
    rows = [rt.constraints.JointJerk(rt.between(-JERK, JERK)), rt.AtStart(still), rt.AtEnd(still)]
    began = time.process_time()
    phase = rt.Phase(
        robot, (0.05, 20.0), rt.State(q=first, v=0), rt.State(q=last, v=0), rt.Duration(), rows, limits=limits
    )
    found = rt.plan(phase, check=False)
    return (found.duration if found.success else np.nan), time.process_time() - began


def row(name: str, ratios: list[float], seconds: list[float]) -> str:
    """Return a line of a table: median and largest ratio of durations, median and 95th percentile of seconds."""
    known = np.array(ratios)[np.isfinite(ratios)]
    times = np.array(seconds)
    return (
        f"| {name} | {len(known)} of {len(ratios)} | {np.median(known):.4f} | {known.max():.4f} "
        f"| {np.median(times):.4f} | {np.percentile(times, 95):.4f} |"
    )


def over(found: list[tuple[float, float]], others: list[float]) -> list[float]:
    """Return the ratios of durations to others."""
    return [duration / other for (duration, _), other in zip(found, others, strict=True)]


def main(count: int) -> None:
    """Measure, and write the tables."""
    robot = rt.load("panda", locked=LOCKED)
    seeds = (seed for seed in range(100 * count) if within(robot, spline(robot, seed)))
    paths = [spline(robot, next(seeds)) for _ in range(count)]
    peers = {grid: [by_toppra(robot, path, grid) for path in paths] for grid in GRIDS}
    ours, verdicts = [], []
    for path in paths:
        began = time.process_time()
        found = rt.retime(path, robot, check=False)
        ours.append((found.duration if found.success else np.nan, time.process_time() - began))
        verdicts.append(found.success and rt.validate(found).passed)
    finest = [duration for duration, _ in peers[GRIDS[-1]]]
    head = ["| | solved | median ratio | largest ratio | median s | 95 % s |", "|---|---|---|---|---|---|"]
    lines = [
        "# Retiming",
        "",
        "Written by `run.py`. Ratios are durations over those of the finest TOPP-RA, or of Ruckig; seconds are of the",
        "processor. robotraj's motions are proved between the points and are plans of the robot.",
        "",
        f"## {count} splines of seven joints, limits of speed and torque",
        "",
        *head,
        *(row(f"TOPP-RA, {grid} points", over(peers[grid], finest), [s for _, s in peers[grid]]) for grid in GRIDS),
        row("rt.retime", over(ours, finest), [s for _, s in ours]),
        "",
        f"{sum(verdicts)} of {count} motions pass `rt.validate`.",
        "",
        f"## {count} moves from rest to rest, limits of speed, acceleration and jerk",
        "",
        *head,
    ]
    low, high = robot.limits.positions
    rng = np.random.default_rng(0)
    moves = [rng.uniform(low, high, (2, robot.nq)) for _ in range(count)]
    wanted, planned = [by_ruckig(robot, *move) for move in moves], [by_plan(robot, *move) for move in moves]
    lines += [
        row("Ruckig", [1.0] * count, [s for _, s in wanted]),
        row("rt.plan", over(planned, [d for d, _ in wanted]), [s for _, s in planned]),
    ]
    text = "\n".join(lines) + "\n"
    (Path(__file__).parent / "RESULTS.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
