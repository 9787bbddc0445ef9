"""Our message definitions against the md5 sums that ROS 1 computes for them."""

import hashlib
from typing import Any

import pytest
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from tests.coded import raises

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.messages import message_class, service_classes, store
from cartwheel.messages.store import definitions

# As a real ROS 1 Noetic prints them.
MESSAGES = {
    "control_msgs/FollowJointTrajectoryAction": "bc4f9b743838566551c0390c65f1a248",
    "control_msgs/FollowJointTrajectoryActionFeedback": "d8920dc4eae9fc107e00999cce4be641",
    "control_msgs/FollowJointTrajectoryActionGoal": "cff5c1d533bf2f82dd0138d57f4304bb",
    "control_msgs/FollowJointTrajectoryActionResult": "c4fb3b000dc9da4fd99699380efcc5d9",
    "control_msgs/FollowJointTrajectoryFeedback": "10817c60c2486ef6b33e97dcd87f4474",
    "control_msgs/FollowJointTrajectoryGoal": "69636787b6ecbde4d61d711979bc7ecb",
    "control_msgs/FollowJointTrajectoryResult": "493383b18409bfb604b4e26c676401d2",
    "control_msgs/GripperCommand": "680acaff79486f017132a7f198d40f08",
    "control_msgs/GripperCommandAction": "950b2a6ebe831f5d4f4ceaba3d8be01e",
    "control_msgs/GripperCommandActionFeedback": "653dff30c045f5e6ff3feb3409f4558d",
    "control_msgs/GripperCommandActionGoal": "aa581f648a35ed681db2ec0bf7a82bea",
    "control_msgs/GripperCommandActionResult": "143702cb2df0f163c5283cedc5efc6b6",
    "control_msgs/GripperCommandFeedback": "e4cbff56d3562bcf113da5a5adeef91f",
    "control_msgs/GripperCommandGoal": "86fd82f4ddc48a4cb6856cfa69217e43",
    "control_msgs/GripperCommandResult": "e4cbff56d3562bcf113da5a5adeef91f",
    "control_msgs/JointControllerState": "987ad85e4756f3aef7f1e5e7fe0595d1",
    "control_msgs/JointJog": "1685da700c8c2e1254afc92a5fb89c96",
    "control_msgs/JointTolerance": "f544fe9c16cf04547e135dd6063ff5be",
    "control_msgs/JointTrajectoryAction": "a04ba3ee8f6a2d0985a6aeaf23d9d7ad",
    "control_msgs/JointTrajectoryActionFeedback": "aae20e09065c3809e8a8e87c4c8953fd",
    "control_msgs/JointTrajectoryActionGoal": "a99e83ef6185f9fdd7693efe99623a86",
    "control_msgs/JointTrajectoryActionResult": "1eb06eeff08fa7ea874431638cb52332",
    "control_msgs/JointTrajectoryControllerState": "10817c60c2486ef6b33e97dcd87f4474",
    "control_msgs/JointTrajectoryFeedback": "d41d8cd98f00b204e9800998ecf8427e",
    "control_msgs/JointTrajectoryGoal": "2a0eff76c870e8595636c2a562ca298e",
    "control_msgs/JointTrajectoryResult": "d41d8cd98f00b204e9800998ecf8427e",
    "control_msgs/PidState": "b138ec00e886c10e73f27e8712252ea6",
    "control_msgs/PointHeadAction": "7252920f1243de1b741f14f214125371",
    "control_msgs/PointHeadActionFeedback": "33c9244957176bbba97dd641119e8460",
    "control_msgs/PointHeadActionGoal": "b53a8323d0ba7b310ba17a2d3a82a6b8",
    "control_msgs/PointHeadActionResult": "1eb06eeff08fa7ea874431638cb52332",
    "control_msgs/PointHeadFeedback": "cce80d27fd763682da8805a73316cab4",
    "control_msgs/PointHeadGoal": "8b92b1cd5e06c8a94c917dc3209a4c1d",
    "control_msgs/PointHeadResult": "d41d8cd98f00b204e9800998ecf8427e",
    "control_msgs/SingleJointPositionAction": "c4a786b7d53e5d0983decf967a5a779e",
    "control_msgs/SingleJointPositionActionFeedback": "3503b7cf8972f90d245850a5d8796cfa",
    "control_msgs/SingleJointPositionActionGoal": "4b0d3d091471663e17749c1d0db90f61",
    "control_msgs/SingleJointPositionActionResult": "1eb06eeff08fa7ea874431638cb52332",
    "control_msgs/SingleJointPositionFeedback": "8cee65610a3d08e0a1bded82f146f1fd",
    "control_msgs/SingleJointPositionGoal": "fbaaa562a23a013fd5053e5f72cbb35c",
    "control_msgs/SingleJointPositionResult": "d41d8cd98f00b204e9800998ecf8427e",
    "controller_manager_msgs/ControllerState": "aeb6b261d97793ab74099a3740245272",
    "controller_manager_msgs/ControllerStatistics": "697780c372c8d8597a1436d0e2ad3ba8",
    "controller_manager_msgs/ControllersStatistics": "a154c347736773e3700d1719105df29d",
    "controller_manager_msgs/HardwareInterfaceResources": "f25b55cbf1d1f76e82e5ec9e83f76258",
    "dynamic_reconfigure/BoolParameter": "23f05028c1a699fb83e22401228c3a9e",
    "dynamic_reconfigure/Config": "958f16a05573709014982821e6822580",
    "dynamic_reconfigure/ConfigDescription": "757ce9d44ba8ddd801bb30bc456f946f",
    "dynamic_reconfigure/DoubleParameter": "d8512f27253c0f65f928a67c329cd658",
    "dynamic_reconfigure/Group": "9e8cd9e9423c94823db3614dd8b1cf7a",
    "dynamic_reconfigure/GroupState": "a2d87f51dc22930325041a2f8b1571f8",
    "dynamic_reconfigure/IntParameter": "65fedc7a0cbfb8db035e46194a350bf1",
    "dynamic_reconfigure/ParamDescription": "7434fcb9348c13054e0c3b267c8cb34d",
    "dynamic_reconfigure/StrParameter": "bc6ccc4a57f61779c8eaae61e9f422e0",
    "four_wheel_steering_msgs/FourWheelSteering": "04dd0f55e1f168668af1e2587a7cdd2a",
    "four_wheel_steering_msgs/FourWheelSteeringStamped": "9226582df815bc6df9e3206bc05923af",
    "gazebo_msgs/ContactState": "48c0ffb054b8c444f870cecea1ee50d9",
    "gazebo_msgs/ContactsState": "acbcb1601a8e525bf72509f18e6f668d",
    "gazebo_msgs/LinkState": "0818ebbf28ce3a08d48ab1eaa7309ebe",
    "gazebo_msgs/LinkStates": "48c080191eb15c41858319b4d8a609c2",
    "gazebo_msgs/ModelState": "9330fd35f2fcd82d457e54bd54e10593",
    "gazebo_msgs/ModelStates": "48c080191eb15c41858319b4d8a609c2",
    "gazebo_msgs/ODEJointProperties": "1b744c32a920af979f53afe2f9c3511f",
    "gazebo_msgs/ODEPhysics": "667d56ddbd547918c32d1934503dc335",
    "gazebo_msgs/PerformanceMetrics": "884f71fd5037b886ec5e126b83c4425a",
    "gazebo_msgs/SensorPerformanceMetric": "01762ded18cfe9ebc7c8222667c99547",
    "gazebo_msgs/WorldState": "de1a9de3ab7ba97ac0e9ec01a4eb481e",
    "gazebo_grasp_plugin_ros/GazeboGraspEvent": "a5b6c6f554465c6bcbcad9409a41137a",
    "hector_uav_msgs/Altimeter": "c785451e2f67a76b902818138e9b53c6",
    "hector_uav_msgs/MotorCommand": "ccd4d4d4606731d1c73409e9bfa55808",
    "hector_uav_msgs/MotorPWM": "42f78dd80f99e0208248b8a257b8a645",
    "hector_uav_msgs/MotorStatus": "d771017cd812838d32da48fbe32b0928",
    "hector_uav_msgs/Supply": "26f5225a2b836fba706a87e45759fdfc",
    "kobuki_msgs/BumperEvent": "ffe360cd50f14f9251d9844083e72ac5",
    "kobuki_msgs/CliffEvent": "c5b106efbb1427a94f517c5e05f06295",
    "kobuki_msgs/MotorPower": "8f77c0161e0f2021493136bb5f3f0e51",
    "kobuki_msgs/SensorState": "430a4bfd78449c8740bfef32b26613a6",
    "kobuki_msgs/WheelDropEvent": "e102837d89384d67669a0df86b63f33b",
    "mav_msgs/Actuators": "25741daf38ed25442e3a66a855ee8d9c",
    "roscpp/Logger": "a6069a2ff40db7bd32143dd66e1f408e",
    "rosgraph_msgs/Log": "acffd30cd6b6de30f120938c17c593fb",
    "tf2_msgs/TFMessage": "94810edda583a504dfda3829e70d7eec",
    "unitree_legged_msgs/MotorCmd": "bbb3b7d91319c3a1b99055f0149ba221",
    "unitree_legged_msgs/MotorState": "94c55ee3b7852be2bd437b20ce12a254",
    "sensor_msgs/Imu": "6a62c6daae103f4ff57a132d6f95cec2",
    "nav_msgs/Odometry": "cd5e73d190d741a2f92e81eda573aca7",
    "geometry_msgs/Twist": "9f195f881246fdfa2798d1d3eebca84a",
}
SERVICES = {
    "control_msgs/QueryCalibrationState": "28af3beedcb84986b8e470dc5470507d",
    "control_msgs/QueryTrajectoryState": "ec93cdecbd8062d761aa52b7c90cd44b",
    "controller_manager_msgs/ListControllerTypes": "c1d4cd11aefa9f97ba4aeb5b33987f4e",
    "controller_manager_msgs/ListControllers": "1341feb2e63fa791f855565d0da950d8",
    "controller_manager_msgs/LoadController": "647e5c54b8d6468952d8d31f1efe96c0",
    "controller_manager_msgs/ReloadControllerLibraries": "40e8c411fd1797d2e2c486018f846040",
    "controller_manager_msgs/SwitchController": "b29a7abc673b2c54c14b54e50f8d06a5",
    "controller_manager_msgs/UnloadController": "647e5c54b8d6468952d8d31f1efe96c0",
    "dynamic_reconfigure/Reconfigure": "bb125d226a21982a4a98760418dc2672",
    "gazebo_msgs/ApplyBodyWrench": "585b9f9618aa0581b207e2f2d90866bc",
    "gazebo_msgs/ApplyJointEffort": "c0039811b8cc919490b3cff748cdf46b",
    "gazebo_msgs/BodyRequest": "5eade9afe7f232d78005bd0cafeab755",
    "gazebo_msgs/DeleteLight": "ae11ea8100d536d5b92c2b5917abf912",
    "gazebo_msgs/DeleteModel": "9ce56b4e9e54616de25d796dc972a262",
    "gazebo_msgs/GetJointProperties": "7b30be900f50aa21efec4a0ec92d91c9",
    "gazebo_msgs/GetLightProperties": "df2cef87e13e2e6990e81e8aaa454c19",
    "gazebo_msgs/GetLinkProperties": "0e06a70386d0ee3fb880c02f23fcd821",
    "gazebo_msgs/GetLinkState": "09d6c98cce97b35f7ab9bd70300657ab",
    "gazebo_msgs/GetModelProperties": "5717f7bd34ed990fa80e28b3015027a3",
    "gazebo_msgs/GetModelState": "4c515e936d3319c9610c559c60bfc3d4",
    "gazebo_msgs/GetPhysicsProperties": "575a5e74786981b7df2e3afc567693a6",
    "gazebo_msgs/GetWorldProperties": "36bb0f2eccf4d8be971410c22818ba3f",
    "gazebo_msgs/JointRequest": "0be1351618e1dc030eb7959d9a4902de",
    "gazebo_msgs/SetJointProperties": "15a76e921b1410c698d82782ea5fa370",
    "gazebo_msgs/SetJointTrajectory": "88f5c10979e3f9649d5ae87a3b12aa65",
    "gazebo_msgs/SetLightProperties": "e6f13430c57278bb364aca53a1bf5ebf",
    "gazebo_msgs/SetLinkProperties": "d534ce1b36ee99de0ffa806c3a6348f0",
    "gazebo_msgs/SetLinkState": "8a5146eb66ae4d26b0860b08f3f271be",
    "gazebo_msgs/SetModelConfiguration": "10e3139d3b669c40afc057d38956fff7",
    "gazebo_msgs/SetModelState": "5b3ab0281d4f5445def017e3a2e4a07b",
    "gazebo_msgs/SetPhysicsProperties": "97e2057080558ce4730434b5fae75c91",
    "gazebo_msgs/SpawnModel": "9ed9c82c96abe1a00c3e8cdaeee24413",
    "gazebo_ros_link_attacher/Attach": "c91fb3be70ce66d19130d40294cf4bd5",
    "hector_gazebo_plugins/SetBias": "af1f260075d9ba9bd73ca10c6a45df07",
    "roscpp/GetLoggers": "32e97e85527d4678a8f9279894bb64b0",
    "roscpp/SetLoggerLevel": "51da076440d78ca1684d36c868df61ea",
    "sensor_msgs/SetCameraInfo": "bef1df590ed75ed1f393692395e15482",
    "std_srvs/Empty": "d41d8cd98f00b204e9800998ecf8427e",
    "std_srvs/SetBool": "09fb03525b03e7ea1fd3992bafd87e16",
    "std_srvs/Trigger": "937c9679a518e3a18d831e57125ea522",
}


