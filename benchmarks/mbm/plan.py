"""Least-time plans of MotionBenchMaker's problems by the default call, each checked with coal at every millisecond.

    python benchmarks/mbm/plan.py FOLDER OUT.json [FIRST LAST [NAME...]]

FOLDER has SCENARIO_ROBOT.json, ROBOT_spherized.urdf and ROBOT.srdf; the range and names such as cage_ur5 choose
problems. Processor seconds are of ``rt.Phase`` and ``rt.plan`` together; the robot is loaded once.
"""

import json
import sys
import time
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin

import robotraj as rt
from robotraj.robot.collision import read_srdf


def obstacles_of(problem):
    """Return the obstacles of a problem as values."""
    spheres = [rt.obstacles.Sphere(x[3], x[:3]) for x in problem["spheres"]]
    boxes = [rt.obstacles.Box(x[7:], x[:3], x[3:7]) for x in problem["boxes"]]
    return [*spheres, *boxes, *(rt.obstacles.Cylinder(x[7], x[8], x[:3], x[3:7]) for x in problem["cylinders"])]


class Coal:
    """The robot's spheres as in its URDF and the pairs of its SRDF, by coal."""

    def __init__(self, urdf, srdf):
        self.model = pin.buildModelFromUrdf(str(urdf))
        self.data = self.model.createData()
        self.shapes = pin.buildGeomFromUrdf(self.model, str(urdf), pin.GeometryType.COLLISION)
        self.own = len(self.shapes.geometryObjects)
        frames = [self.model.frames[shape.parentFrame] for shape in self.shapes.geometryObjects]
        allowed = {frozenset(pair) for pair in read_srdf(srdf)}
        for joint in ElementTree.parse(urdf).getroot().iter("joint"):
            ends = joint.find("parent"), joint.find("child")
            if None not in ends:
                allowed.add(frozenset(end.get("link") for end in ends))
        for a, b in combinations(range(self.own), 2):
            names = frozenset((frames[a].name, frames[b].name))
            if frames[a].parentJoint != frames[b].parentJoint and names not in allowed:
                self.shapes.addCollisionPair(pin.CollisionPair(a, b))
        self._drop_always_touching()

    def _drop_always_touching(self):
        """Pairs of links that touch in every one of many configurations are no collisions."""
        random, touching = np.random.default_rng(0), None
        for _ in range(200):
            q = random.uniform(self.model.lowerPositionLimit, self.model.upperPositionLimit)
            found = self._touching(self.shapes, q)
            touching = found if touching is None else touching & found
        for pair in list(self.shapes.collisionPairs):
            if self._links(pair) in touching:
                self.shapes.removeCollisionPair(pair)

    def _links(self, pair):
        return tuple(self.shapes.geometryObjects[i].parentFrame for i in (pair.first, pair.second))

    def _touching(self, shapes, q):
        placed = shapes.createData()
        pin.computeCollisions(self.model, self.data, shapes, placed, q, False)
        results = zip(shapes.collisionPairs, placed.collisionResults, strict=True)
        return {self._links(pair) for pair, result in results if result.isCollision()}

    def is_free(self, problem, samples):
        """Whether no pair of shapes touches in any configuration (m, nq)."""
        shapes = self.shapes.copy()
        made = [(coal.Sphere(x[3]), x[:3], (0, 0, 0, 1)) for x in problem["spheres"]]
        made += [(coal.Box(*x[7:]), x[:3], x[3:7]) for x in problem["boxes"]]
        made += [(coal.Cylinder(x[7], x[8]), x[:3], x[3:7]) for x in problem["cylinders"]]
        for k, (shape, position, quaternion) in enumerate(made):
            place = pin.SE3(pin.Quaternion(np.array(quaternion, dtype=float)).normalized(), np.array(position))
            index = shapes.addGeometryObject(pin.GeometryObject(f"obstacle {k}", 0, 0, place, shape))
            for i in range(self.own):
                if shapes.geometryObjects[i].parentJoint:
                    shapes.addCollisionPair(pin.CollisionPair(i, index))
        placed = shapes.createData()
        return not any(pin.computeCollisions(self.model, self.data, shapes, placed, q, True) for q in samples)


def planned(robot, srdf, checker, problem):
    """Return one row of the table."""
    ends = (rt.State(q=problem[end], v=0) for end in ("start", "goal"))
    began = time.process_time()
    try:
        free = rt.CollisionFree(obstacles_of(problem), srdf=srdf)
        phase = rt.Phase(robot, (0.1, 60.0), *ends, rt.Duration(), constraints=[free])
    except rt.InputError as error:
        return {"status": "REFUSED", "message": str(error)}
    solution = rt.plan(phase, check=False, progress=False)
    row = {
        "seconds": time.process_time() - began,
        "status": solution.status.name,
        "duration": solution.duration,
        "iterations": solution.iterations,
        "meshes": [(step.intervals, step.iterations) for step in solution.refinement],
    }
    if solution.success:
        times = np.append(np.arange(0.0, solution.duration, 1e-3), solution.duration)
        row["free"] = checker.is_free(problem, solution.at(times).q)
    else:
        row["message"] = str(solution)
    return row


def main(folder, out, first=0, last=100, *names):
    """Plan the problems of a folder."""
    folder, results = Path(folder), {}
    for file in sorted(folder.glob("*_*.json")):
        if names and file.stem not in names:
            continue
        robot_name = file.stem.rsplit("_", 1)[1]
        urdf, srdf = folder / f"{robot_name}_spherized.urdf", folder / f"{robot_name}.srdf"
        robot, checker = rt.load(urdf), Coal(urdf, srdf)
        rows = results[file.stem] = {}
        for index, problem in list(enumerate(json.loads(file.read_text())["problems"]))[int(first) : int(last)]:
            rows[index] = planned(robot, srdf, checker, problem)
            print(file.stem, index, {key: rows[index][key] for key in rows[index] if key != "message"}, flush=True)
            Path(out).write_text(json.dumps(results))


if __name__ == "__main__":
    main(*sys.argv[1:])
