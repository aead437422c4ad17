"""One robot in a process of its own: `python benchmarks/robots/one_file.py ROBOT [legged]` prints a line of JSON.

ROBOT is a URDF file or a name of robotraj's catalogue. Stages: load, agreement with ``reader.py``, then three reaches
of effort and one of least time, or gaits of a legged robot. Reaches are drawn as in ``benchmarks/proven/reaches.py``.
"""

from __future__ import annotations

import json
import resource
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from reader import MOVING, Tree

import robotraj as rt
from robotraj.robot.coupling.dynamics import mass_matrix
from robotraj.robot.known_robots.catalogue import find

LARGEST_SHARE = 1e-9
"""Difference from the independent reader that counts as rounding, relative to the size of the quantity."""
LIMIT = 20.0
"""Processor seconds of one plan."""
WHOLE, MEMORY = 600, 8 * 2**30
"""Processor seconds and bytes of one file; its process ends there."""
DRAWS = 24
"""Reaches that are drawn at most for a file."""
WIDEST, ROOM, FASTEST, UNLIMITED_SPEED = 3.0, 0.05, 50.0, 3.0
"""Joints move within this [rad], with that share of their range free at either end. Faster limits [rad/s, m/s] are
placeholders; the last is the speed of joints without one."""


def agreement(robot: rt.Robot, path: Path, random: np.random.Generator) -> float:
    """Return the largest difference from the independent reader, relative to the size of each quantity."""
    tree = Tree(path)
    names, model, worst = robot.velocity_names, robot.model, 0.0
    data = model.createData()
    unknown = [name for name in names if name not in tree.joints or tree.joints[name].kind not in MOVING]
    if unknown:
        raise ValueError(f"joints that the independent reader does not know: {', '.join(unknown)}")
    low, high = ends_of(robot)
    rotor = np.array(model.armature)
    for _ in range(3):
        q = low + random.random(robot.nq) * (high - low)
        positions = dict(zip(names, q, strict=True))
        _, mass, gravity = tree.dynamics(positions, names)
        still = np.zeros(robot.nv)
        own = mass_matrix(model, data, q) - np.diag(rotor)
        weight = np.array(pin.rnea(model, data, q, still, still))
        pin.framesForwardKinematics(model, data, q)
        poses = [(data.oMf[robot.frame(link)].homogeneous, tree.pose(link, positions)) for link in tree.links]
        for a, b in ((own, mass), (weight, gravity), *poses):
            worst = max(worst, float(np.max(np.abs(a - b), initial=0.0) / max(np.max(np.abs(b), initial=0.0), 1e-9)))
    return worst


def ends_of(robot: rt.Robot) -> tuple[np.ndarray, np.ndarray]:
    """Return the ranges within which reaches are drawn, from the limits of the file."""
    limits = robot.limits
    low, high = np.maximum(limits.position_lower, -WIDEST), np.minimum(limits.position_upper, WIDEST)
    return low + ROOM * (high - low), high - ROOM * (high - low)


def reaches(robot: rt.Robot, random: np.random.Generator) -> list[dict[str, Any]]:
    """Plan three reaches of effort and one of least time, and return what came of them.

    Ends at which links overlap are no reaches: others are drawn, up to ``DRAWS`` times.
    """
    low, high = ends_of(robot)
    given = robot.limits.largest("velocity")
    speeds, found, draws = np.where(given < FASTEST, given, UNLIMITED_SPEED), [], 0
    while len(found) < 4:
        draws += 1
        start, end = low + random.random((2, robot.nq)) * (high - low)
        bound = float(np.max(np.abs(end - start) / speeds))
        effort = len(found) < 3
        duration = (1.05 + 1.95 * random.random()) * bound if effort else (0.5 * bound, 20.0 * bound + 1.0)
        objective = rt.Effort() if effort else rt.Duration()
        ends = rt.State(q=start, v=0), rt.State(q=end, v=0)
        phase = rt.Phase(robot, duration, *ends, objective, name="effort" if effort else "least time")
        result = planned(phase, phase.name)
        overlaps = result["outcome"] == "refused" and "overlap" in str(result["cause"])
        if overlaps and draws >= DRAWS:
            result["outcome"] = "infeasible"
        if not overlaps or draws >= DRAWS:
            found.append(result)
    return found


def held(phase: rt.Phase) -> bool:
    """Return whether the motors of a robot can hold it at both ends of a reach."""
    robot, bounds = phase.robot, (phase.start_bounds, phase.end_bounds)
    model, still = robot.model, np.zeros(robot.nv)
    data = model.createData()
    low, high = robot.limits.effort_lower, robot.limits.effort_upper
    pulls = [np.array(pin.rnea(model, data, side.lower[: robot.nq], still, still)) for side in bounds]
    return all(bool(np.all(pull > low) and np.all(pull < high)) for pull in pulls)


