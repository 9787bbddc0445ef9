"""Actions over DDS, as rclcpp_action calls them: services and topics below ``_action``."""

from __future__ import annotations

import contextlib
import itertools
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.bridges.ros1_peers import wait_for
from tests.bridges.ros2_peers import DOMAIN, REASON, Peer, Ros2Bridged
from tests.dialects.ros_control.arms import beam, robot, ros2_joint, ros2_parameters, ros2_plugin
from tests.dialects.ros_control.arms import ros2_system as system

from cartwheel.description import load_text
from cartwheel.messages import decode_cdr
from cartwheel.session import Session

pytestmark = pytest.mark.skipif(bool(REASON), reason=REASON)

ARM = "/arm_controller/follow_joint_trajectory"
FINGER = "/gripper/gripper_cmd"
TRAJECTORY = "control_msgs_ros2/action/FollowJointTrajectory"
GRIPPER = "control_msgs_ros2/action/GripperCommand"
CANCEL = "action_msgs/srv/CancelGoal"
STATUS = "action_msgs/msg/GoalStatusArray"
UNKNOWN, EXECUTING, SUCCEEDED, CANCELED, ABORTED = 0, 2, 4, 5, 6
JOINTS = ("a_joint", "b_joint")
SLOW = 'lower="-3" upper="3" effort="100" velocity="0.2"'
"""The limits of a joint that keeps up with little."""
numbers = itertools.count(1)


def spawn_arm(folder: Path) -> Any:
    """Two joints that follow trajectories, and a third that grips."""
    file = folder / "controllers.yaml"
    file.write_text(
        yaml.safe_dump(
            ros2_parameters(
                arm_controller={
                    "type": "joint_trajectory_controller/JointTrajectoryController",
                    "joints": list(JOINTS),
                    "command_interfaces": ["position"],
                    "state_interfaces": ["position", "velocity"],
                },
                gripper={
                    "type": "position_controllers/GripperActionController",
                    "joint": "c_joint",
                },
            )
        )
    )
    body = beam("a", "world") + beam("b", "world", origin="0 1 1", limit=SLOW)
    body += beam("c", "world", origin="0 2 1", limit=SLOW)
    body += system(*(ros2_joint(name) for name in (*JOINTS, "c_joint")))

    def spawn(session: Session) -> None:
        session.spawn(load_text(robot(body, ros2_plugin(file)), file=str(folder / "arm.urdf")))

    return spawn


@pytest.fixture(scope="module")
def bridged(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros2Bridged]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 5))
        made = Ros2Bridged(robot=False, prepare=spawn_arm(tmp_path_factory.mktemp("arm")))
        yield made
        made.close()


@pytest.fixture(scope="module")
def peer(bridged: Ros2Bridged) -> Iterator[Peer]:
    made = Peer(DOMAIN + 5)
    yield made
    made.close()


def uuid() -> dict[str, Any]:
    return {"uuid": [next(numbers), *range(15)]}


def point(seconds: int, *positions: float, nanosec: int = 0, **more: Any) -> dict[str, Any]:
    span = {"sec": seconds, "nanosec": nanosec}
    return {"positions": list(positions), "time_from_start": span, **more}


def send(peer: Peer, *points: dict[str, Any], names: Any = JOINTS, **more: Any) -> tuple[Any, bool]:
    """A goal's id, and whether it was accepted."""
    identity = uuid()
    goal = {"trajectory": {"joint_names": list(names), "points": list(points)}, **more}
    answer = peer.call(
        f"{ARM}/_action/send_goal", f"{TRAJECTORY}_SendGoal", {"goal_id": identity, "goal": goal}
    )
    return identity, answer.accepted


def result(peer: Peer, identity: Any, name: str = ARM, kind: str = TRAJECTORY) -> tuple[int, Any]:
    """What a goal ends as; waits until it does."""
    answer = peer.call(f"{name}/_action/get_result", f"{kind}_GetResult", {"goal_id": identity})
    return answer.status, answer.result


def cancel(peer: Peer, identity: Any = None, name: str = ARM) -> Any:
    info = {"goal_id": identity} if identity else {}
    return peer.call(f"{name}/_action/cancel_goal", CANCEL, {"goal_info": info})