@pytest.fixture(scope="module")
def noetic() -> Any:
    made = get_typestore(Stores.ROS1_NOETIC)
    ours = {}
    for name, text in definitions():
        (ours[name],) = get_types_from_msg(text, name).values()
    made.register(ours)
    return made


def hashed_text(types: Any, name: str) -> str:
    """What ROS 1 hashes of a message: constants, then fields, messages in it by their hash."""
    times = {"builtin_interfaces/msg/Time": "time", "builtin_interfaces/msg/Duration": "duration"}
    constants, fields = types.fielddefs[name]
    lines = [f"{kind} {field}={value}" for field, kind, value in constants]
    for field, kind in fields:
        if field == "structure_needs_at_least_one_member":
            continue
        brackets, (node, value) = "", kind
        if kind[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            brackets, (node, value) = f"[{kind[1][1] or ''}]", kind[1][0]
        if node == Nodetype.BASE:
            lines.append(f"{value[0]}{brackets} {field}")
        elif value in times:
            lines.append(f"{times[value]}{brackets} {field}")
        else:
            lines.append(f"{md5(hashed_text(types, value))} {field}")
    return "\n".join(lines)


def md5(text: str) -> str:
    return hashlib.md5(text.encode()).hexdigest()


def test_messages_have_the_sums_of_ros1(noetic: Any) -> None:
    found = {name: md5(hashed_text(noetic, name.replace("/", "/msg/"))) for name in MESSAGES}
    assert found == MESSAGES


def test_services_have_the_sums_of_ros1(noetic: Any) -> None:
    texts = {
        name: [
            hashed_text(noetic, f"{name.replace('/', '/srv/')}_{part}")
            for part in ("Request", "Response")
        ]
        for name in SERVICES
    }
    assert {name: md5("".join(parts)) for name, parts in texts.items()} == SERVICES


def test_every_definition_is_compared() -> None:
    ours = {name for name, _ in definitions() if "/msg/" in name}
    assert {name.replace("/msg/", "/") for name in ours} <= set(MESSAGES)
    services = {name.removesuffix("_Request") for name, _ in definitions() if "_Request" in name}
    assert {name.replace("/srv/", "/") for name in services} == set(SERVICES)


def test_the_store_holds_every_definition() -> None:
    for name, _ in definitions():
        assert message_class(name).__msgtype__ == name
    assert "tf2_msgs/msg/TFMessage" in store().types


def test_a_service_has_two_classes() -> None:
    request, response = service_classes("gazebo_msgs/SpawnModel")
    assert request.__msgtype__ == "gazebo_msgs/srv/SpawnModel_Request"
    assert response(success=True, status_message="").success
    assert service_classes("std_srvs/srv/Empty")[0].__msgtype__ == "std_srvs/srv/Empty_Request"


def test_headers_are_those_of_ros2() -> None:
    fields = message_class("std_msgs/Header").__dataclass_fields__
    assert [name for name in fields if not name.startswith("__")] == ["stamp", "frame_id"]


def test_an_unknown_type_names_the_likely_one() -> None:
    with raises(MESSAGE_TYPE_UNKNOWN, meant="geometry_msgs/msg/Twist"):
        message_class("geometry_msgs/Twst")
    with raises(MESSAGE_TYPE_UNKNOWN, meant="std_srvs/srv/Trigger"):
        service_classes("std_srvs/srv/Triger")
