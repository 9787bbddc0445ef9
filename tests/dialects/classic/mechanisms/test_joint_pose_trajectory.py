"""Joints that are set to the points of a trajectory."""

import numpy as np
import pytest
from tests.devices.bodies import arm

from cartwheel.messages import message_class

TRAJECTORY = """<plugin name="t" filename="libgazebo_ros_joint_pose_trajectory.so"/>"""


def trajectory(names, points, frame=""):
    """``JointTrajectory`` of (seconds, positions)."""
    point, duration = (
        message_class("trajectory_msgs/msg/JointTrajectoryPoint"),
        message_class("builtin_interfaces/msg/Duration"),
    )
    nothing = np.zeros(0)
    made = [
        point(np.array(positions), nothing, nothing, nothing,
              duration(int(seconds), int(seconds % 1 * 1e9)))
        for seconds, positions in points
    ]  # fmt: skip
    time = message_class("builtin_interfaces/msg/Time")
    header = message_class("std_msgs/msg/Header")(time(0, 0), frame)
    return message_class("trajectory_msgs/msg/JointTrajectory")(header, names, made)


def test_a_trajectory_sets_joints_at_its_times(make):
    world = make.world(make.sdf(arm(TRAJECTORY, "revolute")), ground=None, gravity=0.0)
    world.run(1.0)
    message = trajectory(["turn", "wrist"], [(0.5, [0.3, -0.2]), (1.0, [0.6, -0.4])])
    world.graph.publish("/set_joint_trajectory", "trajectory_msgs/msg/JointTrajectory", message)
    position = world.session.simulation.joint_position
    for seconds, turned, bent in ((0.45, 0, 0), (0.1, 0.3, -0.2), (0.5, 0.6, -0.4), (1, 0.6, -0.4)):
        world.run(seconds)
        assert position("arm", "turn") == pytest.approx(turned, abs=1e-9)
        assert position("arm", "wrist") == pytest.approx(bent, abs=1e-9)


def test_a_trajectory_that_cannot_be_followed_is_refused(make):
    world = make.world(make.sdf(arm(TRAJECTORY)), ground=None)
    request = message_class("gazebo_msgs/srv/SetJointTrajectory_Request")
    pose = message_class("geometry_msgs/msg/Pose")
    point = message_class("geometry_msgs/msg/Point")(0.0, 0.0, 0.0)
    where = pose(point, message_class("geometry_msgs/msg/Quaternion")(0.0, 0.0, 0.0, 1.0))

    def ask(names, positions, model="arm"):
        service = world.graph.service("/set_joint_trajectory")
        return service.handler(
            request(
                model_name=model,
                joint_trajectory=trajectory(names, [(0, positions)]),
                model_pose=where,
                set_model_pose=False,
                disable_physics_updates=False,
            )
        )

    assert ask(["turn"], [0.1]).success
    before = world.session.simulation.data.qpos.copy()
    for names, positions, model in (
        (["trun"], [0.1], "arm"),
        (["turn"], [0.1, 0.2], "arm"),
        (["turn"], [0.1], "leg"),
    ):
        answer = ask(names, positions, model)
        assert not answer.success and answer.status_message
        assert (world.session.simulation.data.qpos == before).all()
