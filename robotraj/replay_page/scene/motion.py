"""A solution's motion as poses of every joint relative to its parent, with keys where they are needed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.solution.cycles.gait_cycles import CyclePhase, GaitCycles
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.planned import Planned

FINEST = 8
"""Largest number of keys in a frame, a power of two."""
MOST = 1_000_000
"""Largest number of samples: an hour of motion at 30 frames per second takes 864,000."""
TOLERANCE = 1e-5
"""Largest difference [m, rad] between a joint's pose and the interpolated one, if FINEST allows."""


@dataclass(frozen=True)
class SceneMotion(OneLine):
    """A robot over a whole solution, sampled on a fine time grid.

    Attributes
    ----------
    times : (m,)
        Global times [s], increasing, with every phase boundary once.
    q : (m, nq)
        Configurations [rad, m].
    position : (m, njoints, 3)
        Origin of each joint's frame [m] in its parent joint's frame.
    quaternion : (m, njoints, 4)
        Orientation (x, y, z, w) in the same frame, sign-continuous in time.
    world : (m, njoints, 4, 4)
        Joint frames in the world.
    """

    times: Array
    q: Array
    position: Array
    quaternion: Array
    world: Array


def motion_of(model: pin.Model, solution: Planned | GaitCycles, fps: int) -> SceneMotion:
    """Sample every phase in steps of 1 / (FINEST fps), and compute the poses of all joints.

    At a boundary the later phase is evaluated, except at the end of the motion.

    Parameters
    ----------
    model : pin.Model
    solution : Solution or GaitCycles
    fps : int

    Raises
    ------
    InputError
        The motion takes more than ``MOST`` samples.
    """
    length = sum(phase.duration for phase in solution.phases)
    if not length * fps * FINEST < MOST:
        raise InputError(
            f"replay: {length:.6g} s of motion at fps={fps} take more than {MOST} samples; give a smaller fps, or "
            "replay a shorter motion."
        )
    times, rows = [], []
    phases: Sequence[PhaseSolution | CyclePhase] = solution.phases
    for number, phase in enumerate(phases):
        steps = max(int(np.ceil(phase.duration * fps * FINEST - 1e-9)), 1)
        grid = phase.t0 + np.minimum(np.arange(steps + 1) / (fps * FINEST), phase.duration)
        if number < len(phases) - 1:
            grid = grid[:-1]
        times.append(grid)
        rows.append(np.asarray(phase.at(grid).q, dtype=float).reshape(len(grid), model.nq))
    stamps, q = np.concatenate(times), np.concatenate(rows)
    data = model.createData()
    local = np.tile(np.eye(4), (len(stamps), model.njoints, 1, 1))
    world = local.copy()
    for k, configuration in enumerate(q):
        pin.forwardKinematics(model, data, configuration)
        for joint in range(1, model.njoints):
            local[k, joint] = data.liMi[joint].homogeneous
            world[k, joint] = data.oMi[joint].homogeneous
    return SceneMotion(stamps, q, local[:, :, :3, 3], _quaternions(local[:, :, :3, :3]), world)


def centre_of_mass(model: pin.Model, motion: SceneMotion) -> dict[str, list[float]] | None:
    """Return times ``t`` (m,) [s] and places ``p`` (m, 3) [m], row by row, one a frame; None without mass."""
    if not sum(inertia.mass for inertia in model.inertias[1:]) > 0.0:
        return None
    # Phase boundaries are no frames, so samples are picked by their number.
    picks = np.unique(np.append(np.arange(0, len(motion.times), FINEST), len(motion.times) - 1))
    data = model.createData()
    places = np.array([pin.centerOfMass(model, data, motion.q[k]) for k in picks])
    return {
        "t": [float(f"{t:.7g}") for t in motion.times[picks]],
        "p": [float(f"{x:.5g}") for x in places.ravel()],
    }


def _quaternions(rotation: Array) -> Array:
    """Convert rotations (m, n, 3, 3) to quaternions (x, y, z, w), neighbours in time on one hemisphere."""
    m, n = rotation.shape[:2]
    quaternion = Rotation.from_matrix(rotation.reshape(-1, 3, 3)).as_quat().reshape(m, n, 4)
    flips = np.sum(quaternion[1:] * quaternion[:-1], axis=-1) < 0.0
    sign = np.where(np.cumsum(flips, axis=0) % 2 == 1, -1.0, 1.0)
    quaternion[1:] *= sign[..., None]
    return np.asarray(quaternion)


def keys(position: Array, quaternion: Array) -> NDArray[np.intp]:
    """Choose the samples of one joint for the page: one a frame, more where interpolation errs by TOLERANCE.

    Starting from every FINEST-th sample, an interval is halved where its midpoint differs from the mean of its ends.
    Its halves are halved again. Positions are interpolated linearly, rotations on the great arc.

    Parameters
    ----------
    position : (m, 3)
    quaternion : (m, 4)

    Returns
    -------
    (k,) indices, increasing, first and last included.
    """
    last = len(position) - 1
    chosen = np.unique(np.append(np.arange(0, last + 1, FINEST), last))
    while True:
        left, right = chosen[:-1], chosen[1:]
        middle = (left + right) // 2
        inside = middle > left
        left, right, middle = left[inside], right[inside], middle[inside]
        if len(middle) == 0:
            return chosen
        share = ((middle - left) / (right - left))[:, None]
        straight = (1.0 - share) * position[left] + share * position[right]
        arc = (1.0 - share) * quaternion[left] + share * quaternion[right]
        arc /= np.linalg.norm(arc, axis=1, keepdims=True)
        moved = np.linalg.norm(position[middle] - straight, axis=1)
        turned = 2.0 * np.linalg.norm(quaternion[middle] - arc, axis=1)
        needed = middle[np.maximum(moved, turned) > TOLERANCE]
        if len(needed) == 0:
            return chosen
        chosen = np.union1d(chosen, needed)
