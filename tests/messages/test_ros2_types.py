"""Type hashes against those that ROS 2 installs and publishes, as literals."""

from __future__ import annotations

import pytest

from cartwheel.errors import UnknownNameError
from cartwheel.messages import service_classes
from cartwheel.messages.ros1 import ros1_service
from cartwheel.messages.ros2_types import dds_name, ros2_service, ros2_type

MESSAGES = {
    "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "std_msgs/msg/Char": "3ad2d04dd29ba19d04b16659afa3ccaedd691914b02a64e82e252f2fa6a586a9",
    "geometry_msgs/msg/Twist": "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
    "nav_msgs/msg/Odometry": "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
    "sensor_msgs/msg/Image": "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
    "sensor_msgs/msg/CameraInfo": (
        "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"
    ),
    "sensor_msgs/msg/Imu": "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
    "sensor_msgs/msg/JointState": (
        "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"
    ),
    "tf2_msgs/msg/TFMessage": "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "rosgraph_msgs/msg/Clock": "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564",
    "rcl_interfaces/msg/Log": "e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac",
    "rcl_interfaces/msg/ParameterEvent": (
        "043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204"
    ),
    "rmw_dds_common/msg/ParticipantEntitiesInfo": (
        "91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"
    ),
}
SERVICES = {
    "std_srvs/srv/Trigger": "eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f",
    "std_srvs/srv/SetBool": "abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a",
    "rcl_interfaces/srv/GetParameters": (
        "bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc"
    ),
    "rcl_interfaces/srv/ListParameters": (
        "3e6062bfbb27bfb8730d4cef2558221f51a11646d78e7bb30a1e83afac3aad9d"
    ),
    "rcl_interfaces/srv/DescribeParameters": (
        "845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff"
    ),
    "rcl_interfaces/srv/SetParameters": (
        "56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0"
    ),
}


@pytest.mark.parametrize("name", MESSAGES)
def test_messages_hash_as_in_ros(name: str) -> None:
    assert ros2_type(name).hash == f"RIHS01_{MESSAGES[name]}"


@pytest.mark.parametrize("name", SERVICES)
def test_services_hash_as_in_ros(name: str) -> None:
    assert ros2_service(name).hash == f"RIHS01_{SERVICES[name]}"


def test_names_are_those_of_dds() -> None:
    assert dds_name("nav_msgs/msg/Odometry") == "nav_msgs::msg::dds_::Odometry_"
    service = ros2_service("gazebo_msgs/SpawnEntity")
    assert service.name == "gazebo_msgs/srv/SpawnEntity"
    assert service.dds_request == "gazebo_msgs::srv::dds_::SpawnEntity_Request_"
    assert service.dds_response == "gazebo_msgs::srv::dds_::SpawnEntity_Response_"


@pytest.mark.parametrize(
    "name", ["dynamic_reconfigure/msg/Config", "rosgraph_msgs/msg/Log", "nonsense/msg/None"]
)
def test_what_ros2_does_not_have_is_refused(name: str) -> None:
    with pytest.raises(UnknownNameError):
        ros2_type(name)


def test_types_of_ros2_alone_do_not_reach_ros1() -> None:
    service_classes("gazebo_msgs/srv/SpawnEntity")
    with pytest.raises(UnknownNameError):
        ros1_service("gazebo_msgs/srv/SpawnEntity")