def nodes(peer: Peer) -> dict[str, set[bytes]]:
    """The endpoints of each node as last published on ``ros_discovery_info``."""
    name = "rmw_dds_common/msg/ParticipantEntitiesInfo"
    data = [
        bytes.fromhex(line[3])
        for line in peer.lines[:]
        if line[0] == "DATA" and line[1] == "ros_discovery_info"
    ]
    return {
        f"{node.node_namespace.rstrip('/')}/{node.node_name}": {
            gid.data.tobytes() for gid in (*node.reader_gid_seq, *node.writer_gid_seq)
        }
        for node in (decode_cdr(data[-1], name).node_entities_info_seq if data else ())
    }


def test_controllers_and_their_manager_are_nodes(bridged: Ros2Bridged) -> None:
    package = "rcl_interfaces/srv"
    with contextlib.closing(Peer(DOMAIN + 5)) as peer:
        peer.tell(
            "sub", "ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_", 1, 1
        )
        own = {"/gazebo", "/controller_manager", "/arm_controller", "/gripper"}
        wait_for(lambda: nodes(peer).keys() == own, "the nodes")

        def topics(node: str) -> set[str]:
            known = {
                one.endpoint.guid: one.endpoint.topic
                for one in bridged.bridge.middleware._endpoints  # type: ignore[attr-defined]
            }
            return {known[guid] for guid in nodes(peer)[node] if guid in known}

        def has(node: str, *names: str) -> None:
            """Waits until a node has some endpoints."""
            look = bridged.bridge._loop.call
            wait_for(lambda: look(lambda: topics(node)).result() >= set(names), f"those of {node}")

        has(
            "/arm_controller",
            "rt/arm_controller/joint_trajectory",
            "rt/arm_controller/controller_state",
            f"rt{ARM}/_action/feedback",
            f"rq{ARM}/_action/send_goalRequest",
            "rr/arm_controller/get_parametersReply",
        )
        # What all nodes have.
        has("/arm_controller", "rt/rosout", "rt/parameter_events")
        has("/arm_controller", "rq/arm_controller/get_type_descriptionRequest")
        has("/controller_manager", "rq/controller_manager/list_controllersRequest")
        has("/gazebo", "rt/clock", "rr/gazebo/get_parametersReply")
        others = bridged.bridge._loop.call(lambda: topics("/gazebo")).result()
        assert not [name for name in others if "arm_controller" in name]
        of_ros1 = {f"rt{ARM}/{part}" for part in ("goal", "cancel", "status", "feedback", "result")}
        assert not of_ros1 & (topics("/arm_controller") | others)

        def call(node: str, kind: str, **fields: Any) -> Any:
            name = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in kind)
            return peer.call(f"{node}/{name.strip('_')}", f"{package}/{kind}", fields)

        names = call("/arm_controller", "ListParameters").result.names
        assert names == ["command_interfaces", "joints", "state_interfaces", "type", "use_sim_time"]
        joints, kind, nothing = call(
            "/arm_controller", "GetParameters", names=["joints", "type", "none"]
        ).values
        assert (joints.type, joints.string_array_value) == (9, list(JOINTS))
        assert kind.string_value == "joint_trajectory_controller/JointTrajectoryController"
        assert nothing.type == 0
        (refused,) = call(
            "/arm_controller",
            "SetParameters",
            parameters=[{"name": "type", "value": {"type": 4, "string_value": "x"}}],
        ).results
        assert not refused.successful and refused.reason
        managed = call("/controller_manager", "GetParameters", names=["gripper.type"]).values
        assert managed[0].string_value == "position_controllers/GripperActionController"


def position(bridged: Ros2Bridged, joint: str) -> float:
    simulation = bridged.simulation
    return simulation.call(lambda: simulation.joint_position("arm", joint)).result()


def test_a_goal_is_followed_and_published(bridged: Ros2Bridged, peer: Peer) -> None:
    feedback = f"{TRAJECTORY}_FeedbackMessage"
    peer.subscribe(f"{ARM}/_action/feedback", feedback)
    peer.subscribe(f"{ARM}/_action/status", STATUS, transient=True)
    wait_for(
        lambda: next(each for each in bridged.graph.actions() if each.name == ARM).wants_feedback,
        "the reader of the feedback",
    )
    identity, accepted = send(peer, point(1, 0.5, 0.1))
    assert accepted
    status, ended = result(peer, identity)
    assert (status, ended.error_code) == (SUCCEEDED, 0)
    assert position(bridged, "a_joint") == pytest.approx(0.5, abs=0.02)
    reported = wait_for(
        lambda: [
            each
            for each in peer.messages(f"{ARM}/_action/feedback", feedback)
            if each.goal_id.uuid.tolist() == identity["uuid"]
        ],
        "feedback",
    )
    assert reported[0].feedback.joint_names == list(JOINTS)
    assert len(reported[0].feedback.desired.positions) == 2

    def states() -> list[int]:
        return [
            one.status
            for array in peer.messages(f"{ARM}/_action/status", STATUS)
            for one in array.status_list
            if one.goal_info.goal_id.uuid.tolist() == identity["uuid"]
        ]

    wait_for(lambda: {EXECUTING, SUCCEEDED} <= set(states()), "both states")


