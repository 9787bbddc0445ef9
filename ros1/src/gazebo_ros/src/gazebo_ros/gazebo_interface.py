"""Calls of a simulation's services, as other packages import them.

Each function waits for its service and returns whether it succeeded; what went wrong is logged.
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
"""s of wall time to wait for a service before saying so."""


def spawn_urdf_model_client(
    model_name: str,
    model_xml: str,
    robot_namespace: str,
    initial_pose: Pose,
    reference_frame: str,
    gazebo_namespace: str,
) -> bool:
    """Spawns a model from the text of a URDF.

    Args:
        model_name: Its name in the world.
        model_xml: The text.
        robot_namespace: Before the names of its topics.
        initial_pose: A geometry_msgs/Pose in `reference_frame`.
        reference_frame: A model or a link of one; empty is the world.
        gazebo_namespace: Of the services, mostly ``/gazebo``.
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
    """Spawns a model from the text of an SDF; the arguments of `spawn_urdf_model_client`."""
    request = (model_name, model_xml, robot_namespace, initial_pose, reference_frame)
    return _spawn(gazebo_namespace + "/spawn_sdf_model", request)


def set_model_configuration_client(
    model_name: str,
    model_param_name: str,
    joint_names: list[str],
    joint_positions: list[float],
    gazebo_namespace: str,
) -> bool:
    """Puts joints of a model into positions, in rad or m.

    Args:
        model_name: The model.
        model_param_name: A parameter with its URDF; may be empty.
        joint_names: The joints.
        joint_positions: One for each.
        gazebo_namespace: Of the services, mostly ``/gazebo``.
    """
    # The package's __init__ imports each of its services, which takes as long as a spawn.
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
    """The answer of a service that may not be there yet; None where the call fails."""
    wait(service)
    try:
        return rospy.ServiceProxy(service, kind)(*request)
    except rospy.ServiceException as error:
        rospy.logerr(f"The call of {service} failed: {error}")
        return None


def wait(service: str) -> None:
    """Waits for a service, and says so where it takes a while."""
    service = rospy.resolve_name(service)
    try:
        rospy.wait_for_service(service, timeout=PATIENCE)
    except rospy.ROSInterruptException:
        raise
    except rospy.ROSException:
        rospy.loginfo(
            f"Waiting for the service {service}: nobody offers it yet. "
            "A simulation does: roslaunch gazebo_ros empty_world.launch"
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
