"""A robot whose joints are moved by every iterate: the shapes once, then the poses of each iterate."""

from __future__ import annotations

import base64
from collections.abc import Sequence

import meshcat
import numpy as np
import pinocchio as pin
from scipy.spatial.transform import Rotation

from robotraj._util.arrays import Array
from robotraj.replay_page.colors import css
from robotraj.replay_page.scene.hull import hull_of, stature_of
from robotraj.replay_page.scene.scene import tip_frame
from robotraj.replay_page.scene.visuals import visuals_of
from robotraj.replay_page.scene.window import RecordingWindow, draw
from robotraj.robot.robot import Robot


class LiveScene:
    """The shapes of a robot below one node for each joint, which lies in the world.

    Parameters
    ----------
    robot : Robot
    traces : sequence of str
        Frames whose path is drawn; the tip of the longest chain if empty.
    """

    def __init__(self, robot: Robot, traces: Sequence[str] = ()) -> None:
        self._model = robot.model
        self._data = robot.model.createData()
        self._visuals = visuals_of(robot.model, robot.visual_model)
        self._frames = [robot.model.frames[robot.frame(name)] for name in traces or [tip_frame(robot.model)]]

    def commands(self) -> bytes:
        """Return the meshcat commands that draw the shapes, gzip."""
        window = RecordingWindow()
        viewer = meshcat.Visualizer(window=window)
        for number, visual in enumerate(self._visuals):
            node = viewer[f"joint {visual.joint}/visual {number}"]
            node.set_transform(visual.placement)
            for k, (part, color) in enumerate(visual.parts):
                draw(node[f"part {k}"], part, color)
        return window.packed()

    def description(self, q: Array) -> dict[str, object]:
        """Describe the scene for the page's script.

        Parameters
        ----------
        q : ndarray (m, nq)
            Configurations that the camera frames.
        """
        world = self._world(q)
        return {
            "hull": np.round(hull_of(self._visuals, world), 4).tolist(),
            "stature": round(stature_of(self._visuals, world[0]), 4),
            "surroundings": [],
            "ground": {"level": 0.0, "surface": False},
            "body": None,
            "joints": {
                str(joint): ["meshcat", f"joint {joint}"] for joint in sorted({v.joint for v in self._visuals} - {0})
            },
            "tips": [
                {
                    "joint": int(frame.parentJoint),
                    "offset": np.round(frame.placement.translation, 6).tolist(),
                    "color": css(k),
                }
                for k, frame in enumerate(self._frames)
            ],
        }

    def poses(self, q: Array) -> str:
        """Return positions and quaternions (x, y, z, w) of all joints but the world's, (m, njoints - 1, 7).

        They are float32 in base64, row by row.
        """
        world = self._world(q)[:, 1:]
        shape = world.shape[:2]
        quaternions = Rotation.from_matrix(world[..., :3, :3].reshape(-1, 3, 3)).as_quat().reshape(*shape, 4)
        packed = np.concatenate([world[..., :3, 3], quaternions], axis=-1).astype("<f4")
        return base64.b64encode(packed.tobytes()).decode("ascii")

    def _world(self, q: Array) -> Array:
        """Return the joints' frames in the world (m, njoints, 4, 4)."""
        world = np.tile(np.eye(4), (len(q), self._model.njoints, 1, 1))
        for k, configuration in enumerate(q):
            pin.forwardKinematics(self._model, self._data, configuration)
            for joint in range(1, self._model.njoints):
                world[k, joint] = self._data.oMi[joint].homogeneous
        return world
