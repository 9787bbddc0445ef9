"""Topics, services and tokens over Zenoh, by a session that speaks as rmw_zenoh does.

What is written here is rmw_zenoh's: keys, attachments and tokens in full, as literals.
"""

from __future__ import annotations

import json
import struct
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
from tests.bridges.ros1_peers import wait_for
from tests.bridges.ros2_peers import Ros2Bridged
from tests.bridges.test_ros2_services import prepared
from tests.reserved import free_port

from cartwheel.bridges.ros2 import zenoh as ours
from cartwheel.bridges.ros2 import zenoh_session
from cartwheel.graph import Action, Goal
from cartwheel.messages import decode_cdr, encode_cdr, from_dict
from cartwheel.messages.ros2.types import ros2_service

zenoh = pytest.importorskip("zenoh", reason="not installed: eclipse-zenoh")

ODOM = (
    "7/odom/nav_msgs::msg::dds_::Odometry_/"
    "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"
)
TWIST = (
    "7/part2_cmr/cmd_vel/geometry_msgs::msg::dds_::Twist_/"
    "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"
)
IMAGE = (
    "7/rosbots/camera1/image_raw/sensor_msgs::msg::dds_::Image_/"
    "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"
)
PAUSE = (
    "7/pause_physics/std_srvs::srv::dds_::Empty_/"
    "RIHS01_5888399dedec5ccc85ea6451949fd2c9f97bfdf963f9a588821639fcd31b5d19"
)


@pytest.fixture(scope="module")
def bridged() -> Iterator[Ros2Bridged]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", "7")
        patch.setattr(zenoh_session, "PORT", free_port())
        made = Ros2Bridged(prepare=prepared, rmw="zenoh")
        yield made
        made.close()


@pytest.fixture
def session(bridged: Ros2Bridged) -> Iterator[Any]:
    """A session at the router that the simulation opened."""
    config = zenoh.Config()
    for name, value in {
        "mode": "peer",
        "scouting/multicast/enabled": False,
        "listen/endpoints": ["tcp/127.0.0.1:0"],
        "connect/endpoints": [f"tcp/127.0.0.1:{zenoh_session.PORT}"],
        "connect/timeout_ms": 10_000,
    }.items():
        config.insert_json5(name, json.dumps(value))
    made = zenoh.open(config)
    yield made
    made.close()


def test_tokens_announce_the_node_and_its_endpoints(session: Any) -> None:
    tokens: list[str] = []
    subscriber = session.liveliness().declare_subscriber(
        "@ros2_lv/7/**", lambda sample: tokens.append(str(sample.key_expr)), history=True
    )
    wait_for(lambda: any("%pause_physics" in token for token in tokens), "the tokens")
    zid = tokens[0].split("/")[2]
    assert f"@ros2_lv/7/{zid}/0/0/NN/%/%/gazebo" in tokens
    ends = {token.split("/", 5)[5] for token in tokens}
    odom = ODOM.removeprefix("7/odom/")
    assert f"MP/%/%/gazebo/%odom/{odom}/::,10:,:,:,," in ends
    # Best effort, five kept; then reliable for what everybody must get.
    image = IMAGE.removeprefix("7/rosbots/camera1/image_raw/")
    assert f"MP/%/%/gazebo/%rosbots%camera1%image_raw/{image}/2::,5:,:,:,," in ends
    twist = TWIST.removeprefix("7/part2_cmr/cmd_vel/")
    assert f"MS/%/%/gazebo/%part2_cmr%cmd_vel/{twist}/::,10:,:,:,," in ends
    assert any(end.startswith("MP/%/%/gazebo/%tf_static/") and "/:1:,1:" in end for end in ends)
    subscriber.undeclare()


