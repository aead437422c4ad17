"""The second witness: MuJoCo follows the plan with feedback, on its own dynamics and its own contacts."""

from robotraj.witness.mujoco.model import MujocoRobot, mujoco_robot

__all__ = ["MujocoRobot", "mujoco_robot"]
