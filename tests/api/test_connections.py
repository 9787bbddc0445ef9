"""Worlds with clients: what these read between two runs, what waits, and what is left."""

import contextlib
import os
import queue
import signal
import socket
import threading
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from tests.api.conftest import bridges
from tests.bridges.foxglove_client import Client, modules
from tests.bridges.ros1_peers import REASON as NO_ROS1
from tests.bridges.ros1_peers import Master, wait_for
from tests.bridges.ros2_peers import DOMAIN, REASON, Peer
from tests.coded import raises

import cartwheel as cw
from cartwheel.bridges.recording.opening import open_recording
from cartwheel.codes.command import CONTROL_LIMIT, OPTIONS_CONFLICT, SIMULATION_SILENT
from cartwheel.codes.recording import RECORDING_BROKE_OFF
from cartwheel.codes.wires import ADDRESS_UNAVAILABLE, ROS_NODE_NAME_INVALID
from cartwheel.control import ControlClient, operations, running
from cartwheel.description import load_robot
from cartwheel.errors import DescriptionError, RecordingError
from cartwheel.messages import encode_cdr, from_dict

CMD = "/part2_cmr/cmd_vel"
TWIST = "geometry_msgs/msg/Twist"
STRING = "std_msgs/msg/String"

pytestmark = pytest.mark.usefixtures("tidy")


@contextlib.contextmanager
def client_of(world: cw.World) -> Any:
    world.serve_commands()
    (entry,) = running()
    with ControlClient(entry) as client:
        yield client


def counts(path: Path) -> dict[str, int]:
    recording = open_recording(path)
    assert recording.complete
    found = dict.fromkeys((topic.name for topic in recording.topics), 0)
    for message in recording.messages():
        found[recording.topics[message.number].name] += 1
    recording.close()
    return found


def watched(patch: pytest.MonkeyPatch, owner: Any, method: str) -> list[Any]:
    """The first arguments of the calls of a method from now on."""
    found: list[Any] = []
    call = getattr(owner, method)

    def watch(first: Any, *more: Any, **named: Any) -> Any:
        result = call(first, *more, **named)
        found.append(first)
        return result

    patch.setattr(owner, method, watch)
    return found


# -- between two runs


def test_commands_of_cartwheel_read_between_two_runs() -> None:
    with cw.World("empty") as world, client_of(world) as client:
        assert client.request("status")["state"] == "waiting"
        world.spawn("rosbots.xacro")
        names = {topic["name"] for topic in client.request("topics")["topics"]}
        assert CMD in names
        assert [one["name"] for one in client.request("models")["models"]] == list(world.models)
        world.run(0.5)
        status = client.request("status")
        assert (status["time"], status["state"]) == (0.5, "waiting")


