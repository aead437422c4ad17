"""A second simulation of plans: MuJoCo with feedback, its own dynamics and its own contacts.

Start with ``following.py``.
"""

from robotraj.witness.mujoco.feedback import Feedback, JointFeedback, LinearQuadratic, NoFeedback
from robotraj.witness.mujoco.feet import SoftGround
from robotraj.witness.mujoco.following import second_opinion
from robotraj.witness.mujoco.model import MujocoRobot, mujoco_robot
from robotraj.witness.mujoco.report import FootReport, SecondOpinion

__all__ = [
    "Feedback",
    "FootReport",
    "JointFeedback",
    "LinearQuadratic",
    "MujocoRobot",
    "NoFeedback",
    "SecondOpinion",
    "SoftGround",
    "mujoco_robot",
    "second_opinion",
]
