"""Actions of controllers, by actionlib's own client."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import yaml
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

PROGRAM = Path(sys.executable).with_name("cartwheel")
CLIENT = """
import json, actionlib, rospy
from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import (FollowJointTrajectoryAction, FollowJointTrajectoryGoal,
    GripperCommandAction, GripperCommandGoal, JointTolerance)
from trajectory_msgs.msg import JointTrajectoryPoint

rospy.init_node("client")
NAMES = ["a_joint", "b_joint"]
arm = actionlib.SimpleActionClient("/arm/follow_joint_trajectory", FollowJointTrajectoryAction)
hand = actionlib.SimpleActionClient("/hand/gripper_cmd", GripperCommandAction)
reported = {"servers": [each.wait_for_server(rospy.Duration(60)) for each in (arm, hand)]}
heard = []

def goal(seconds, positions, names=NAMES, **more):
    made = FollowJointTrajectoryGoal(**more)
    made.trajectory.joint_names = names
    if positions:
        made.trajectory.points = [JointTrajectoryPoint(
            positions=positions, time_from_start=rospy.Duration(seconds))]
    return made

def end(client):
    assert client.wait_for_result(rospy.Duration(60)), "no result"
    result = client.get_result()
    code = getattr(result, "error_code", None)
    return GoalStatus.to_string(client.get_state()), code

def outcome(name, *arguments, **more):
    arm.send_goal(goal(*arguments, **more))
    reported[name] = end(arm)

arm.send_goal(goal(0.5, [0.1, 0.0]), feedback_cb=lambda f: heard.append(f.joint_names))
reported["reached"] = end(arm)
reported["feedback"] = heard[:1]
outcome("at once", 0, [0.0, 0.0])
outcome("partial", 1, [0.1], names=NAMES[:1])
outcome("stranger", 1, [0.1, 0.1], names=["a_joint", "elbow"])
outcome("empty", 1, [])
outcome("path", 1, [0.0, 2.0], path_tolerance=[JointTolerance("b_joint", 0.05, 0, 0)])
outcome("back", 3, [0.0, 0.0])
outcome("late", 0.5, [0.0, 1.0], goal_tolerance=[JointTolerance("b_joint", 0.05, 0, 0)],
        goal_time_tolerance=rospy.Duration(0.1))

# Another client's goal takes the place of ours; then ours is cancelled.
other = actionlib.SimpleActionClient("/arm/follow_joint_trajectory", FollowJointTrajectoryAction)
other.wait_for_server(rospy.Duration(60))
arm.send_goal(goal(1000, [1.0, 0.0]))
while arm.get_state() != GoalStatus.ACTIVE:
    rospy.sleep(0.02)
other.send_goal(goal(1000, [0.5, 0.0]))
reported["replaced"] = end(arm)
while other.get_state() != GoalStatus.ACTIVE:
    rospy.sleep(0.02)
other.cancel_goal()
reported["cancelled"] = end(other)
arm.send_goal(goal(1000, [1.0, 0.0]))
while arm.get_state() != GoalStatus.ACTIVE:
    rospy.sleep(0.02)
arm.cancel_all_goals()
reported["all cancelled"] = end(arm)

grip = GripperCommandGoal()
grip.command.position = 0.3
hand.send_goal(grip)
reported["gripped"] = end(hand)[0], hand.get_result().reached_goal
print(json.dumps(reported))
"""


def test_a_client_of_actionlib(ros: Any, tmp_path: Path) -> None:
    slow = 'lower="-3" upper="3" effort="100" velocity="0.2"'
    body = beam("a", "world") + beam("b", "world", origin="0 1 1", limit=slow)
    body += beam("c", "world", origin="0 2 1")
    body += "".join(transmission(f"{name}_joint", "Position") for name in "abc")
    (tmp_path / "arm.urdf").write_text(robot(body, ROS1))
    (tmp_path / "control.yaml").write_text(
        yaml.safe_dump(
            {
                "arm": {
                    "type": "position_controllers/JointTrajectoryController",
                    "joints": ["a_joint", "b_joint"],
                },
                "hand": {
                    "type": "position_controllers/GripperActionController",
                    "joint": "c_joint",
                },
            }
        )
    )
    ros.master()
    ros.start(
        *(PROGRAM, "run", "arm.urdf", "--controllers", "control.yaml"),
        *("--headless", "--ros1", "--speed", "4"),
    )
    client = ros.python(CLIENT)
    output, errors = client.communicate(timeout=240)
    assert client.returncode == 0, errors
    reported = json.loads(output.splitlines()[-1])
    assert reported == {
        "servers": [True, True],
        "reached": ["SUCCEEDED", 0],
        "feedback": [["a_joint", "b_joint"]],
        "at once": ["SUCCEEDED", 0],
        "partial": ["REJECTED", -2],
        "stranger": ["REJECTED", -2],
        "empty": ["REJECTED", -1],
        "path": ["ABORTED", -4],
        "back": ["SUCCEEDED", 0],
        "late": ["ABORTED", -5],
        "replaced": ["PREEMPTED", 0],
        "cancelled": ["PREEMPTED", 0],
        "all cancelled": ["PREEMPTED", 0],
        "gripped": ["SUCCEEDED", True],
    }
