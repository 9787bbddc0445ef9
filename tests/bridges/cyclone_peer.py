"""A node on Cyclone DDS, with the conventions of rmw_cyclonedds, which a test starts as a program.

Arguments: ``cart`` or ``grip``, and the domain. It prints one line for each thing that it has seen;
the test judges.
"""

import random
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int8, int32, int64, sequence, uint8, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

_MEET = 60.0
"""How long the two sides of a topic may take to find each other, s."""
_RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=10)), Policy.History.KeepLast(200))
_SUCCEEDED, _CANCELED = 4, 5


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32 = 0
    nanosec: uint32 = 0


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0
    w: float64 = 1.0


@dataclass
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    position: Vector3
    orientation: Quaternion


@dataclass
class PoseWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovariance_"):
    pose: Pose
    covariance: array[float64, 36]


@dataclass
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    linear: Vector3
    angular: Vector3


@dataclass
class TwistWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::TwistWithCovariance_"):
    twist: Twist
    covariance: array[float64, 36]


@dataclass
class Odometry(IdlStruct, typename="nav_msgs::msg::dds_::Odometry_"):
    header: Header
    child_frame_id: str
    pose: PoseWithCovariance
    twist: TwistWithCovariance


@dataclass
class Image(IdlStruct, typename="sensor_msgs::msg::dds_::Image_"):
    header: Header
    height: uint32
    width: uint32
    encoding: str
    is_bigendian: uint8
    step: uint32
    data: sequence[uint8]


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: sequence[TransformStamped]


@dataclass
class Clock(IdlStruct, typename="rosgraph_msgs::msg::dds_::Clock_"):
    clock: Time


# In rmw_cyclonedds, a request and its response begin with the client and a number.


@dataclass
class SpawnRequest(IdlStruct, typename="gazebo_msgs::srv::dds_::SpawnEntity_Request_"):
    client: uint64
    number: int64
    name: str
    xml: str
    robot_namespace: str
    initial_pose: Pose
    reference_frame: str


@dataclass
class SpawnResponse(IdlStruct, typename="gazebo_msgs::srv::dds_::SpawnEntity_Response_"):
    client: uint64
    number: int64
    success: bool
    status_message: str


@dataclass
class EmptyRequest(IdlStruct, typename="std_srvs::srv::dds_::Empty_Request_"):
    client: uint64
    number: int64
    structure_needs_at_least_one_member: uint8 = 0


@dataclass
class EmptyResponse(IdlStruct, typename="std_srvs::srv::dds_::Empty_Response_"):
    client: uint64
    number: int64
    structure_needs_at_least_one_member: uint8


@dataclass
class Uuid(IdlStruct, typename="unique_identifier_msgs::msg::dds_::UUID_"):
    uuid: array[uint8, 16]


@dataclass
class GoalInfo(IdlStruct, typename="action_msgs::msg::dds_::GoalInfo_"):
    goal_id: Uuid
    stamp: Time


@dataclass
class Goal(IdlStruct, typename="control_msgs::msg::dds_::GripperCommand_"):
    position: float64
    max_effort: float64 = 0.0


@dataclass
class SendGoalRequest(
    IdlStruct, typename="control_msgs::action::dds_::GripperCommand_SendGoal_Request_"
):
    client: uint64
    number: int64
    goal_id: Uuid
    goal: Goal


@dataclass
class SendGoalResponse(
    IdlStruct, typename="control_msgs::action::dds_::GripperCommand_SendGoal_Response_"
):
    client: uint64
    number: int64
    accepted: bool
    stamp: Time


@dataclass
class GetResultRequest(
    IdlStruct, typename="control_msgs::action::dds_::GripperCommand_GetResult_Request_"
):
    client: uint64
    number: int64
    goal_id: Uuid


@dataclass
class Outcome(IdlStruct, typename="control_msgs::action::dds_::GripperCommand_Result_"):
    position: float64
    effort: float64
    stalled: bool
    reached_goal: bool


@dataclass
class GetResultResponse(
    IdlStruct, typename="control_msgs::action::dds_::GripperCommand_GetResult_Response_"
):
    client: uint64
    number: int64
    status: int8
    result: Outcome


@dataclass
class FeedbackMessage(
    IdlStruct, typename="control_msgs::action::dds_::GripperCommand_FeedbackMessage_"
):
    goal_id: Uuid
    feedback: Outcome


@dataclass
class CancelRequest(IdlStruct, typename="action_msgs::srv::dds_::CancelGoal_Request_"):
    client: uint64
    number: int64
    goal_info: GoalInfo


@dataclass
class CancelResponse(IdlStruct, typename="action_msgs::srv::dds_::CancelGoal_Response_"):
    client: uint64
    number: int64
    return_code: int8
    goals_canceling: sequence[GoalInfo]


_CRATE = """<robot name="crate"><link name="body">
  <inertial><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link></robot>"""