def test_a_node_of_its_own_is_announced_while_it_has_something(
    bridged: Ros2Bridged, session: Any
) -> None:
    tokens: set[str] = set()

    def seen(sample: Any) -> None:
        there = sample.kind == zenoh.SampleKind.PUT
        (tokens.add if there else tokens.discard)(str(sample.key_expr).split("/", 3)[3])

    subscriber = session.liveliness().declare_subscriber(
        "@ros2_lv/7/*/*/*/*/%/%left/arm/**", seen, history=True
    )
    bridged.graph.nodes["test/arm"] = "/left/arm"
    publisher = bridged.graph.advertise("/left/said", "std_msgs/msg/String", node="test/arm")
    heard = bridged.graph.subscribe(
        "/left/heard", lambda _: None, type_name="std_msgs/msg/String", node="test/arm"
    )
    # Every node has two topics and a service beside its own.
    wait_for(lambda: len(tokens) == 6, "a node, what it publishes, reads and offers")
    numbers = {token.split("/")[0] for token in tokens}
    (number,) = numbers
    assert number != "0"
    assert f"{number}/{number}/NN/%/%left/arm" in tokens
    ends = {"/".join(token.split("/")[2:7]) for token in tokens}
    assert {"MP/%/%left/arm/%left%said", "MS/%/%left/arm/%left%heard"} < ends
    assert {"MP/%/%left/arm/%rosout", "SS/%/%left/arm/%left%arm%get_type_description"} < ends
    publisher.close()
    wait_for(lambda: len(tokens) == 5, "that it publishes no longer")
    heard.close()
    wait_for(lambda: not tokens, "the end of the node")
    subscriber.undeclare()


def test_topics_are_read_lazily_and_attachments_count(bridged: Ros2Bridged, session: Any) -> None:
    assert not bridged.wanted("/odom")
    samples: list[tuple[bytes, bytes]] = []
    subscriber = session.declare_subscriber(
        ODOM,
        lambda sample: samples.append((sample.payload.to_bytes(), sample.attachment.to_bytes())),
    )
    wait_for(lambda: len(samples) > 50, "odometry")
    assert bridged.wanted("/odom")
    numbers = [struct.unpack_from("<q", attachment)[0] for _, attachment in samples]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert {(len(attachment), attachment[16]) for _, attachment in samples} == {(33, 16)}
    assert decode_cdr(samples[-1][0], "nav_msgs/msg/Odometry").header.frame_id == "odom"
    subscriber.undeclare()
    wait_for(lambda: not bridged.wanted("/odom"), "that nothing is published for nobody")


def test_what_is_read_here_too_comes_once_and_is_not_sent_for_that(
    bridged: Ros2Bridged, session: Any
) -> None:
    stamps: list[int] = []

    def take(message: Any) -> None:
        stamps.append(message.header.stamp.sec * 10**9 + message.header.stamp.nanosec)

    tokens: list[str] = []
    watch = session.liveliness().declare_subscriber(
        "@ros2_lv/7/*/*/*/MS/**", lambda sample: tokens.append(str(sample.key_expr)), history=True
    )
    inner = bridged.graph.subscribe("/odom", take, node="test")
    # A reader here listens to others as well: that must not be mistaken for one of theirs.
    wait_for(lambda: any("/%odom/" in token for token in tokens), "the reader of /odom")
    wait_for(lambda: len(stamps) > 20, "odometry")
    assert "ros2" not in bridged.graph.topic("/odom").subscribers
    outer: list[bytes] = []
    subscriber = session.declare_subscriber(
        ODOM, lambda sample: outer.append(sample.payload.to_bytes())
    )
    wait_for(lambda: len(outer) > 50, "odometry for another")
    inner.close()
    subscriber.undeclare()
    watch.undeclare()
    assert len(set(stamps)) == len(stamps)


def test_images_arrive_whole(session: Any) -> None:
    sizes: list[int] = []
    subscriber = session.declare_subscriber(
        IMAGE, lambda sample: sizes.append(len(sample.payload.to_bytes()))
    )
    wait_for(lambda: len(sizes) > 10, "images")
    assert len(set(sizes)) == 1
    assert sizes[0] > 100_000
    subscriber.undeclare()


def test_cmd_vel_drives_the_cart(bridged: Ros2Bridged, session: Any) -> None:
    publisher = session.declare_publisher(TWIST)
    data = encode_cdr(from_dict("geometry_msgs/msg/Twist", {"linear": {"x": 0.5}}))

    def x() -> float:
        simulation = bridged.simulation
        return float(simulation.call(lambda: simulation.pose("rosbots")).result().position[0])

    start = x()

    def moved() -> bool:
        publisher.put(data, attachment=struct.pack("<qqB", 1, time.time_ns(), 16) + bytes(16))
        return x() > start + 0.3

    wait_for(moved, "the cart's way")