def test_commands_wait_for_the_next_run(on_thread: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    with cw.World("empty") as world, client_of(world) as client:
        world.spawn("rosbots.xacro")
        world.run(0.5)
        answers: queue.Queue[Any] = queue.Queue()
        called = watched(monkeypatch, world.session.simulation, "call")
        on_thread(lambda: answers.put(client.request("delete", model="rosbots")))
        wait_for(lambda: called, "the command")
        assert "rosbots" in world.models
        assert answers.empty()
        world.run(0.1)
        assert answers.get(timeout=60) == {}
        assert "rosbots" not in world.models


def test_a_command_between_two_runs_fails_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(operations, "PATIENCE", 0.2)
    with cw.World("empty") as world, client_of(world) as client:
        world.spawn("rosbots.xacro")
        with raises(SIMULATION_SILENT) as caught:
            client.request("delete", model="rosbots")
        assert caught.value.hint
        world.run(0.1)
        # The caller was informed that it failed, so it must not happen later.
        assert "rosbots" in world.models


def test_messages_that_wait_are_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(operations, "_MOST_WAITING", 3)
    with cw.World("empty") as world, client_of(world) as client:
        world.spawn("rosbots.xacro")
        arrived: list[Any] = []
        world.subscribe(CMD, arrived.append)
        message = {"linear": {"x": 0.5}}
        for _ in range(2):
            for _ in range(3):
                client.request("publish", topic=CMD, type=TWIST, message=message)
            with raises(CONTROL_LIMIT, most=3):
                client.request("publish", topic=CMD, type=TWIST, message=message)
            world.run(0.1)
        assert len(arrived) == 6


@pytest.mark.wording
def test_clients_are_asked_to_call_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(operations, "PATIENCE", 0.2)
    monkeypatch.setattr(operations, "_MOST_WAITING", 1)
    with cw.World("empty") as world, client_of(world) as client:
        with raises(SIMULATION_SILENT) as caught:
            client.request("delete", model="rosbots")
        assert "World.run" in (caught.value.hint or "")
        world.spawn("rosbots.xacro")
        client.request("publish", topic=CMD, type=TWIST, message={})
        with raises(CONTROL_LIMIT) as caught:
            client.request("publish", topic=CMD, type=TWIST, message={})
        assert "World.run" in (caught.value.hint or "")


def test_a_client_can_pause_a_run(on_thread: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    with cw.World("empty") as world, client_of(world) as client:
        states: queue.Queue[str] = queue.Queue()
        called = watched(monkeypatch, world.session.simulation, "call")
        paused = on_thread(lambda: states.put(client.request("pause")["state"]))
        wait_for(lambda: called, "the command")
        run = on_thread(lambda: world.run(1.0))
        assert states.get(timeout=60) == "paused"
        paused.join(60)
        assert client.request("status")["time"] == 0.0
        assert run.is_alive()
        client.request("resume")
        run.join(60)
        assert world.time == 1.0


def test_a_reset_by_a_client_starts_the_run_again() -> None:
    with cw.World("empty") as world, client_of(world):
        done: queue.Queue[Any] = queue.Queue()

        def reset(message: Any) -> None:
            if message.clock.sec == 1 and not message.clock.nanosec and done.empty():
                done.put(True)
                world.session.simulation.post(world.session.simulation.reset)

        world.subscribe("/clock", reset)
        world.run(2.0)
        assert not done.empty()
        assert world.time == 2.0


def test_a_callback_for_a_latched_topic_is_called_by_run_only() -> None:
    with cw.World("empty") as world, client_of(world):
        latched = world.graph.advertise("/map", STRING, qos="latched")
        latched.publish(from_dict(STRING, {"data": "a"}))
        threads: list[int] = []
        world.subscribe("/map", lambda _: threads.append(threading.get_ident()))
        assert client_has_answer(world)
        assert threads == []
        world.run(0.1)
        assert threads == [threading.get_ident()]


def client_has_answer(world: cw.World) -> bool:
    """Waits until the world's thread for clients has served everything before."""
    done: Any = world.session.simulation.read(lambda: True)
    return bool(done.result(60))


# -- ROS 2


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> int:
    if REASON:
        pytest.skip(REASON)
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 4))
    return DOMAIN + 4


