"""Programs with blended corners beside stops, TOPP-RA and Ruckig: times, deviations and processor seconds.

    python benchmarks/retiming/blends.py 20

`toppra` and `ruckig` are no dependencies of robotraj; install them first. Writes BLENDS.md beside this file.
A panda moves its joints through five random configurations under limits of speed and acceleration, with the limits of
torque left out, as the peers do. TOPP-RA times the blended path of rt.Program on 2000 grid points. Ruckig moves from
stop to stop under a limit of jerk, 1000 rad/s^3, as its free version does, and so does rt.Program.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
import pinocchio as pin

import robotraj as rt

LOCKED = {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}
TOOL = "panda_hand"
ACCELERATION, JERK = 10.0, 1000.0
RADII = (0.0, 0.02, 0.05, 0.1)


def by_toppra(robot: rt.Robot, program: rt.Program) -> float:
    """Return the duration of TOPP-RA along the path of a program without stops on its way."""
    import toppra
    from toppra import algorithm, constraint

    curves = [phase.path.curve for phase in program.phases]
    ends = np.append(0.0, np.cumsum([curve.breaks[-1] - curve.breaks[0] for curve in curves]))

    class Path(toppra.interpolator.AbstractGeometricPath):
        dof = robot.nq
        path_interval = np.array([0.0, ends[-1]])

        def __call__(self, s, order=0):
            return np.array([self.at(float(each), order) for each in np.atleast_1d(s)]).squeeze()

        def at(self, s, order):
            k = min(int(np.searchsorted(ends, s, side="right")) - 1, len(curves) - 1)
            curve = curves[k]
            for _ in range(order):
                curve = curve.derivative()
            return curve(s - ends[k] + curve.breaks[0])

    limits = [np.column_stack([-x, x]) for x in (robot.limits.velocity, np.full(robot.nv, ACCELERATION))]
    rows = [constraint.JointVelocityConstraint(limits[0]), constraint.JointAccelerationConstraint(limits[1])]
    grid = np.linspace(0.0, ends[-1], 2001)
    return algorithm.TOPPRA(rows, Path(), gridpoints=grid, solver_wrapper="seidel").compute_trajectory(0, 0).duration


def by_ruckig(robot: rt.Robot, points: np.ndarray) -> float:
    """Return the duration of Ruckig from stop to stop."""
    import ruckig

    total = 0.0
    for first, last in zip(points, points[1:], strict=False):
        asked, found = ruckig.InputParameter(robot.nv), ruckig.Trajectory(robot.nv)
        asked.current_position, asked.target_position = first, last
        asked.max_velocity = robot.limits.velocity
        asked.max_acceleration, asked.max_jerk = [ACCELERATION] * robot.nv, [JERK] * robot.nv
        ruckig.Ruckig(robot.nv).calculate(asked, found)
        total += found.duration
    return total


def planned(robot: rt.Robot, points: np.ndarray, radius: float, jerk: float | None) -> tuple:
    """Return a program, its solution and the processor seconds of both."""
    began = time.process_time()
    moves = [rt.MoveJ(q, radius if k < len(points) - 2 else 0.0) for k, q in enumerate(points[1:])]
    rows = [] if jerk is None else [rt.constraints.JointJerk(jerk)]
    program = rt.Program(robot, points[0], moves, tool=TOOL, constraints=rows)
    return program, rt.plan(program), time.process_time() - began


def excess(robot: rt.Robot, program: rt.Program, points: np.ndarray, radius: float) -> float:
    """Return by how much a blend is farther from its corner than the radius, relative to it."""
    data, farthest = robot.model.createData(), -1.0
    for phase in program.phases:
        if phase.name.startswith("blend"):
            place = []
            for q in [points[int(phase.name.split()[1]) + 1], *phase.path.curve.inside(np.linspace(0, 1, 101))[0]]:
                pin.framesForwardKinematics(robot.model, data, q)
                place.append(data.oMf[robot.frame(TOOL)].translation.copy())
            farthest = max(farthest, np.linalg.norm(np.array(place[1:]) - place[0], axis=1).max() / radius - 1.0)
    return farthest


def main(count: int) -> None:
    """Plan every drawn program with every radius."""
    robot = rt.load("panda", locked=LOCKED, limits={"acceleration": ACCELERATION, "effort": np.inf})
    low, high = robot.limits.positions
    rows: dict[tuple[float, float | None], list[list[float]]] = {}
    for seed in range(count):
        points = 0.5 * (low + high) + np.random.default_rng(seed).uniform(-0.25, 0.25, (5, robot.nq)) * (high - low)
        stopped = {jerk: planned(robot, points, 0.0, jerk)[1].duration for jerk in (None, JERK)}
        ruckig = by_ruckig(robot, points)
        for radius in RADII:
            for jerk in (None, JERK):
                try:
                    program, found, seconds = planned(robot, points, radius, jerk)
                except rt.InputError as error:
                    print(f"{seed} {radius}: {error}")
                    continue
                beyond = excess(robot, program, points, radius) if radius else 0.0
                peer = ruckig if jerk else by_toppra(robot, program) if radius else np.nan
                row = [found.proof.holds, found.duration / stopped[jerk], found.duration / peer, beyond, seconds]
                rows.setdefault((radius, jerk), []).append(row)
    lines = [
        __doc__.split("\n\n")[0].replace('"', ""),
        "",
        f"Written by `blends.py {count}`; see there. Medians; the excess of the radius is relative.",
    ]
    lines += [
        "",
        "| radius [m] | jerk limit | proved | time / stops | time / peer | largest excess | s |",
    ]
    lines += ["|---|---|---|---|---|---|---|"]
    for (radius, jerk), table in sorted(rows.items(), key=str):
        values = np.array(table, dtype=float)
        middle = np.median(values, axis=0)
        peer = "Ruckig, stops" if jerk else "TOPP-RA, same path"
        ratio = f"{middle[2]:.4f} ({peer})" if np.isfinite(middle[2]) else "-"
        lines.append(
            f"| {radius:g} | {jerk or '-'} | {int(values[:, 0].sum())} of {len(values)} | {middle[1]:.3f} | {ratio} | "
            f"{values[:, 3].max():.1e} | {middle[4]:.2f} |"
        )
    (Path(__file__).parent / "BLENDS.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
