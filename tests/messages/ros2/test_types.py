"""Type hashes against those that ROS 2 installs and publishes, as literals."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from tests import launching

from cartwheel.errors import UnknownNameError
from cartwheel.messages import (
    decode_cdr,
    encode_cdr,
    from_dict,
    message_class,
    service_classes,
    to_dict,
)
from cartwheel.messages.ros1 import ros1_service
from cartwheel.messages.ros2.definitions import ros2_definition
from cartwheel.messages.ros2.types import dds_name, ros2_service, ros2_type
from cartwheel.messages.ros2.versions import older_versions
from cartwheel.messages.store import ROS2_DEFINITIONS, definitions, parsed_definitions

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
    "action_msgs/msg/GoalStatusArray": (
        "6c1684b00f177d37438febe6e709fc4e2b0d4248dca4854946f9ed8b30cda83e"
    ),
    "action_msgs/srv/CancelGoal_Request": (
        "3d3c84653c1f96918086887e1dcb236faec88b81a5b14fd4cf4840065bcdf8af"
    ),
    "ros_gz_interfaces/msg/Altimeter": (
        "c1e452c867a0dd147e2a612d1f78e5da9675ae5ef75c0950ad1520f004101703"
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
    # As rosidl_generator_type_description hashes gazebo_msgs 3.9 and simulation_interfaces 2.1.
    "gazebo_msgs/srv/SpawnEntity": (
        "a01b6c5a00d47ced8923b43e9e24764fcaa176d2eac6d88163cdb50a02f6cfb5"
    ),
    "gazebo_msgs/srv/SetEntityState": (
        "a7ec3c56a44484ff2b7fbf0449c4bc39366a93d940f335b891f7851b1c46fdc5"
    ),
    "gazebo_msgs/srv/ApplyLinkWrench": (
        "726243c2279f825204c81c4416019a06cbf02c55996f8a1a4fb7123ecf38a0d2"
    ),
    "gazebo_msgs/srv/ApplyJointEffort": (
        "3e94edd0b2942718ab07ae1b6ca5caefd2d2948d756265ea142fe4244e5e706a"
    ),
    "gazebo_msgs/srv/GetModelProperties": (
        "49525097678f4c00f1d0b1f79649f4b212403225dce6e70b959ce52b7336a23f"
    ),
    "gazebo_msgs_ros2/srv/SetJointProperties": (
        "7a8f5721f145da5e51e724d8584bbaf2cec821128ef8ce3fa19cd1d36a5f0656"
    ),
    "gazebo_msgs_ros2/srv/SetLightProperties": (
        "0f9f2e73a54e9e372274608c302437a4a044c6d489712b1f71af88e8ac9bb529"
    ),
    "simulation_interfaces/srv/GetSimulatorFeatures": (
        "abb9439c8cf196722a469fb6c68b44b484f198c2a1356ac38849a29c2a20a794"
    ),
    "simulation_interfaces/srv/SpawnEntity": (
        "66860313e11009faddbfc8568e5d410d1a11607fe75eeb1308671dc0406fe3a7"
    ),
    "simulation_interfaces/srv/GetEntitiesStates": (
        "0a76170d0c1c90e1eaf805cfab78ea801d1f82df309a28c1f0fae4b570f19754"
    ),
    "simulation_interfaces/srv/ResetSimulation": (
        "4ce285d7ff9b8ac70dcc95161f32bf54c05a6f4b13427990e41ab40c36c39646"
    ),
}


FIBONACCI = {
    "SendGoal_Request": "3d088942b413247db536576f0286768c6be8fcd5d0c9a5d544f359fba090a238",
    "GetResult_Request": "c8a4f5e7d13b81286ee1043e2ecd084281cecf1ff06aaa799464f5f15479f003",
    "FeedbackMessage": "c1de71afd52e49a89c53d8262366884185bc0a02f78ce051c4e46b0a7fe59bb2",
}
"""Of example_interfaces/action/Fibonacci, which ROS's own documents hash."""


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


def test_parts_of_actions_hash_as_in_ros(tmp_path: Path) -> None:
    folder = tmp_path / "example_interfaces" / "action"
    folder.mkdir(parents=True)
    (folder / "Fibonacci.action").write_text(
        "int32 order\n---\nint32[] sequence\n---\nint32[] sequence\n"
    )
    known = get_typestore(Stores.ROS2_JAZZY)
    # It has some of the parts already: what counts is what is made here.
    made = parsed_definitions(tmp_path)
    known.fielddefs = {**known.fielddefs, **made}
    for part, expected in FIBONACCI.items():
        name = f"example_interfaces/action/Fibonacci_{part}"
        assert name in made
        assert known.hash_rihs01(name) == f"RIHS01_{expected}"


