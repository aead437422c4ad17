"""How far a robot reaches."""

from __future__ import annotations

import numpy as np

from robotraj.robot.robot import Robot


def reach(robot: Robot) -> float:
    """Return the longest path through joints and links from the first one to a frame or a centre of mass [m]."""
    model = robot.model
    paths = np.zeros(model.njoints)
    for joint in range(1, model.njoints):
        above = model.parents[joint]
        paths[joint] = paths[above] + np.linalg.norm(model.jointPlacements[joint].translation)
    masses = [paths[i] + np.linalg.norm(body.lever) for i, body in enumerate(model.inertias) if body.mass > 0.0]
    frames = [paths[frame.parentJoint] + np.linalg.norm(frame.placement.translation) for frame in model.frames]
    return float(max([*masses, *frames], default=0.0))
