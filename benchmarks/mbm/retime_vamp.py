"""VAMP's simplified paths, retimed by toppra with the limits of the URDF: the motions to compare with.

Runs in an environment of its own: ``pip install vamp-planner toppra pin``. Usage:

    python retime_vamp.py FOLDER OUT.json

writes for every problem the duration of the retimed path [s] and the processor seconds of both libraries. Entries are
null where VAMP finds no path or toppra no times. Torque limits hold through inverse dynamics, and velocity limits are
those of the URDF. The path is the cubic spline through the corners of the simplified path, by their distances.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
import pinocchio as pin
import toppra
import toppra.algorithm
import toppra.constraint
import vamp

GRID = 200


def environment(problem):
    """Give VAMP the obstacles of a problem; its cylinders are capsules."""
    env = vamp.Environment()
    for x in problem["spheres"]:
        env.add_sphere(vamp.Sphere(x[:3], x[3]))
    for x in problem["boxes"]:
        env.add_cuboid(vamp.Cuboid(x[:3], euler(x[3:7]), [0.5 * side for side in x[7:]]))
    for x in problem["cylinders"]:
        env.add_capsule(vamp.Cylinder(x[:3], euler(x[3:7]), x[7], x[8]))
    return env


def euler(quaternion):
    """Return the angles (x, y, z) of a quaternion (x, y, z, w), R = Rx Ry Rz as VAMP composes them."""
    r = pin.Quaternion(*np.roll(quaternion, 1)).normalized().toRotationMatrix()
    return [np.arctan2(-r[1, 2], r[2, 2]), np.arcsin(np.clip(r[0, 2], -1, 1)), np.arctan2(-r[0, 1], r[0, 0])]


def retimed(model, data, corners):
    """Return the least duration [s] on the spline through corners (m, n); None where toppra finds none."""
    steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    corners = corners[np.concatenate([[True], steps > 1e-6])]
    places = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    path = toppra.SplineInterpolator(places, corners)
    speeds, torques = model.upperVelocityLimit, model.upperEffortLimit

    def dynamics(q, v, a):
        return pin.rnea(model, data, q, v, a).copy()

    limits = [
        toppra.constraint.JointVelocityConstraint(np.column_stack([-speeds, speeds])),
        toppra.constraint.JointTorqueConstraint(dynamics, np.column_stack([-torques, torques]), np.zeros(model.nv)),
    ]
    grid = np.linspace(0.0, places[-1], GRID)
    instance = toppra.algorithm.TOPPRA(limits, path, gridpoints=grid, parametrizer="ParametrizeSpline")
    found = instance.compute_trajectory(0.0, 0.0)
    return None if found is None else float(found.duration)


def main(folder, out):
    """Retime the paths of all problems of a folder."""
    results = {}
    for file in sorted(Path(folder).glob("*_*.json")):
        scenario, robot = file.stem.rsplit("_", 1)
        model = pin.buildModelFromUrdf(str(Path(folder) / f"{robot}_spherized.urdf"))
        data = model.createData()
        module, planner, settings, simplify = vamp.configure_robot_and_planner_with_kwargs(robot, "rrtc")
        rows = []
        for problem in json.loads(file.read_text())["problems"]:
            env, sampler = environment(problem), module.halton()
            began = time.process_time()
            found = planner(np.array(problem["start"]), np.array(problem["goal"]), env, settings, sampler)
            path = module.simplify(found.path, env, simplify, sampler).path if found.solved else None
            planned = time.process_time()
            duration = None if path is None else retimed(model, data, np.array(path.numpy(), dtype=float))
            row = {"duration": duration, "vamp": planned - began, "toppra": time.process_time() - planned}
            rows.append(row)
        results[file.stem] = rows
        given = [row["duration"] for row in rows if row["duration"]]
        print(f"{file.stem}: {len(given)} of {len(rows)} retimed, median {np.median(given):.3g} s", flush=True)
    Path(out).write_text(json.dumps(results))


if __name__ == "__main__":
    toppra.setup_logging("ERROR")
    main(*sys.argv[1:3])
