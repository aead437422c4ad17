"""Moves from rest to rest under limits of jerk beside Ruckig, in one, three and seven joints.

    python benchmarks/retiming/jerks.py 45

`ruckig` is no dependency of robotraj; install it first. Writes JERKS.md beside this file.
Speeds, accelerations and jerks are drawn for every joint over one to two orders of magnitude, and ways that reach full
speed or do not. ``rt.plan`` is called by default. ``rt.retime`` moves along the straight line of the joints, where the
least time is Ruckig's of one joint with the least limits relative to the ways.
"""

from __future__ import annotations

import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

import robotraj as rt

JOINTS = (1, 3, 7)
FARTHEST = 19.0
"""Longest way [m], within the limits of position."""
LINK = (
    '<link name="{0}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    "</link>"
)
JOINT = (
    '<joint name="j{0}" type="prismatic"><parent link="l{0}"/><child link="l{1}"/><axis xyz="1 0 0"/>'
    '<limit lower="-20" upper="20" velocity="{2}" effort="1e6"/></joint>'
)


def chain(speeds: np.ndarray, accelerations: np.ndarray) -> rt.Robot:
    """Return prismatic joints along x that their motors never hold back."""
    parts = [LINK.format("l0")]
    for k, speed in enumerate(speeds):
        parts += [LINK.format(f"l{k + 1}"), JOINT.format(k, k + 1, speed)]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "chain.urdf")
        file.write_text(f'<robot name="chain">{"".join(parts)}</robot>')
        robot = rt.load(file, limits={"acceleration": accelerations})
    return robot


def by_ruckig(ways: np.ndarray, *limits: np.ndarray) -> float:
    """Return Ruckig's duration for limits of speed, acceleration and jerk."""
    import ruckig

    count = len(ways)
    asked, found = ruckig.InputParameter(count), ruckig.Trajectory(count)
    asked.current_position, asked.target_position = np.zeros(count), ways
    asked.max_velocity, asked.max_acceleration, asked.max_jerk = limits
    ruckig.Ruckig(count).calculate(asked, found)
    return float(found.duration)


def row(name: str, count: int, found: list[tuple[float, float, bool]]) -> str:
    """Return a line of the table."""
    off, seconds, proved = np.array(found).T
    return (
        f"| {name} | {count} | {int(proved.sum())} of {len(found)} | {np.median(off):.0e} | {off.max():.0e} "
        f"| {np.median(seconds):.2f} |"
    )


def main(count: int) -> None:
    """Plan every drawn move."""
    warnings.simplefilter("ignore")
    rng = np.random.default_rng(1)
    planned: dict[int, list[tuple[float, float, bool]]] = {joints: [] for joints in JOINTS}
    retimed: dict[int, list[tuple[float, float, bool]]] = {joints: [] for joints in JOINTS}
    for k in range(count):
        joints = JOINTS[k % len(JOINTS)]
        speed = 10.0 ** rng.uniform(-1.0, 1.0, joints)
        acceleration = speed * 10.0 ** rng.uniform(-0.3, 1.3, joints)
        jerk = acceleration * 10.0 ** rng.uniform(0.0, 2.0, joints)
        ways = rng.uniform(-1.0, 1.0, joints) * speed * 10.0 ** rng.uniform(-1.5, 1.0)
        ways *= min(1.0, FARTHEST / np.abs(ways).max())
        robot = chain(speed, acceleration)
        least = by_ruckig(ways, speed, acceleration, jerk)
        ends = rt.State(q=0, v=0), rt.State(q=ways, v=0)
        phase = rt.Phase(robot, (0.01 * least, 20.0 * least), *ends, rt.Duration(), [rt.constraints.JointJerk(jerk)])
        on_line = by_ruckig(
            np.ones(1), *(np.array([np.min(each / np.abs(ways))]) for each in (speed, acceleration, jerk))
        )
        for table, wanted, call in (
            (planned, least, lambda phase=phase: rt.plan(phase, check=False)),
            (
                retimed,
                on_line,
                lambda ways=ways, robot=robot, jerk=jerk: rt.retime(
                    np.array([0.0 * ways, ways]), robot, jerk=jerk, check=False
                ),
            ),
        ):
            began = time.process_time()
            found = call()
            proved = bool(found.proof is not None and found.proof.holds)
            table[joints].append((abs(found.duration / wanted - 1.0), time.process_time() - began, proved))
    lines = [
        "Moves from rest to rest under limits of jerk beside Ruckig.",
        "",
        f"Written by `jerks.py {count}`; see there. Differences are relative to Ruckig's duration.",
        "",
        "| | joints | proved | median difference | largest | median s |",
        "|---|---|---|---|---|---|",
        *(row("rt.plan", joints, planned[joints]) for joints in JOINTS),
        *(row("rt.retime", joints, retimed[joints]) for joints in JOINTS),
    ]
    Path(__file__).with_name("JERKS.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 45)