def test_a_flood_of_changes_has_a_bounded_rate(bridged: Ros2Bridged, peer: Peer) -> None:
    """A message has the states of all goals, for each of which the simulation's thread is asked."""
    identity, _ = send(peer, point(1, 0.0, 0.0))
    result(peer, identity)
    offered = bridged.bridge._actions[ARM]
    sent: list[bytes] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(offered._status, "send", sent.append)

        def flood() -> float:
            begin = time.monotonic()
            goal = offered.action.goals[-1]
            for _ in range(200):
                offered.goal_changed(goal)
            return time.monotonic() - begin

        seconds = bridged.simulation.call(flood).result(60)
        # The last of them is published too.
        wait_for(lambda: not offered._status_due, "the states")
        bridged.bridge._loop.call(lambda: None).result(60)
    assert 1 <= len(sent) <= seconds / 0.05 + 2


def test_names_and_points_that_make_no_sense_are_rejected(peer: Peer) -> None:
    for names, points in (
        (JOINTS[:1], [point(1, 0.1)]),
        (("a_joint", "elbow"), [point(1, 0.1, 0.1)]),
        (JOINTS, []),
        (JOINTS, [point(1, 0.1)]),
        (JOINTS, [point(1, 0.1, 0.1), point(1, 0.2, 0.2)]),
        (JOINTS, [point(1, 0.1, 0.1, velocities=[0.5, 0.0])]),
    ):
        identity, accepted = send(peer, *points, names=names)
        assert not accepted, (names, points)
        assert result(peer, identity)[0] == UNKNOWN


def test_a_goal_is_cancelled_where_it_is(bridged: Ros2Bridged, peer: Peer) -> None:
    send(peer, point(0, 0.0, 0.0))
    identity, _ = send(peer, point(1000, 2.0, 0.0))
    assert cancel(peer, uuid()).return_code == 2  # ERROR_UNKNOWN_GOAL_ID
    answer = cancel(peer, identity)
    assert answer.return_code == 0
    assert [one.goal_id.uuid.tolist() for one in answer.goals_canceling] == [identity["uuid"]]
    assert result(peer, identity)[0] == CANCELED
    assert abs(position(bridged, "a_joint")) < 1.0
    assert cancel(peer, identity).return_code == 3  # ERROR_GOAL_TERMINATED
    assert cancel(peer).return_code == 1  # ERROR_REJECTED: there is none to be cancelled


def test_all_goals_are_cancelled_at_once(peer: Peer) -> None:
    first, _ = send(peer, point(1000, 1.0, 0.0))
    assert [one.goal_id.uuid.tolist() for one in cancel(peer).goals_canceling] == [first["uuid"]]


def test_a_new_goal_ends_the_one_before(peer: Peer) -> None:
    first, _ = send(peer, point(1000, 1.0, 0.0))
    second, accepted = send(peer, point(1, 0.1, 0.0))
    assert accepted
    status, ended = result(peer, first)
    assert (status, ended.error_code) == (ABORTED, -1)
    assert result(peer, second)[0] == SUCCEEDED


def test_a_path_that_cannot_be_kept_is_aborted(peer: Peer) -> None:
    tolerance = [{"name": "b_joint", "position": 0.05}]
    identity, _ = send(peer, point(1, 0.0, 2.0), path_tolerance=tolerance)
    status, ended = result(peer, identity)
    assert (status, ended.error_code) == (ABORTED, -4)
    assert "b_joint" in ended.error_string


def test_a_goal_that_is_missed_is_aborted_after_its_time(peer: Peer) -> None:
    send(peer, point(0, 0.0, 0.0))
    identity, _ = send(
        peer,
        point(1, 0.0, 1.0),
        goal_tolerance=[{"name": "b_joint", "position": 0.05}],
        goal_time_tolerance={"sec": 0, "nanosec": 200_000_000},
    )
    status, ended = result(peer, identity)
    assert (status, ended.error_code) == (ABORTED, -5)


