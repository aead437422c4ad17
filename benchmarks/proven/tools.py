"""Random motions of a tool within narrow limits: `python benchmarks/proven/tools.py [--count N] [--seed S] [kind ...]`.

Each is planned by the default call, and judged by `rt.validate` in the same process. Kinds, in the order of drawing:

| kind | the motion |
|---|---|
| speed | least time between two postures, the speed of the tool at most 0.1 to 0.8 m/s |
| acceleration | the same with the acceleration of the tool at most 0.5 to 8 m/s^2, every second one with a speed too |
| frames | the same with the speeds of the tool and of a link before it, each with its own limit |
| tilt | along a straight line of 0.1 to 0.35 m, an axis of the tool within 0.1 to 5 degrees of its direction |
| slot | along such a line between two plates that leave 5 to 20 mm on either side of the tool's spheres |
| region | to a pose within 0.05 to 2 mm and 0.05 to 1 degrees |
| band | along such a line in motion, the speed along it within 0.2 to 5 percent of a mean |

Postures are drawn within the limits of the joints; every other motion is among those known to exist: lines are followed
by inverse kinematics with the orientation kept, links at the ends are apart. Every second slot also keeps the links of
the arm apart from each other by its spheres. The table goes to `TOOLS.md`.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
import warnings
from contextlib import suppress
from pathlib import Path

import numpy as np
import pinocchio as pin

import robotraj as rt
from robotraj._util.arrays import Array

TABLE = Path(__file__).with_name("TOOLS.md")
COUNT, SEED = 42, 1
LIMIT = 12
"""Time limit of a plan [s]; a motion that takes longer is not proved."""
KINDS = ("speed", "acceleration", "frames", "tilt", "slot", "region", "band")
TOOLS = {
    "ur5": ("tool0", "wrist_1_link"),
    "panda": ("panda_hand_tcp", "panda_link5"),
    "ur10": ("tool0", "wrist_1_link"),
    "kinova": ("j2s6s200_end_effector", "j2s6s200_link_4"),
    "xarm7": ("link_eef", "link4"),
    "ur3": ("tool0", "wrist_1_link"),
}
"""The tool of each arm, and a link before it."""
LOCKED = {"panda": {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}}
WIDEST, ROOM = 2.6, 0.08
"""Joints are drawn within this [rad], and leave a share of their range free at either end."""
FARTHEST = 2.0
"""Largest travel of a joint between two postures [rad]."""
LEAST_SINGULAR = 0.05
"""Least singular value of the tool's Jacobian along a line that is followed."""
STEPS = 40
"""Places of a line at which inverse kinematics is solved."""
TRIES = 2000