def test_ros2_reads_between_two_runs_and_commands_the_next(
    domain: int, on_thread: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    peer = Peer(domain)
    with contextlib.closing(peer), cw.World("empty", ros2="lab") as world:
        cart = world.spawn("rosbots.xacro")
        peer.subscribe("/robot_description", STRING, transient=True)
        (message,) = wait_for(lambda: peer.received("/robot_description"), "the description")
        assert message[0] > 1000
        world.run(1.0)
        start = cart.pose.x
        published = watched(monkeypatch, world.graph, "publish")
        peer.publish(CMD, TWIST, {"linear": {"x": 0.5}})
        wait_for(lambda: CMD in published, "the command")
        assert cart.pose.x == start
        world.run(3.0)
        assert cart.pose.x > start + 0.5
        called = watched(monkeypatch, world.graph, "call")
        answers: queue.Queue[Any] = queue.Queue()
        asking = on_thread(
            lambda: answers.put(peer.call("/get_model_list", "gazebo_msgs/srv/GetModelList", {}))
        )
        wait_for(lambda: called, "the request")
        assert answers.empty()
        while asking.is_alive():
            world.run(0.01)
        assert "rosbots" in answers.get(timeout=60).model_names
    assert not bridges()


def test_a_wire_can_be_added_and_removed(domain: int) -> None:
    with contextlib.closing(Peer(domain)) as peer, cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        world.run(0.1)
        connection = world.connect_ros2("first")
        assert connection.name == "/first"
        assert len(bridges()) == 1
        peer.subscribe("/clock", "rosgraph_msgs/msg/Clock")
        while not peer.received("/clock"):
            world.run(0.1)
        connection.close()
        wait_for(lambda: not bridges(), "the end of its process")
        world.run(0.1)
        assert world.connect_ros2("second").name == "/second"
        count = len(peer.received("/clock"))
        while len(peer.received("/clock")) == count:
            world.run(0.1)


def test_a_wrong_name_leaves_nothing(domain: int) -> None:
    with raises(ROS_NODE_NAME_INVALID):
        cw.World("empty", ros2="a b")
    assert not bridges()
    with cw.World("empty") as world:
        with raises(ROS_NODE_NAME_INVALID):
            world.connect_ros2("a b")
        assert not bridges()
        world.run(0.1)
        assert world.connect_ros2().name == "/gazebo"


# -- ROS 1


@pytest.mark.skipif(bool(NO_ROS1), reason=NO_ROS1)
def test_ros1_is_connected_with_the_world(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    master = Master(tmp_path)
    monkeypatch.setenv("ROS_MASTER_URI", master.uri)
    monkeypatch.setenv("ROS_HOSTNAME", "127.0.0.1")
    try:
        with cw.World("empty", ros1=True) as world:
            (entry,) = running()
            assert entry.ros_master.rstrip("/") == master.uri.rstrip("/")
            world.spawn("rosbots.xacro")
            wait_for(lambda: "/odom" in master.state()[0], "the topics")
            assert world.graph.service("/gazebo/get_model_state")
        wait_for(lambda: "/odom" not in master.state()[0], "the end of the topics")
        with cw.World("empty") as world:
            # The connection takes over the services.
            world.serve_gazebo()
            connection = world.connect_ros1()
            assert world.call("/gazebo/get_world_properties").success
            connection.close()
    finally:
        master.kill()


# -- Foxglove


@pytest.fixture(scope="module")
def folder() -> Path:
    found = modules()
    if isinstance(found, str):
        pytest.skip(found)
    return found


def test_foxglove_reads_between_two_runs_and_commands_the_next(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with cw.World("empty", foxglove=0) as world:
        cart = world.spawn("rosbots.xacro")
        client = Client(world.serve_foxglove(0), folder)
        with contextlib.closing(client):
            client.subscribe("/robot_description")
            text = load_robot("rosbots.xacro").text
            assert client.wait("message")["message"]["data"] == text
            data = encode_cdr(from_dict(TWIST, {"linear": {"x": 0.5}}))
            published = watched(monkeypatch, world.graph, "publish")
            client.send("publish", data, topic=CMD, type="geometry_msgs/Twist", encoding="cdr")
            wait_for(lambda: CMD in published, "the command")
            assert cart.pose.x == pytest.approx(0.0, abs=1e-3)
            client.subscribe("/odom")
            wait_for(lambda: "foxglove" in world.graph.topic("/odom").subscribers, "its reader")
            world.run(3.0)
            assert cart.pose.x > 0.5
            client.wait("message", lambda e: e["topic"] == "/odom")
    assert len(bridges()) == 0


def test_two_worlds_have_their_own_servers_and_recordings(tmp_path: Path, folder: Path) -> None:
    files = [tmp_path / "one.mcap", tmp_path / "two.mcap"]
    with (
        cw.World("empty", foxglove=0, record=files[0]) as one,
        cw.World("empty", record=files[1]) as two,
    ):
        url = two.serve_foxglove(0)
        one.spawn("rosbots.xacro")
        two.spawn("object.urdf", name="thing", x=1.0)
        with contextlib.closing(Client(url, folder)) as client:
            client.wait("advertise")
            one.run(0.5)
            two.run(1.0)
            client.subscribe("/clock")
            wait_for(lambda: "foxglove" in two.graph.topic("/clock").subscribers, "its reader")
            assert "foxglove" not in one.graph.topic("/clock").subscribers
        assert len(running()) == 2
        one.close()
        two.run(0.5)
    found = list(map(counts, files))
    assert found[0]["/clock"] == 51
    assert found[0]["/odom"] == 51
    assert found[1]["/clock"] == 151
    assert "/odom" not in found[1]


def test_ports_that_are_taken(folder: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        for options in ({"foxglove": port}, {"viewer": port}):
            with raises(ADDRESS_UNAVAILABLE):
                cw.World("empty", **options)
            assert not bridges()
        with cw.World("empty") as world:
            with raises(ADDRESS_UNAVAILABLE):
                world.show(port)
            world.run(0.1)


# -- the viewer


def test_the_web_interface() -> None:
    with cw.World("empty", viewer=0) as world:
        url = world.show()
        (entry,) = running()
        assert entry.url == url
        world.spawn("rosbots.xacro")
        with urllib.request.urlopen(url, timeout=60) as page:
            assert page.status == 200
        world.run(0.5)
        assert world.show() == url
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(url, timeout=60)


def test_a_web_interface_that_is_requested_by_a_client() -> None:
    with cw.World("empty") as world, client_of(world) as client:
        url = client.request("page")["url"]
        assert world.show() == url


# -- recordings


def test_a_recording_has_every_message_from_the_first(tmp_path: Path) -> None:
    files = [tmp_path / "drive.mcap", tmp_path / "drive"]
    with cw.World("empty", record=files, record_topics=["/odom", "/imu/data", "/clock"]) as world:
        world.run(0.5)
        cart = world.spawn("rosbots.xacro")
        cart.publish(CMD, linear_x=0.5)
        world.run(1.0)
        world.run(1.0)
    for path in files:
        assert counts(path) == {"/odom": 201, "/imu/data": 61, "/clock": 251}


def test_the_same_file_twice_and_a_file_that_exists(tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    with raises(OPTIONS_CONFLICT):
        cw.World("empty", record=[file, file])
    file.write_bytes(b"")
    with pytest.raises(RecordingError):
        cw.World("empty", record=file)
    with cw.World("empty", record=file, overwrite=True) as world:
        world.run(0.1)
    assert counts(file)["/clock"] == 11


def test_a_recorder_that_dies_ends_the_run(tmp_path: Path) -> None:
    with cw.World("empty", record=tmp_path / "a.mcap") as world:
        world.run(0.1)
        (child,) = bridges()
        os.kill(child, signal.SIGKILL)
        with raises(RECORDING_BROKE_OFF):
            world.spin(3600)
        # It was reported once. The world can still be used.
        world.run(0.1)


def test_a_block_within_the_block(tmp_path: Path) -> None:
    """A recording of a part, while everything is recorded."""
    with cw.World("empty", record=tmp_path / "all.mcap") as world:
        world.spawn("rosbots.xacro")
        world.run(0.5)
        with world.record(tmp_path / "part.mcap"):
            world.run(0.5)
    part = counts(tmp_path / "part.mcap")
    assert part["/odom"] == 50
    assert part["/robot_description"] == 1
    assert counts(tmp_path / "all.mcap")["/odom"] == 101


# -- exceptions


def test_a_world_that_cannot_be_read_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(DescriptionError):
        cw.World(tmp_path / "none.world", record=tmp_path / "a.mcap")
    assert not bridges()


def test_an_exception_in_the_block_completes_the_recording(tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    with pytest.raises(ValueError, match="mine"), cw.World("empty", record=file) as world:
        world.run(0.5)
        raise ValueError("mine")
    assert counts(file)["/clock"] == 51


def test_a_failed_recording_does_not_hide_the_exception(tmp_path: Path) -> None:
    with (
        pytest.raises(ValueError, match="mine") as caught,
        cw.World("empty", record=tmp_path / "a.mcap"),
    ):
        (child,) = bridges()
        os.kill(child, signal.SIGKILL)
        wait_for(lambda: not bridges(), "its end")
        raise ValueError("mine")
    assert len(caught.value.__notes__) == 1


@pytest.mark.wording
def test_the_recording_that_failed_is_named(tmp_path: Path) -> None:
    with (
        pytest.raises(ValueError, match="mine") as caught,
        cw.World("empty", record=tmp_path / "a.mcap"),
    ):
        (child,) = bridges()
        os.kill(child, signal.SIGKILL)
        wait_for(lambda: not bridges(), "its end")
        raise ValueError("mine")
    assert "a.mcap" in caught.value.__notes__[0]


def test_an_exception_in_a_callback_is_raised_by_run(tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    with cw.World("empty", record=file) as world:

        def fail(_: Any) -> None:
            raise ValueError("mine")

        world.subscribe("/clock", fail)
        with pytest.raises(ValueError, match="mine"):
            world.run(1.0)
        assert 0 < world.time < 1
    assert counts(file)["/clock"] >= 1


def test_a_world_that_is_deleted_ends_its_processes(tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    world = cw.World("empty", record=file)
    world.run(0.5)
    del world
    wait_for(lambda: not bridges(), "the end of the recorder")
    assert counts(file)["/clock"] == 51