def test_a_result_that_waits_is_sent_when_it_is_there(bridged: Ros2Bridged, peer: Peer) -> None:
    """The request comes before the goal ends, and from another node than the cancellation."""
    other = Peer(DOMAIN + 5)
    try:
        identity, _ = send(peer, point(1000, 1.0, 0.0))
        service = f"{ARM}/_action/get_result"
        action = next(each for each in bridged.graph.actions() if each.name == ARM)
        (listener,) = (each for each in action.listeners if hasattr(each, "_waiting"))
        before = len(other.lines)
        request = f"00010000{bytes(identity['uuid']).hex()}"
        kind = "control_msgs::action::dds_::FollowJointTrajectory_GetResult_"
        other.tell("call", service, kind, request)
        wait_for(lambda: listener._waiting, "the request for the result")
        assert cancel(peer, identity).return_code == 0
        (answer,) = wait_for(
            lambda: [line for line in other.lines[before:] if line[0] == "REPLY"], "the result"
        )
        # Its encapsulation, then the status.
        assert bytes.fromhex(answer[2])[4] == CANCELED
    finally:
        other.close()


def test_a_gripper_goes_where_it_is_commanded(bridged: Ros2Bridged, peer: Peer) -> None:
    identity = uuid()
    request = {"goal_id": identity, "goal": {"command": {"position": 0.3, "max_effort": 0.0}}}
    assert peer.call(f"{FINGER}/_action/send_goal", f"{GRIPPER}_SendGoal", request).accepted
    status, ended = result(peer, identity, FINGER, GRIPPER)
    assert (status, ended.reached_goal, ended.stalled) == (SUCCEEDED, True, False)
    assert position(bridged, "c_joint") == pytest.approx(0.3, abs=0.02)
    # A goal of the same name is not taken twice.
    assert not peer.call(f"{FINGER}/_action/send_goal", f"{GRIPPER}_SendGoal", request).accepted


def test_the_states_of_a_trajectory_controller_are_those_of_ros2(peer: Peer) -> None:
    kind = "control_msgs_ros2/msg/JointTrajectoryControllerState"
    peer.subscribe("/arm_controller/controller_state", kind)
    state = wait_for(lambda: peer.messages("/arm_controller/controller_state", kind), "a state")[0]
    assert state.joint_names == list(JOINTS)
    assert len(state.reference.positions) == len(state.feedback.positions) == 2
    assert state.output.positions.tolist() == state.reference.positions.tolist()


def test_what_others_see_of_it(peer: Peer) -> None:
    """Names, types and quality of service as rcl_action's."""
    base = f"{ARM}/_action"
    kind = "control_msgs::action::dds_::FollowJointTrajectory_"
    wait_for(lambda: f"rt{base}/status" in peer.endpoints("WRITER"), "the topics")
    writers, readers = peer.endpoints("WRITER"), peer.endpoints("READER")
    assert writers[f"rt{base}/status"][:3] == [
        "action_msgs::msg::dds_::GoalStatusArray_", "1", "1"
    ]  # fmt: skip
    assert writers[f"rt{base}/feedback"][:3] == [f"{kind}FeedbackMessage_", "1", "0"]
    assert readers[f"rq{base}/send_goalRequest"][0] == f"{kind}SendGoal_Request_"
    assert writers[f"rr{base}/get_resultReply"][0] == f"{kind}GetResult_Response_"
    assert (
        readers[f"rq{base}/cancel_goalRequest"][0] == "action_msgs::srv::dds_::CancelGoal_Request_"
    )


def test_controllers_are_listed_and_switched(peer: Peer) -> None:
    """As ``ros2 control`` and a spawner do it."""
    package, manager = "controller_manager_msgs_ros2/srv", "/controller_manager"
    listed = peer.call(f"{manager}/list_controllers", f"{package}/ListControllers", {})
    assert {each.name: each.state for each in listed.controller} == {
        "arm_controller": "active",
        "gripper": "active",
    }
    name = {"name": "gripper"}
    assert peer.call(f"{manager}/configure_controller", f"{package}/ConfigureController", name).ok
    assert peer.call(
        f"{manager}/switch_controller",
        f"{package}/SwitchController",
        {"activate_controllers": ["gripper"], "strictness": 2, "activate_asap": True},
    ).ok
    parts = peer.call(
        f"{manager}/list_hardware_components", f"{package}/ListHardwareComponents", {}
    )
    assert [each.state.label for each in parts.component] == ["active"]
