"""Roughness of least times among obstacles, with and without smoothing: `python benchmarks/smoothness.py [count]`.

Ends are drawn within the limits, and one or two boxes or posts stand near the middle of the straight motion of the last
frame. Each problem is planned by the default call and with ``smoothing=0``. Roughness is
``solution.proof.roughness``, the height of teeth of the torque that has most of them, relative to its limit. The table
goes to ``smoothness.md``, and the torques of ur5 around a post to ``smoothness.png``.

``python benchmarks/smoothness.py weights`` writes ``smoothness_weights.md``: roughness and time on a given mesh for
several weights of what alternates.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pinocchio as pin

import robotraj as rt
from robotraj.transcription.smoothness import alternation
from robotraj.transcription.smoothness.roughness import roughness

TABLE = Path(__file__).with_suffix(".md")
ROBOTS = ("ur5", "panda", "ur10", "kinova", "xarm7")
LOCKED = {"panda": {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}}
WIDEST, ROOM = 2.5, 0.1
"""Joints move within this [rad], and leave this share of their range free at both ends."""
NEAREST = 0.25
"""Least distance of an obstacle from the axis of the base [m]."""
MESH, WEIGHTS = 60, (0.0, 1.0, 3.0, 20.0)
"""Least number of intervals, and the weights of what alternates, of the table of weights."""
LIMIT = 40.0
"""Processor time of a plan [s]."""


def problems(name: str, seed: int = 1) -> Iterator[rt.Phase]:
    """Yield least times whose ends are clear of the obstacles, without end."""
    robot = rt.load(name, locked=LOCKED.get(name))
    model, data = robot.model, robot.model.createData()
    random = np.random.default_rng([seed, *name.encode()])
    low = np.maximum(robot.limits.position_lower, -WIDEST)
    high = np.minimum(robot.limits.position_upper, WIDEST)
    found = 0
    while True:
        start, end = low + (ROOM + (1 - 2 * ROOM) * random.random((2, robot.nq))) * (high - low)
        shapes: list[rt.obstacles.Obstacle] = []
        for _ in range(random.integers(1, 3)):
            pin.framesForwardKinematics(model, data, start + random.uniform(0.35, 0.65) * (end - start))
            place = data.oMf[model.nframes - 1].translation + random.normal(0.0, 0.05, 3)
            if random.random() < 0.5:
                shapes.append(rt.obstacles.Box(tuple(random.uniform(0.05, 0.25, 3)), position=tuple(place)))
            else:
                shapes.append(rt.obstacles.Cylinder(random.uniform(0.03, 0.08), 0.6, position=tuple(place)))
            if np.hypot(*place[:2]) < NEAREST:
                shapes.clear()
                break
        if not shapes:
            continue
        ends = rt.State(q=start, v=0), rt.State(q=end, v=0)
        try:
            avoid = rt.CollisionFree(shapes, margin=0.01)
            phase = rt.Phase(robot, (0.1, 20.0), *ends, rt.Duration(), [avoid], name=f"{name} {found}")
        except rt.InputError:
            continue
        found += 1
        yield phase


def planned(phase: rt.Phase, smoothing: float | None) -> tuple[rt.Solution, float]:
    """Plan a problem; also return the processor time [s]."""
    began = time.process_time()
    solution = rt.plan(phase, check=False, progress=False, time_limit=LIMIT, smoothing=smoothing)
    return solution, time.process_time() - began


def line(name: str, count: int) -> str:
    """Plan the problems of a robot and return its line of the table."""
    pairs = []
    for phase in problems(name):
        if len(pairs) == count:
            break
        try:
            (rough, before), (smooth, after) = planned(phase, 0.0), planned(phase, None)
        except rt.InputError:
            # Links overlap at an end.
            continue
        if rough.proof is None or smooth.proof is None:
            continue
        pairs.append(
            (rough.proof.roughness, smooth.proof.roughness, before, after, smooth.duration / rough.duration - 1)
        )
    first, last, before, after, longer = np.array(pairs).T
    # Durations that differ by more belong to other ways around the obstacles.
    same = longer[np.abs(longer) < 5e-3]
    cells = [
        name,
        f"{len(pairs)}",
        f"{100 * np.median(first):.1f}, {100 * first.max():.0f}",
        f"{100 * np.median(last):.1f}, {100 * last.max():.0f}",
        f"{np.mean(first > 0.02):.0%}, {np.mean(last > 0.02):.0%}",
        f"{np.median(same):.0e}, {same.max():.0e}",
        f"{np.median(before):.2f}, {np.median(after):.2f}",
    ]
    return "| " + " | ".join(cells) + " |"


def picture(path: Path) -> None:
    """Draw the torques of ur5 around a post, before and after."""
    import matplotlib.pyplot as plt

    phase = around_post()
    figure, axes = plt.subplots(1, 2, figsize=(10, 3), sharey=True)
    for axis, smoothing in zip(axes, (0.0, None), strict=True):
        solution, _ = planned(phase, smoothing)
        times = np.linspace(0.0, solution.duration, 2000)
        axis.plot(times, solution.at(times).tau[:, 1:3])
        axis.set(xlabel="t [s]", title="smoothing=0" if smoothing == 0.0 else "default")
    axes[0].set_ylabel("torques of shoulder_lift and elbow [N m]")
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def around_post() -> rt.Phase:
    """Return ur5 around a post."""
    post = rt.CollisionFree([rt.obstacles.Box((0.1, 0.1, 0.3), position=(0.52, 0.07, 0.47))], margin=0.01)
    ends = (rt.State(q=[side, -1.8, 1.6, -1.2, -1.57, 0.0], v=0) for side in (-1.1, 1.1))
    return rt.Phase(rt.load("ur5"), (0.2, 5.0), *ends, rt.Duration(), [post])


def weights() -> None:
    """Write the table of weights of what alternates."""
    problem = {"ur5, post": around_post(), "xarm7": next(problems("xarm7", 7)), "panda": next(problems("panda", 7))}
    lines = ["| motion | weight | roughness [%] | longer than without smoothing |", "|---|---|---|---|"]
    for name, phase in problem.items():
        guess = rt.plan(phase, check=False, progress=False, smoothing=0.0, time_limit=LIMIT)
        mesh = rt.Mesh(max(MESH, guess.phases[0].mesh.count))
        least = np.nan
        for weight in (None, *WEIGHTS):
            alternation.ALTERNATING = weight or 0.0
            smoothing = 0.0 if weight is None else 5e-3
            found = rt.plan(phase, mesh=mesh, guess=guess, smoothing=smoothing, check=False, progress=False)
            part = found.phases[0]
            rough = roughness(part.phase, part.trajectory, part.inputs).max()
            least = found.duration if weight is None else least
            shown = "no smoothing" if weight is None else f"{weight:g}"
            lines.append(f"| {name} | {shown} | {100 * rough:.2f} | {found.duration / least - 1:.0e} |")
    title = "Roughness and time on a given mesh, by `python benchmarks/smoothness.py weights`"
    TABLE.with_name("smoothness_weights.md").write_text("\n".join([f"{title}.", "", *lines, ""]))


def main() -> None:
    """Write the table and the picture."""
    warnings.simplefilter("ignore")
    if sys.argv[1:] == ["weights"]:
        weights()
        return
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    head = "robot | plans | roughness without smoothing, median and largest [%] | with it | above 2 %, both "
    head += "| longer by, median and largest | processor time, both, median [s]"
    lines = [f"| {head} |", "|---" * 7 + "|", *(line(name, count) for name in ROBOTS)]
    title = "Roughness of least times among boxes and posts, by `python benchmarks/smoothness.py`"
    TABLE.write_text("\n".join([f"{title}.", "", *lines, ""]))
    picture(TABLE.with_suffix(".png"))
    print(TABLE.read_text())


if __name__ == "__main__":
    main()