class Node:
    """Endpoints with ROS 2's names in a domain."""

    def __init__(self, domain: int) -> None:
        self._participant = DomainParticipant(domain)
        self._client = random.getrandbits(63)

    def reader(self, topic: str, type_: Any, qos: Qos = _RELIABLE) -> DataReader[Any]:
        """Reads a topic, which has a prefix such as ``rt``."""
        return DataReader(self._participant, Topic(self._participant, topic, type_), qos=qos)

    def writer(self, topic: str, type_: Any) -> DataWriter[Any]:
        """Writes a topic."""
        return DataWriter(self._participant, Topic(self._participant, topic, type_), qos=_RELIABLE)

    def client(self, service: str, request: Any, response: Any) -> Callable[..., Any]:
        """Returns a function that calls a service with the fields of its request, and waits."""
        writer = self.writer(f"rq{service}Request", request)
        reader = self.reader(f"rr{service}Reply", response)
        numbers = iter(range(1, 1000))

        def call(*values: Any, seconds: float = 60.0) -> Any:
            # A call before both sides know each other is lost in ROS 2.
            _within(
                lambda: writer.get_matched_subscriptions() and reader.get_matched_publications(),
                _MEET,
            )
            number = next(numbers)
            writer.write(request(self._client, number, *values))
            return _within(
                lambda: next(
                    (
                        each
                        for each in _taken(reader)
                        if (each.client, each.number) == (self._client, number)
                    ),
                    None,
                ),
                seconds,
            )

        return call


def _within(condition: Callable[[], Any], seconds: float) -> Any:
    """The first true value; the last one after a time."""
    end = time.monotonic() + seconds
    while not (found := condition()) and time.monotonic() < end:
        time.sleep(0.01)
    return found


def _taken(reader: DataReader[Any]) -> Iterator[Any]:
    for each in reader.take(100):
        if each.sample_info.valid_data:
            yield each


def _say(*words: Any) -> None:
    sys.stdout.write(" ".join(map(str, words)) + "\n")


def _cart(domain: int) -> None:
    """Reads the simulation, drives the cart, and calls services."""
    node = Node(domain)
    odometry = node.reader("rt/odom", Odometry)
    transforms = node.reader("rt/tf", TFMessage)
    clocks = node.reader("rt/clock", Clock)
    sensor = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5))
    images = node.reader("rt/rosbots/camera1/image_raw", Image, sensor)
    commands = node.writer("rt/part2_cmr/cmd_vel", Twist)
    spawn = node.client("/spawn_entity", SpawnRequest, SpawnResponse)
    reset = node.client("/reset_simulation", EmptyRequest, EmptyResponse)
    pose = Pose(Vector3(0.0, 5.0, 0.1), Quaternion())
    answer = spawn("crate", _CRATE, "", pose, "")
    _say("spawn", *((answer.success, answer.status_message) if answer else ("failed",)))
    # As long as it takes: two seconds of odometry where the computer is not busy.
    end = time.monotonic() + 240
    count = dict.fromkeys(("odometry", "tf", "clock", "images"), 0)
    x, frame, size = 0.0, "", (0, 0, 0)
    while time.monotonic() < end and not (
        min(count["odometry"], count["tf"], count["clock"]) > 200
        and count["images"] > 20
        and x > 0.5
    ):
        commands.write(Twist(Vector3(x=0.5), Vector3()))
        for each in _taken(odometry):
            count["odometry"] += 1
            x = each.pose.pose.position.x
        for each in _taken(transforms):
            count["tf"] += 1
            for one in each.transforms:
                if one.header.frame_id == "odom":
                    frame = one.child_frame_id
        for _ in _taken(clocks):
            count["clock"] += 1
        for each in _taken(images):
            count["images"] += 1
            size = each.width, each.height, len(each.data)
        time.sleep(0.01)
    _say("odometry", count["odometry"], f"{x:.3f}")
    _say("tf", count["tf"], frame)
    _say("clock", count["clock"])
    _say("images", count["images"], *size)
    _say("reset", reset() is not None)


def _grip(domain: int) -> None:
    """Sends a goal to a gripper and waits for its end, then sends another and cancels it."""
    node = Node(domain)
    action = "/gripper/gripper_cmd/_action"
    send = node.client(f"{action}/send_goal", SendGoalRequest, SendGoalResponse)
    result = node.client(f"{action}/get_result", GetResultRequest, GetResultResponse)
    cancel = node.client(f"{action}/cancel_goal", CancelRequest, CancelResponse)
    feedback = node.reader(f"rt{action}/feedback", FeedbackMessage)
    _within(feedback.get_matched_publications, _MEET)
    first, second = (Uuid([index, *range(15)]) for index in (1, 2))
    answer = send(first, Goal(0.3))
    _say("goal", answer is not None and answer.accepted)
    answer = result(first)
    if answer:
        outcome = answer.result
        _say("result", answer.status == _SUCCEEDED, f"{outcome.position:.2f}", outcome.reached_goal)
    _say("feedback", sum(list(each.goal_id.uuid) == list(first.uuid) for each in _taken(feedback)))
    send(second, Goal(2.5))
    answer = cancel(GoalInfo(second, Time()))
    _say("cancel", answer is not None and len(answer.goals_canceling) == 1)
    answer = result(second)
    _say("second", answer is not None and answer.status == _CANCELED)


if __name__ == "__main__":
    {"cart": _cart, "grip": _grip}[sys.argv[1]](int(sys.argv[2]))
