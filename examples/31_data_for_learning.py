"""Random reaches as data for learning: LeRobot's folder, robomimic's file, and arrays."""

import tempfile
from pathlib import Path

import numpy as np

import robotraj as rt

arm = rt.load("two_link_arm")


def make(case: dict[str, float]) -> rt.Phase:
    """Reach a configuration."""
    start, end = rt.State(q=[0.0, 0.3], v=0), rt.State(q=[case["shoulder"], case["elbow"]], v=0)
    return rt.Phase(arm, 6.0, start, end, rt.Effort(), name="reach")


print(rt.plan(make({"shoulder": 1.0, "elbow": 0.4})).objective)
random = np.random.default_rng(0)
cases = [{"shoulder": s, "elbow": e} for s, e in random.uniform((0.8, 0.2), (1.4, 0.6), (6, 2)).tolist()]
folder = Path(tempfile.mkdtemp())
study = rt.sweep(make, cases, store=folder / "study", time_limit=20)
print(study)

motions = [study.motion(key) for key in study.table["key"].to_pylist()]
print("states:", np.stack([np.hstack([motion["q"], motion["v"]]) for motion in motions]).shape)
print("LeRobot:", study.to_lerobot(folder / "lerobot", rate=50, task="reach", robot_type="two_link_arm"))
try:
    print("robomimic:", study.to_robomimic(folder / "reach.hdf5", rate=50, scale=arm.limits.effort))
except rt.InputError as missing:
    print(missing)