def test_services_answer_with_what_was_asked_by(bridged: Ros2Bridged, session: Any) -> None:
    attachment = struct.pack("<qqB", 41, 5, 16) + b"who asks for it."
    replies = list(session.get(PAUSE, payload=b"\0\1\0\0\0", attachment=attachment, timeout=20.0))
    assert bridged.simulation.run_state.value == "paused"
    (reply,) = replies
    reported = reply.ok.attachment.to_bytes()
    assert struct.unpack_from("<q", reported) == (41,)
    assert reported[16:] == b"\x10who asks for it."
    bridged.simulation.post(bridged.simulation.resume)


@pytest.mark.parametrize("package", ["simulation_interfaces", "simulation_interfaces_v1"])
def test_each_release_finds_the_service_by_its_own_hash(session: Any, package: str) -> None:
    type_ = ros2_service(f"{package}/srv/GetSpawnables")
    key = f"7/gz_server/get_spawnables/{type_.dds}/{type_.hash}"
    attachment = struct.pack("<qqB", 1, 5, 16) + bytes(16)
    request = encode_cdr(from_dict(type_.request, {}))
    (reply,) = session.get(key, payload=request, attachment=attachment, timeout=20.0)
    response = decode_cdr(reply.ok.payload.to_bytes(), type_.response)
    assert any(each.spawn_bounds is not None for each in response.spawnables)


def test_an_action_is_followed_to_its_end(bridged: Ros2Bridged, session: Any) -> None:
    """A goal is accepted at once, and the answer with its result waits until it is there."""
    kind = "control_msgs_ros2/action/GripperCommand"
    simulation = bridged.simulation

    def end(goal: Goal) -> None:
        goal.succeed(from_dict(f"{kind}_Result", {"position": goal.goal.command.position}))

    def offer() -> Action:
        return Action(
            bridged.graph,
            "/hand/grip",
            kind,
            node="hand",
            time_ns=lambda: simulation.time_ns,
            on_goal=lambda goal: goal.accept(),
            on_cancel=lambda goal: goal.cancel(from_dict(f"{kind}_Result", {})),
        )

    action = simulation.call(offer).result()

    def ask(name: str, part: str, **fields: Any) -> Any:
        type_ = ros2_service(f"{kind}_{part}")
        key = f"7/hand/grip/_action/{name}/{type_.dds}/{type_.hash}"
        payload = encode_cdr(from_dict(type_.request, fields))
        attachment = struct.pack("<qqB", 1, 5, 16) + b"who asks for it."
        (reply,) = wait_for(
            lambda: list(session.get(key, payload=payload, attachment=attachment, timeout=20.0)),
            f"an answer of {name}",
        )
        return decode_cdr(reply.ok.payload.to_bytes(), type_.response)

    identity = {"uuid": list(range(16))}
    goal = {"command": {"position": 0.25, "max_effort": 1.0}}
    assert ask("send_goal", "SendGoal", goal_id=identity, goal=goal).accepted
    answers: list[Any] = []
    waits = threading.Thread(
        target=lambda: answers.append(ask("get_result", "GetResult", goal_id=identity))
    )
    waits.start()
    (listener,) = action.listeners
    wait_for(lambda: listener._waiting, "the request for the result")
    simulation.post(lambda: end(action.goals[0]))
    waits.join()
    assert (answers[0].status, answers[0].result.position) == (4, 0.25)
    simulation.call(action.close).result()


def test_who_comes_late_gets_what_stays(session: Any) -> None:
    found: list[Any] = []
    key = (
        "7/tf_static/tf2_msgs::msg::dds_::TFMessage_/"
        "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
    )
    subscriber = zenoh.ext.declare_advanced_subscriber(
        session,
        key,
        lambda sample: found.append(
            decode_cdr(sample.payload.to_bytes(), "tf2_msgs/msg/TFMessage")
        ),
        history=zenoh.ext.HistoryConfig(detect_late_publishers=True),
    )
    wait_for(lambda: found, "the static transforms")
    assert "base_link" in {one.child_frame_id for one in found[-1].transforms}
    subscriber.undeclare()


def test_nothing_of_it_runs_on_after_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """A thread that wants to call us while the interpreter goes down aborts the process."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "8")
    monkeypatch.setattr(zenoh_session, "PORT", free_port())
    monkeypatch.setattr(ours, "_ENDING", 9.0)
    made = Ros2Bridged(prepare=prepared, rmw="zenoh")
    try:
        callers = list(made.bridge.middleware._callers)
    finally:
        made.close()
    assert callers
    assert not any(thread.is_alive() for thread in callers)