def loaded(source: Path | str, **options: Any) -> rt.Robot:
    """Load a file, trusting its paths, or a robot of the catalogue."""
    return rt.load(source, trust_paths=isinstance(source, Path), **options)


def movable(robot: rt.Robot, source: Path | str) -> tuple[rt.Robot, list[str]]:
    """Return the robot with joints at rest whose limits allow no plan, as their refusal proposes; and their names."""
    names = list(robot.limits.faults(robot.actuated))
    if not names or len(names) == robot.nv:
        return robot, []
    at = {name: float(robot.neutral[robot.velocity_names.index(name)]) for name in names}
    return loaded(source, locked=at), names


def planned(problem: Any, kind: str) -> dict[str, Any]:
    """Plan by the default call and return what came of it."""
    began = time.process_time()
    try:
        solution = rt.plan(problem, check=False, progress=False, time_limit=LIMIT)
    except rt.InputError as error:
        return {"kind": kind, "outcome": "refused", "cause": str(error), "seconds": time.process_time() - began}
    proved = bool(solution.success and solution.proof is not None and solution.proof.holds)
    seconds = time.process_time() - began
    outcome = "proved" if proved else str(solution.status.value)
    found = {"kind": kind, "outcome": outcome, "seconds": seconds, "cause": "" if proved else solution.message}
    if not proved and kind == "effort":
        found["least"] = least_time(problem)
        if not held(problem) or problem.duration_bounds[1] < found["least"] < np.inf:
            found["outcome"] = "infeasible"
    if not proved and kind == "least time" and not held(problem):
        found["outcome"] = "infeasible"
    return found


def least_time(phase: rt.Phase) -> float:
    """Return the least time [s] found between the ends of a reach; infinite where none is."""
    duration = phase.duration_bounds[1]
    free = phase.with_(duration=(0.5 * duration, 20.0 * duration), objective=rt.Duration())
    solution = rt.plan(free, check=False, progress=False, time_limit=LIMIT)
    return float(solution.duration) if solution.success else float("inf")


def gaits(source: Path | str) -> list[dict[str, Any]]:
    """Return the gaits that fit the number of feet, planned at a moderate speed."""
    robot = loaded(source, root="floating")
    from robotraj.gait.feet import feet_of

    feet = feet_of(robot, None)
    q = rt.gait.stand(robot)
    model = robot.model
    data = model.createData()
    centre = np.array(pin.centerOfMass(model, data, q))
    pin.framesForwardKinematics(model, data, q)
    height = float(centre[2] - min(data.oMf[robot.frame(foot)].translation[2] for foot in feet))
    speed = 0.1 * float(np.sqrt(9.81 * height))
    kinds = {2: rt.gait.walk, 4: rt.gait.trot}
    if len(feet) not in kinds:
        cause = f"{len(feet)} feet: {', '.join(feet)}"
        return [{"kind": "gait", "outcome": "refused", "cause": cause, "seconds": 0.0}]
    gait = kinds[len(feet)]
    problem = gait(robot, step_length=speed * 0.4 * np.sqrt(height / 0.3), speed=speed)
    return [planned(problem, gait.__name__)]


def report(source: Path | str, legged: bool) -> dict[str, Any]:
    """Return what came of a robot, stage by stage."""
    path = source if isinstance(source, Path) else find(source).urdf
    found: dict[str, Any] = {"file": str(path), "load": "ok", "agreement": None, "plans": [], "cause": ""}
    random = np.random.default_rng([*(path.name if source is path else str(source)).encode()])
    try:
        robot = loaded(source)
    except rt.InputError as error:
        return {**found, "load": "refused", "cause": str(error)}
    except Exception as error:  # a traceback is a fault of robotraj's
        return {**found, "load": "error", "cause": f"{type(error).__name__}: {error}"}
    found |= {"joints": robot.nv, "mass": robot.mass}
    try:
        # Robots of the catalogue hold some joints still, elsewhere than at 0.
        found["agreement"] = agreement(robot if source is path else loaded(path), path, random)
    except (ValueError, KeyError, AssertionError, SyntaxError) as error:
        found["cause"] = f"not compared: {error}"
    try:
        if legged:
            found["plans"] = gaits(source)
        elif robot.nv:
            robot, found["still"] = movable(robot, source)
            found["plans"] = reaches(robot, random)
    except rt.InputError as error:
        found["cause"] = f"refused: {error}"
    except Exception as error:
        found |= {"load": "error", "cause": f"{type(error).__name__}: {error}"}
    return found


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CPU, (WHOLE, WHOLE))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    warnings.simplefilter("ignore")
    given = sys.argv[1]
    print(json.dumps(report(Path(given) if given.endswith(".urdf") else given, len(sys.argv) > 2)))
