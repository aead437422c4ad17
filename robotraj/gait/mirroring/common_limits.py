"""Position limits of a robot compared with those of its mirror image."""

from __future__ import annotations

from robotraj.problem.links.periodic import Mirror
from robotraj.robot.robot import Robot


def joint_without_common_limits(robot: Robot, repeat: Mirror) -> str | None:
    """Return a joint whose range has no value in common with the image of its partner's range; None if all have one.

    A mirrored gait ends with q_j = s q_partner(0), s = -1 for negated joints. Without a common value it has no motion.
    """
    joints, partners, negated = list(robot.velocity_names), repeat.partner_of, set(repeat.negated)
    lower, upper = robot.limits.position_lower, robot.limits.position_upper
    for i, joint in enumerate(joints):
        other = joints.index(partners.get(joint, joint))
        low, high = (-upper[other], -lower[other]) if joint in negated else (lower[other], upper[other])
        if max(low, lower[i]) > min(high, upper[i]):
            return joint
    return None
