"""Send an exported plan to a joint_trajectory_controller of ROS 2, as an action goal.

    python send_trajectory.py plan.json /scaled_joint_trajectory_controller

``solution.to_controller("plan.json", rate=100)`` writes the file. The controller must know the joints by these names,
and the robot must stand at the start of the plan: this is checked against /joint_states before the goal is sent.
Needs ROS 2 with rclpy, control_msgs, sensor_msgs and rosidl_runtime_py, but not robotraj.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

APART = 0.01
"""Largest distance of a joint from the start of the plan [rad, m]."""
LATE = 0.5
"""Time after the end of the plan within which the robot must be there [s]."""


def goal_of(trajectory: dict[str, Any], tolerance: float = APART) -> dict[str, Any]:
    """Return the fields of control_msgs/action/FollowJointTrajectory.Goal, with a tolerance at the end [rad, m]."""
    joints = trajectory["joint_names"]
    return {
        "trajectory": trajectory,
        "goal_tolerance": [{"name": joint, "position": tolerance} for joint in joints],
        "goal_time_tolerance": {"sec": int(LATE), "nanosec": round(1e9 * (LATE % 1.0))},
    }


def apart(trajectory: dict[str, Any], names: list[str], positions: list[float]) -> dict[str, float]:
    """Return the joints of a plan that are not at its start, with their distances; NaN where one is not reported."""
    measured = dict(zip(names, positions, strict=True))
    start = dict(zip(trajectory["joint_names"], trajectory["points"][0]["positions"], strict=True))
    gaps = {joint: abs(measured.get(joint, float("nan")) - place) for joint, place in start.items()}
    return {joint: gap for joint, gap in gaps.items() if not gap <= APART}


def main(file: str, controller: str) -> None:
    """Check the start, send the goal and wait for the result."""
    import rclpy
    from control_msgs.action import FollowJointTrajectory
    from rclpy.action import ActionClient
    from rosidl_runtime_py import set_message_fields
    from sensor_msgs.msg import JointState

    trajectory = json.loads(Path(file).read_text(encoding="utf-8"))
    rclpy.init()
    node = rclpy.create_node("send_trajectory")
    states: list[JointState] = []
    node.create_subscription(JointState, "/joint_states", states.append, 1)
    while not states:
        rclpy.spin_once(node)
    wrong = apart(trajectory, list(states[-1].name), list(states[-1].position))
    if wrong:
        raise SystemExit(f"The robot is not at the start of the plan: {wrong}. Move it there first.")
    client = ActionClient(node, FollowJointTrajectory, f"{controller}/follow_joint_trajectory")
    if not client.wait_for_server(timeout_sec=5.0):
        raise SystemExit(f"There is no action {controller}/follow_joint_trajectory; is the controller active?")
    goal = FollowJointTrajectory.Goal()
    set_message_fields(goal, goal_of(trajectory))
    sent = client.send_goal_async(goal)
    rclpy.spin_until_future_complete(node, sent)
    if not sent.result().accepted:
        raise SystemExit("The controller rejected the goal; its log states the reason.")
    result = sent.result().get_result_async()
    rclpy.spin_until_future_complete(node, result)
    print(f"error code {result.result().result.error_code} {result.result().result.error_string}")
    rclpy.shutdown()


if __name__ == "__main__":
    if len(sys.argv) != 3:
        raise SystemExit("Usage: python send_trajectory.py plan.json /name_of_the_controller")
    main(*sys.argv[1:])