def test_ros2_has_its_own_types_where_ros1_has_others_of_their_name() -> None:
    ros1 = message_class("control_msgs/msg/JointTrajectoryControllerState")
    ros2 = message_class("control_msgs_ros2/msg/JointTrajectoryControllerState")
    assert "desired" in ros1.__dataclass_fields__
    assert "reference" in ros2.__dataclass_fields__
    state = ros2_type("control_msgs_ros2/msg/JointTrajectoryControllerState")
    assert state.name == "control_msgs/msg/JointTrajectoryControllerState"
    assert state.dds == "control_msgs::msg::dds_::JointTrajectoryControllerState_"
    with pytest.raises(UnknownNameError):
        ros2_type("control_msgs/msg/JointTrajectoryControllerState")
    send = ros2_service("control_msgs_ros2/action/FollowJointTrajectory_SendGoal")
    assert send.dds_request == "control_msgs::action::dds_::FollowJointTrajectory_SendGoal_Request_"
    listed = ros2_definition("controller_manager_msgs_ros2/srv/ListControllers_Response")
    assert "controller_manager_msgs/ControllerState[] controller" in listed.replace("/msg/", "/")
    assert "_ros2" not in listed


def test_a_hash_is_that_of_the_real_names() -> None:
    """Types in it count by their names: the store here has another for them."""
    listed = ros2_service("controller_manager_msgs_ros2/srv/ListControllers")
    plain = get_typestore(Stores.ROS2_JAZZY)
    plain.fielddefs = dict(plain.fielddefs)
    for name, text in definitions(ROS2_DEFINITIONS):
        if name.startswith("controller_manager_msgs_ros2/"):
            real = name.replace("_ros2/", "/")
            (plain.fielddefs[real],) = get_types_from_msg(
                text.replace("_ros2/", "/"), real
            ).values()
    assert listed.response_hash == plain.hash_rihs01(
        "controller_manager_msgs/srv/ListControllers_Response"
    )


@pytest.mark.parametrize(
    ("name", "digest"),
    [
        ("GetSpawnables", "3bc0266bf8236058ff589c44512e013afe4f295427c39d44cff363d1c956bf36"),
        ("LoadWorld", "f210682338f195f6f06191b46b20ec4992bddf485d33e2cffab2dd15341b4e3e"),
        ("SetEntityState", "ca210e7d2b66629ae133c8e1edf5246e618106d75c78ed0556c0e7a33c59ee5e"),
        ("SpawnEntity", "d4c086345d4194a5fc4c9ae45095736ca4062b5cdac4d06a42dec93d683e03cf"),
    ],
)
def test_the_version_that_jazzy_has_is_known_by_its_hash(name: str, digest: str) -> None:
    """Digests are those of the package for Jazzy, 1.5.1, as rosidl made them."""
    newest = ros2_service(f"simulation_interfaces/srv/{name}")
    (older,) = older_versions(f"simulation_interfaces/srv/{name}")
    assert older.type.hash == f"RIHS01_{digest}" != newest.hash
    assert (older.type.name, older.type.dds) == (newest.name, newest.dds)


def test_what_jazzy_asks_for_and_is_answered_has_the_newest_form() -> None:
    package = "simulation_interfaces"
    (older,) = older_versions(f"{package}/srv/SpawnEntity")
    request = older.request(from_dict(older.type.request, {"name": "a", "resource_string": "<a/>"}))
    assert to_dict(request)["entity_resource"] == {"uri": "", "resource_string": "<a/>"}
    (older,) = older_versions(f"{package}/srv/SetEntityState")
    request = older.request(from_dict(older.type.request, {"entity": "a"}))
    assert (request.set_pose, request.set_twist, request.set_acceleration) == (True, True, False)
    (older,) = older_versions(f"{package}/srv/GetSpawnables")
    newest = from_dict(
        f"{package}/srv/GetSpawnables_Response",
        {"spawnables": [{"entity_resource": {"uri": "a"}, "description": "b"}]},
    )
    response = decode_cdr(encode_cdr(older.response(newest)), older.type.response)
    (spawnable,) = to_dict(response)["spawnables"]
    assert (spawnable["uri"], spawnable["description"]) == ("a", "b")
    assert older_versions("std_srvs/srv/Empty") == ()


FRESH = """
from cartwheel.messages.ros2.types import ros2_service, ros2_type
from cartwheel.messages.store import loaded

print(ros2_type("gazebo_msgs/msg/ModelState").hash, ros2_service("std_srvs/srv/Empty").hash)
print("gazebo_msgs/msg/LinkStates" in loaded().fielddefs)
"""


def test_hashes_read_only_the_types_that_they_need() -> None:
    """A bridge computes them when it starts, and reading all types takes longer than its start."""
    done = launching.run([sys.executable, "-c", FRESH], capture_output=True, text=True, check=True)
    model, service, others_read = done.stdout.split()
    assert model == ros2_type("gazebo_msgs/msg/ModelState").hash
    assert service == ros2_service("std_srvs/srv/Empty").hash
    assert others_read == "False"
