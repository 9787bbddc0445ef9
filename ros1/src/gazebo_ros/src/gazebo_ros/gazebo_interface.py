"""Functions that call a simulation's services, for other packages.

Each function waits for its service and returns whether the call succeeded. Errors are logged.
"""

from __future__ import annotations

from typing import Any

import rospy
from geometry_msgs.msg import Pose

__all__ = [
    "set_model_configuration_client",
    "spawn_sdf_model_client",
    "spawn_urdf_model_client",
]

PATIENCE = 2.0
"""Wall time in s to wait for a service before a message is logged."""


def spawn_urdf_model_client(
    model_name: str,
    model_xml: str,
    robot_namespace: str,
    initial_pose: Pose,
    reference_frame: str,
    gazebo_namespace: str,
) -> bool:
    """Spawns a model from URDF text.

    Args:
        model_name: Name of the model in the world.
        model_xml: URDF text.
        robot_namespace: Namespace of the model's topics.
        initial_pose: A geometry_msgs/Pose in `reference_frame`.
        reference_frame: Name of a model or link; empty for the world.
        gazebo_namespace: Namespace of the services, usually ``/gazebo``.
    """
    request = (model_name, model_xml, robot_namespace, initial_pose, reference_frame)
    return _spawn(gazebo_namespace + "/spawn_urdf_model", request)


def spawn_sdf_model_client(
    model_name: str,
    model_xml: str,
    robot_namespace: str,
    initial_pose: Pose,
    reference_frame: str,
    gazebo_namespace: str,
) -> bool:
    """Spawns a model from SDF text. The arguments are those of `spawn_urdf_model_client`."""
    request = (model_name, model_xml, robot_namespace, initial_pose, reference_frame)
    return _spawn(gazebo_namespace + "/spawn_sdf_model", request)


def set_model_configuration_client(
    model_name: str,
    model_param_name: str,
    joint_names: list[str],
    joint_positions: list[float],
    gazebo_namespace: str,
) -> bool:
    """Sets the positions of a model's joints.

    Args:
        model_name: Name of the model.
        model_param_name: ROS parameter with the model's URDF; can be empty.
        joint_names: Names of the joints.
        joint_positions: Position of each joint in rad or m.
        gazebo_namespace: Namespace of the services, usually ``/gazebo``.
    """
    # Importing gazebo_msgs.srv would import all its services, which takes as long as a spawn.
    from gazebo_msgs.srv._SetModelConfiguration import SetModelConfiguration

    answer = call(
        gazebo_namespace + "/set_model_configuration",
        SetModelConfiguration,
        (model_name, model_param_name, joint_names, joint_positions),
    )
    if answer is None:
        return False
    _log(answer.success, f"Set model configuration status: {answer.status_message}")
    return bool(answer.success)


def call(service: str, kind: Any, request: tuple[Any, ...] = ()) -> Any:
    """Waits for a service and calls it. Returns None if the call fails."""
    wait(service)
    try:
        return rospy.ServiceProxy(service, kind)(*request)
    except rospy.ServiceException as error:
        rospy.logerr(f"The call to {service} failed: {error}")
        return None


def wait(service: str) -> None:
    """Waits for a service, and logs a message if the service is not available soon."""
    service = rospy.resolve_name(service)
    try:
        rospy.wait_for_service(service, timeout=PATIENCE)
    except rospy.ROSInterruptException:
        raise
    except rospy.ROSException:
        rospy.loginfo(
            f"Waiting for the service {service}, which is not available yet. "
            "To start a simulation, run: roslaunch gazebo_ros empty_world.launch"
        )
        rospy.wait_for_service(service)


def _spawn(service: str, request: tuple[Any, ...]) -> bool:
    from gazebo_msgs.srv._SpawnModel import SpawnModel

    answer = call(service, SpawnModel, request)
    if answer is None:
        return False
    _log(answer.success, f"Spawn status: {answer.status_message}")
    return bool(answer.success)


def _log(success: bool, text: str) -> None:
    (rospy.loginfo if success else rospy.logerr)(text)