class Arm:
    """An arm with its tool, and what the drawing needs of its kinematics."""

    def __init__(self, name: str) -> None:
        self.robot = rt.load(name, locked=LOCKED.get(name))
        self.tool, self.link = TOOLS[name]
        self.data = self.robot.model.createData()
        model = self.robot.model
        low, high = np.maximum(model.lowerPositionLimit[: model.nv], -WIDEST), model.upperPositionLimit[: model.nv]
        high = np.minimum(high, low + 2.0 * WIDEST)
        self.low, self.high = low + ROOM * (high - low), high - ROOM * (high - low)

    def pose(self, q: Array, frame: str | None = None) -> pin.SE3:
        """Return the pose of the tool."""
        pin.framesForwardKinematics(self.robot.model, self.data, q)
        return pin.SE3(self.data.oMf[self.robot.frame(frame or self.tool)])

    def jacobian(self, q: Array) -> Array:
        """Return the Jacobian of the tool in its own axes (6, nv)."""
        frame = self.robot.frame(self.tool)
        return np.asarray(pin.computeFrameJacobian(self.robot.model, self.data, q, frame, pin.LOCAL))

    def free(self, q: Array) -> bool:
        """Whether no links overlap."""
        if not hasattr(self, "_body"):
            from robotraj.robot.collision.own_body import own_body

            self._body = own_body(self.robot, ())
        from robotraj.robot.collision.along_motion import pairs_within

        return not pairs_within(self.robot, self._body, q[None, :], 0.0).any()

    def posture(self, rng: np.random.Generator, near: Array | None = None) -> Array:
        """Draw a posture without overlaps whose tool is above the base, within ``FARTHEST`` of another."""
        for _ in range(TRIES):
            low, high = self.low, self.high
            if near is not None:
                low, high = np.maximum(low, near - FARTHEST), np.minimum(high, near + FARTHEST)
            q = low + (high - low) * rng.random(len(low))
            place = self.pose(q).translation
            singular = np.linalg.svd(self.jacobian(q), compute_uv=False)[-1]
            if place[2] > 0.1 and np.hypot(*place[:2]) > 0.2 and singular > LEAST_SINGULAR and self.free(q):
                return q
        raise RuntimeError("no posture was drawn")

    def followed(self, q: Array, way: Array) -> Array | None:
        """Return postures along a straight line of the tool with its orientation kept, (STEPS + 1, nq)."""
        first, found = self.pose(q), [q]
        for k in range(1, STEPS + 1):
            wanted = pin.SE3(first.rotation, first.translation + k / STEPS * way)
            x = found[-1]
            for _ in range(20):
                error = pin.log6(self.pose(x).actInv(wanted)).vector
                if np.abs(error).max() < 1e-10:
                    break
                x = x + np.linalg.pinv(self.jacobian(x)) @ error
            singular = np.linalg.svd(self.jacobian(x), compute_uv=False)[-1]
            inside = (x > self.low).all() and (x < self.high).all()
            if np.abs(error).max() > 1e-8 or singular < LEAST_SINGULAR or not inside or not self.free(x):
                return None
            found.append(x)
        return np.array(found)

    def line(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """Draw a line (3,) that the tool follows, and the postures along it."""
        for _ in range(TRIES):
            q, way = self.posture(rng), rng.normal(size=3)
            way *= rng.uniform(0.1, 0.35) / np.linalg.norm(way)
            followed = self.followed(q, way)
            if followed is not None:
                return way, followed
        raise RuntimeError("no line was drawn")

    def spheres_within(self, q: Array, normal: Array, near: float) -> float:
        """Return how far spheres of links near the tool reach on either side of a plane through the tool [m]."""
        tool = self.pose(q)
        spheres = rt.robot.collision.robot_spheres(self.robot)
        pin.forwardKinematics(self.robot.model, self.data, q)
        places = np.array([self.data.oMi[int(j)].act(c) for j, c in zip(spheres.joint, spheres.centre, strict=True)])
        moved = places - tool.translation
        close = np.linalg.norm(moved, axis=1) - spheres.radius < near
        return float(np.max(np.abs(moved[close] @ normal) + spheres.radius[close]))


def phase_of(arm: Arm, start: rt.State, end: rt.State, constraints: list[object], name: str) -> rt.Phase:
    """Return a phase of least time."""
    return rt.Phase(arm.robot, (0.05, 30.0), start, end, rt.Duration(), constraints, name=name)


def drawn(kind: str, arm: Arm, rng: np.random.Generator, even: bool, name: str) -> rt.Phase:
    """Draw a problem of a kind."""
    tool, degrees = arm.tool, np.deg2rad
    if kind in ("speed", "acceleration", "frames"):
        q = arm.posture(rng)
        goal = arm.posture(rng, q)
        v = np.exp(rng.uniform(np.log(0.1), np.log(0.8)))
        a = np.exp(rng.uniform(np.log(0.5), np.log(8.0)))
        if kind == "acceleration":
            limits = [rt.constraints.FrameAcceleration(tool, linear=a)]
            limits += [rt.constraints.FrameSpeed(tool, linear=v)] if even else []
        else:
            limits = [rt.constraints.FrameSpeed(tool, linear=v, angular=1.0 if even else None)]
            limits += (
                [rt.constraints.FrameSpeed(arm.link, linear=v * rng.uniform(0.3, 1.0))] if kind == "frames" else []
            )
        return phase_of(arm, rt.State(q=q, v=0), rt.State(q=goal, v=0), limits, name)
    if kind == "region":
        q = arm.posture(rng)
        goal = arm.posture(rng, q)
        width, angle = np.exp(rng.uniform(np.log([5e-5, 0.05]), np.log([2e-3, 1.0])))
        axis = (0, 0, 1) if even else None
        region = rt.constraints.PoseRegion(
            tool, arm.pose(goal), position=rt.between(-width, width), free_axis=axis, angle=degrees(angle)
        )
        return phase_of(arm, rt.State(q=q, v=0), rt.State(v=0), [rt.AtEnd(region)], name)
    way, along = arm.line(rng)
    first, last = arm.pose(along[0]), arm.pose(along[-1])
    line = rt.constraints.LinearPath(tool, first.translation, last.translation)
    start, there = rt.State(q=along[0], v=0), rt.AtEnd(rt.FramePose(tool, last))
    if kind == "tilt":
        angle = np.exp(rng.uniform(np.log(0.1), np.log(5.0)))
        axis = rt.constraints.FrameAxis(tool, axis=(0, 0, 1), direction=first.rotation[:, 2], angle=degrees(angle))
        return phase_of(arm, start, rt.State(v=0), [line, axis, there], name)
    if kind == "band":
        d = way / np.linalg.norm(way)
        mean, share = rng.uniform(0.05, 0.3), np.exp(rng.uniform(np.log(2e-3), np.log(5e-2)))
        twist = np.concatenate([first.rotation.T @ d * mean, np.zeros(3)])
        begin = rt.State(q=along[0], v=np.linalg.pinv(arm.jacobian(along[0])) @ twist)
        band = rt.PathConstraint(
            lambda point: sum(float(d[i]) * point.frame(tool).velocity[i] for i in range(3)),
            lower=mean * (1 - share),
            upper=mean * (1 + share),
            name="speed along the line",
            unit="m/s",
        )
        there = rt.AtEnd(rt.FramePosition(tool, last.translation))
        return phase_of(arm, begin, rt.State(), [line, band, there], name)
    # The plates stand beside the second half of the line.
    normal = np.cross(way, rng.normal(size=3))
    normal /= np.linalg.norm(normal)
    depth, gap = 0.5 * float(np.linalg.norm(way)), rng.uniform(0.005, 0.02)
    reach = max(arm.spheres_within(q, normal, depth + 0.1) for q in along[len(along) // 2 :])
    turn = np.column_stack([way / np.linalg.norm(way), normal, np.cross(way / np.linalg.norm(way), normal)])
    quaternion = pin.Quaternion(turn).coeffs()
    plates = [
        rt.obstacles.Box(
            (depth, 0.02, 0.2),
            position=last.translation - 0.25 * way + side * (reach + gap + 0.01) * normal,
            quaternion=quaternion,
            name=f"plate {side:+d}",
        )
        for side in (1, -1)
    ]
    clear = rt.CollisionFree(plates, self_collision=even)
    return phase_of(arm, start, rt.State(v=0), [clear, rt.AtEnd(rt.FramePose(tool, last))], name)


def problem_of(number: int, seed: int) -> tuple[str, rt.Phase]:
    """Return the kind of a problem, and the problem."""
    kind, names = KINDS[number % len(KINDS)], tuple(TOOLS)
    turn = number // len(KINDS)
    name = names[(number + turn) % len(names)]
    arm, rng = Arm(name), np.random.default_rng([seed, number])
    for _ in range(TRIES):
        # Phases are refused whose ends are in collision, as of an arm whose elbow reaches into a plate.
        with suppress(rt.InputError):
            return kind, drawn(kind, arm, rng, bool(turn % 2), f"{kind} {name} {number}")
    raise RuntimeError("no problem was drawn")


def one(number: int, seed: int) -> dict[str, object]:
    """Plan and validate a problem in this process."""
    warnings.simplefilter("ignore")
    kind, phase = problem_of(number, seed)
    rt.plan(rt.Phase(rt.load("block"), 1.0, rt.State(q=0), rt.State(q=1), rt.Effort()), check=False, progress=False)
    began = time.process_time()
    solution = rt.plan(phase, check=False, progress=False, time_limit=LIMIT)
    seconds = time.process_time() - began
    proof = solution.proof
    proved = bool(solution.success and proof is not None and proof.holds)
    passed = proved and rt.validate(solution).passed
    remark = "" if proved else solution.message if not solution.success else ", ".join(map(str, proof.lacks))
    return {
        "number": number,
        "kind": kind,
        "name": phase.name,
        "proved": proved and passed,
        "seconds": seconds,
        "duration": solution.duration,
        "meshes": len(solution.refinement),
        "iterations": solution.iterations,
        "status": solution.status.value,
        "rounds": [str(each) for each in solution.rounds],
        "remark": (remark if proved or remark else "") or ("" if passed else "validation fails"),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("kinds", nargs="*", default=list(KINDS))
    parser.add_argument("--count", type=int, default=COUNT)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--only", type=int, nargs="*", help="numbers of problems")
    parser.add_argument("--log", type=Path)
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one is not None:
        print(json.dumps(one(given.one, given.seed)))
        return
    numbers = given.only or [n for n in range(given.count) if KINDS[n % len(KINDS)] in given.kinds]
    found: list[dict[str, object]] = []
    for number in numbers:
        command = [sys.executable, __file__, "--one", str(number), "--seed", str(given.seed)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=10 * LIMIT)
        except subprocess.TimeoutExpired:
            print(f"{number:3d} was stopped", flush=True)
            continue
        if done.returncode:
            print(number, done.stderr.strip().splitlines()[-1:], flush=True)
            continue
        each = json.loads(done.stdout.splitlines()[-1])
        found.append(each)
        print(
            f"{each['number']:3d} {each['name']:28s} {'yes' if each['proved'] else 'NO ':3s} {each['seconds']:7.2f} s "
            f"T {each['duration']:.3f} meshes {each['meshes']} it {each['iterations']} {each['status']} "
            f"{str(each['remark'])[:150]!r}",
            flush=True,
        )
        if given.log:
            with given.log.open("a") as log:
                log.write(json.dumps(each) + "\n")
    rows = list(table(found))
    print("\n".join(rows))
    if not given.only and given.kinds == list(KINDS):
        head = (
            f"Written by `python benchmarks/proven/tools.py --count {given.count} --seed {given.seed}`: default calls, "
            "each in a fresh process, processor seconds. That file describes the kinds."
        )
        TABLE.write_text("\n".join(["# Tools within narrow limits", "", head, "", *rows, ""]))


def table(found: list[dict[str, object]]) -> list[str]:
    """Return a row for each kind, and one for all."""
    rows = ["| kind | problems | proved | median [s] | worst [s] |", "|---|---:|---:|---:|---:|"]
    for kind in (*KINDS, "all"):
        own = [each for each in found if kind in (each["kind"], "all")]
        if own:
            seconds = np.array([each["seconds"] for each in own], dtype=float)
            proved = sum(bool(each["proved"]) for each in own)
            rows.append(f"| {kind} | {len(own)} | {proved} | {np.median(seconds):.2f} | {seconds.max():.2f} |")
    return rows


if __name__ == "__main__":
    main()
