"""The outermost points of a robot over a motion, which the camera frames, and its size."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from trimesh import creation

from robotraj._util.arrays import Array
from robotraj.replay_page.scene.visuals import Visual

INSTANTS = 80
"""Largest number of instants at which points are collected."""


def hull_of(visuals: Sequence[Visual], world: Array) -> Array:
    """Return the outermost points (k, 3) [m] of all visuals over a motion, in 162 directions.

    The extremes along the world's axes are among them.

    Parameters
    ----------
    visuals : sequence of Visual
    world : ndarray (m, njoints, 4, 4)
        Joint frames in the world; 80 instants are used.
    """
    picks = np.unique(np.linspace(0, len(world) - 1, INSTANTS).astype(int))
    clouds = []
    for visual in visuals:
        corners, frames = visual.corners(), world[picks, visual.joint]
        clouds.append(np.einsum("kij,nj->kni", frames[:, :3, :3], corners) + frames[:, None, :3, 3])
    points = np.concatenate([cloud.reshape(-1, 3) for cloud in clouds])
    directions = np.vstack([np.eye(3), -np.eye(3), creation.icosphere(subdivisions=2).vertices])
    return points[np.unique(np.argmax(points @ directions.T, axis=0))]


def stature_of(visuals: Sequence[Visual], frames: Array) -> float:
    """Return the longest side [m] of the box around all visuals, with joints at (njoints, 4, 4)."""
    clouds = [v.corners() @ frames[v.joint, :3, :3].T + frames[v.joint, :3, 3] for v in visuals]
    return float(np.ptp(np.concatenate(clouds), axis=0).max())
