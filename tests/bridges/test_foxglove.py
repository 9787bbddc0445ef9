"""Foxglove's protocol, spoken with Foxglove's own client of it."""

from __future__ import annotations

import base64
import contextlib
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests import launching
from tests.bridges.foxglove_client import Client, modules, unreadable
from tests.bridges.running import Running
from tests.coded import coded, raises
from websockets.sync.client import connect

from cartwheel.assembly.assets import Assets
from cartwheel.assembly.foxglove import SimulationControls
from cartwheel.bridges.foxglove import FoxgloveBridge
from cartwheel.bridges.foxglove.forms import encoding_of, packed, schema_of
from cartwheel.codes.files import XACRO_NOT_EXPANDED
from cartwheel.codes.graph import SERVICE_FAILED
from cartwheel.codes.wires import (
    ADDRESS_UNAVAILABLE,
    MALFORMED_MESSAGE,
    MESSAGE_UNREAD,
    PACKAGE_MISSING,
    PARAMETER_REFUSED,
    SLOW_SUBSCRIBER,
)
from cartwheel.description import load_plain, load_robot, load_text, load_world
from cartwheel.errors import CartwheelError, Code, Diagnostic, Origin, one_line
from cartwheel.gazebo.robot_descriptions import RobotDescriptions
from cartwheel.graph import Graph
from cartwheel.messages import decode_cdr, encode_cdr, from_dict, service_classes, zero
from cartwheel.messages.ros1 import decode_ros1, encode_ros1
from cartwheel.messages.store import ROS2_DEFINITIONS, parsed_definitions, store
from cartwheel.session import Session
from cartwheel.simulation.snapshot import RunState

PROGRAM = Path(sys.executable).with_name("cartwheel")
CMD = "/part2_cmr/cmd_vel"
IMAGE = "/rosbots/camera1/image_raw"


class Served(Running):
    """A simulation that runs, with a server of Foxglove's protocol."""

    bridge: FoxgloveBridge

    def __init__(
        self, *, controls: type[SimulationControls] = SimulationControls, **options: Any
    ) -> None:
        super().__init__()
        self.robots = RobotDescriptions(self.simulation, self.graph)
        self.bridge = FoxgloveBridge(
            self.graph,
            name="a test",
            port=0,
            controls=controls(self.simulation),
            assets=Assets(self.session, ()),
            report=self.reports.append,
            **options,
        )

    def wanted(self) -> set[str]:
        return {p.topic for p in self.graph.publishers() if p.wanted and p.qos != "latched"}


@pytest.fixture(scope="module")
def folder() -> Path:
    found = modules()
    if isinstance(found, str):
        pytest.skip(found)
    return found


@contextlib.contextmanager
def serving(**options: Any) -> Iterator[Served]:
    made = Served(**options)
    made.start()
    try:
        yield made
    finally:
        made.close()


@pytest.fixture
def served() -> Iterator[Served]:
    with serving() as made:
        yield made


@pytest.fixture
def client(served: Served, folder: Path) -> Iterator[Client]:
    made = Client(served.bridge.url, folder)
    made.wait("serverInfo")
    yield made
    made.close()


def until(condition: Any, what: str) -> None:
    deadline = time.monotonic() + 120
    while not condition():
        assert time.monotonic() < deadline, f"in vain: {what}"
        time.sleep(0.02)


def test_every_topic_has_a_channel(served: Served, client: Client) -> None:
    names = {topic.name: topic.type for topic in served.graph.topics()}
    names["/rosout"] = "rcl_interfaces/msg/Log"
    found: dict[str, Any] = {}

    def all_there() -> bool:
        for event in client.of("advertise"):
            found.update({channel["topic"]: channel for channel in event["channels"]})
        return set(found) == set(names)

    until(all_there, "all channels")
    assert {name: channel["schemaName"] for name, channel in found.items()} == names
    assert {channel["encoding"] for channel in found.values()} == {"cdr"}
    assert {channel["schemaEncoding"] for channel in found.values()} == {"ros2msg"}


def test_every_type_is_read_by_clients(folder: Path) -> None:
    # Without the types that other tests define in this process.
    built_in = parsed_definitions() | parsed_definitions(ROS2_DEFINITIONS)
    assert len(built_in) > 200
    types = [
        kind for kind in sorted(store().fielddefs) if kind in built_in and "/action/" not in kind
    ]
    reported = []
    for kind in types:
        encoding = encoding_of(kind)
        schema = schema_of(kind, encoding)
        reported.append(
            {
                "name": kind,
                "encoding": encoding,
                "schema": schema.data.decode(),
                "data": base64.b64encode(packed(Graph(), zero(kind), encoding)).decode(),
            }
        )
    assert {one["encoding"] for one in reported} == {"cdr", "ros1"}
    # These two are lists of constants, which no topic has.
    odd = {"rcl_interfaces/msg/ParameterType", "statistics_msgs/msg/StatisticDataType"}
    assert [one for one in unreadable(reported, folder) if one.partition(":")[0] not in odd] == []


def test_messages_arrive_as_they_were_published(served: Served, client: Client) -> None:
    seen: dict[int, Any] = {}
    client.subscribe("/imu/data")
    client.wait("message", lambda e: e["topic"] == "/imu/data")
    served.graph.subscribe(
        "/imu/data", lambda m: seen.update({m.header.stamp.sec * 10**9 + m.header.stamp.nanosec: m})
    )
    until(lambda: len(seen) > 10, "messages")
    last = max(seen)
    client.wait("message", lambda e: e["time"] >= last)
    arrived = {e["time"]: e["message"] for e in client.of("message")}
    assert set(seen) & set(arrived) >= {t for t in seen if t <= last}
    for time_ns in set(seen) & set(arrived):
        got, sent = arrived[time_ns], seen[time_ns]
        assert got["header"]["stamp"]["sec"] * 10**9 + got["header"]["stamp"]["nanosec"] == time_ns
        assert got["header"]["frame_id"] == sent.header.frame_id
        for part in "xyz":
            assert got["linear_acceleration"][part] == getattr(sent.linear_acceleration, part)


def test_an_image_arrives_whole(served: Served, client: Client) -> None:
    sums: dict[int, int] = {}

    def add(message: Any) -> None:
        stamp = message.header.stamp
        sums[stamp.sec * 10**9 + stamp.nanosec] = int(message.data.sum(dtype="int64"))

    client.subscribe(IMAGE)
    client.wait("message")
    served.graph.subscribe(IMAGE, add)
    until(lambda: len(sums) > 3, "images")
    wanted = sorted(sums)[1]
    got = client.wait("message", lambda e: e["time"] == wanted)["message"]
    assert (got["width"], got["height"], got["encoding"]) == (320, 240, "rgb8")
    assert got["data"] == {"length": 320 * 240 * 3, "sum": sums[wanted]}


def test_nothing_is_computed_that_nobody_reads(served: Served, client: Client) -> None:
    assert served.wanted() == set()
    client.subscribe(IMAGE)
    client.wait("message")
    assert served.wanted() == {IMAGE}
    client.do("unsubscribe", topic=IMAGE)
    until(lambda: served.wanted() == set(), "the end of the subscription")
    client.subscribe("/odom")
    client.wait("message", lambda e: e["topic"] == "/odom")
    client.close()
    until(lambda: served.wanted() == set(), "the end of the client")


def test_the_robot_is_described_to_each_who_asks(
    served: Served, client: Client, folder: Path
) -> None:
    text = load_robot("rosbots.xacro").text
    for each in (client, Client(served.bridge.url, folder)):
        each.subscribe("/robot_description")
        assert each.wait("message")["message"]["data"] == text
        each.subscribe("/tf_static")
        each.wait("message", lambda e: e["topic"] == "/tf_static")
        each.do("get", names=["/robot_description"], id="a")
        values = each.wait("parameters", lambda e: e.get("id") == "a")["parameters"]
        assert values == [{"name": "/robot_description", "value": text}]
        each.close()


def test_a_robot_that_comes_later_and_goes(served: Served, client: Client) -> None:
    client.wait("advertise")
    model = load_text(
        '<robot name="thing"><link name="base"/><gazebo><plugin name="p" '
        'filename="libgazebo_ros_p3d.so"><bodyName>base</bodyName><topicName>late</topicName>'
        "<updateRate>50</updateRate></plugin></gazebo></robot>".replace(
            '<link name="base"/>',
            '<link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0"'
            ' ixz="0" iyz="0"/></inertial></link>',
        )
    )
    served.simulation.call(lambda: served.session.spawn(model)).result(120)
    client.subscribe("/late")
    client.wait("message", lambda e: e["topic"] == "/late")
    ids = {c["topic"]: c["id"] for e in client.of("advertise") for c in e["channels"]}
    served.simulation.call(lambda: served.simulation.delete("thing")).result(120)
    client.wait("unadvertise", lambda e: ids["/late"] in e["ids"])


@pytest.mark.parametrize("encoding", ["cdr", "json"])
def test_a_client_drives(served: Served, client: Client, encoding: str) -> None:
    client.wait("advertise")
    twist = from_dict("geometry_msgs/msg/Twist", {"linear": {"x": 0.5}})
    data = encode_cdr(twist) if encoding == "cdr" else b'{"linear": {"x": 0.5}}'
    before = served.simulation.call(lambda: served.simulation.pose("rosbots").x).result(120)
    client.send("publish", data, topic=CMD, type="geometry_msgs/Twist", encoding=encoding)

    def moved() -> bool:
        future = served.simulation.call(lambda: served.simulation.pose("rosbots").x)
        return bool(future.result(120) - before > 0.2)

    until(moved, "the cart to drive")


def test_a_client_that_knows_twist_alone_drives_what_wants_a_stamp(
    served: Served, client: Client
) -> None:
    heard: list[Any] = []
    served.graph.subscribe("/stamped", heard.append, type_name="geometry_msgs/msg/TwistStamped")
    client.wait("advertise", lambda e: any(c["topic"] == "/stamped" for c in e["channels"]))
    twist = encode_cdr(from_dict("geometry_msgs/msg/Twist", {"linear": {"x": 0.5}}))
    client.send("publish", twist, topic="/stamped", type="geometry_msgs/Twist", encoding="cdr")
    until(lambda: heard, "the command")
    assert (heard[0].__msgtype__, heard[0].twist.linear.x) == (
        "geometry_msgs/msg/TwistStamped",
        0.5,
    )


@pytest.mark.parametrize(
    ("topic", "kind", "data", "code"),
    [
        (CMD, "geometry_msgs/Twist", b"junk", MALFORMED_MESSAGE),
        (
            CMD,
            "sensor_msgs/Imu",
            encode_cdr(from_dict("sensor_msgs/msg/Imu", {})),
            MALFORMED_MESSAGE,
        ),
        (CMD, "none_msgs/None", b"\0\1\0\0", MALFORMED_MESSAGE),
        ("/nowhere", "geometry_msgs/Twist", b"\0\1\0\0", MESSAGE_UNREAD),
    ],
)
def test_what_cannot_be_taken_is_reported(
    *, served: Served, client: Client, topic: str, kind: str, data: bytes, code: Code
) -> None:
    client.wait("advertise")
    client.send("publish", data, topic=topic, type=kind, encoding="cdr")
    client.wait("status", lambda e: f"[{code.number}]" in e["status"]["message"])
    assert coded(served.reports, code, topic=topic)


def test_services(served: Served, client: Client) -> None:
    made = service_classes("std_srvs/srv/SetBool")[1]
    seen: list[bool] = []

    def answer(request: Any) -> Any:
        seen.append(request.data)
        if not request.data:
            raise CartwheelError("not now")
        return made(success=True, message="done")

    served.graph.serve("/switch", "std_srvs/srv/SetBool", answer)
    client.wait("services", lambda e: any(s["name"] == "/switch" for s in e["services"]))
    request = service_classes("std_srvs/srv/SetBool")[0]
    client.send("call", encode_cdr(request(data=True)), service="/switch", encoding="cdr")
    got = decode_cdr(base64.b64decode(client.wait("answer")["data"]), made.__msgtype__)
    assert (got.success, got.message) == (True, "done")
    client.send("call", encode_cdr(request(data=False)), service="/switch", encoding="cdr")
    assert client.wait("failure")["failure"]
    client.wait("status", lambda e: f"[{SERVICE_FAILED.number}]" in e["status"]["message"])
    padded = encode_cdr(request(data=True)) + bytes(100)
    client.send("call", padded, service="/switch", encoding="cdr")
    client.wait("answer", count=2)
    client.send("call", b"\0", service="/switch", encoding="cdr")
    client.wait("failure", count=2)
    assert seen == [True, False, True]


def test_a_service_that_only_ros_1_can_have(served: Served, client: Client) -> None:
    kind = "gazebo_msgs/srv/SetJointProperties"
    request, response = service_classes(kind)
    served.graph.serve(
        "/joint", kind, lambda r: response(success=True, status_message=r.joint_name)
    )
    client.wait("services", lambda e: any(s["name"] == "/joint" for s in e["services"]))
    asked = from_dict(request.__msgtype__, {"joint_name": "wheel"})
    client.send("call", encode_ros1(asked), service="/joint", encoding="ros1")
    answer = base64.b64decode(client.wait("answer")["data"])
    assert decode_ros1(answer, response.__msgtype__).status_message == "wheel"


def test_parameters(served: Served, client: Client) -> None:
    served.graph.parameters.set("/camera/gain", 4)
    client.do("get", names=[], id="all")
    values = client.wait("parameters", lambda e: e.get("id") == "all")["parameters"]
    found = {value["name"]: value.get("value") for value in values}
    assert found["/camera/gain"] == 4
    assert found["/cartwheel/paused"] is False
    assert found["/cartwheel/speed"] == 1
    client.do("set", parameters=[{"name": "/camera/gain", "value": [1, 2]}], id="b")
    client.wait("parameters", lambda e: e.get("id") == "b")
    assert served.graph.parameters.get("/camera/gain") == [1, 2]
    client.do("set", parameters=[{"name": "/cartwheel/paused", "value": True}], id="c")
    assert client.wait("parameters", lambda e: e.get("id") == "c")["parameters"] == [
        {"name": "/cartwheel/paused", "value": True}
    ]
    assert served.simulation.run_state is RunState.PAUSED
    client.do("set", parameters=[{"name": "/cartwheel/speed", "value": "fast"}])
    client.wait("status", lambda e: f"[{PARAMETER_REFUSED.number}]" in e["status"]["message"])
    client.do("set", parameters=[{"name": "/cartwheel/speed", "value": 1e308}])
    client.wait(
        "status", lambda e: f"[{PARAMETER_REFUSED.number}]" in e["status"]["message"], count=2
    )
    assert served.simulation.speed == 1.0


def test_what_others_do_to_time_is_published(served: Served, client: Client) -> None:
    client.wait("advertise")
    client.do("watch", names=["/cartwheel/paused", "/cartwheel/speed"])
    client.do("get", names=["/cartwheel/paused"], id="there")
    client.wait("parameters", lambda e: e.get("id") == "there")
    served.simulation.call(served.simulation.pause).result(120)

    def says(name: str, value: object) -> None:
        client.wait(
            "parameters",
            lambda e: (
                not e.get("id")
                and (name, value) in [(p["name"], p["value"]) for p in e["parameters"]]
            ),
        )

    says("/cartwheel/paused", True)
    served.simulation.call(lambda: served.simulation.set_speed(3.0)).result(120)
    says("/cartwheel/speed", 3)
    served.simulation.call(served.simulation.resume).result(120)
    says("/cartwheel/paused", False)


def test_time_is_the_simulations(served: Served, client: Client) -> None:
    client.wait("time", count=5)
    times = [event["time"] for event in client.of("time")]
    assert times == sorted(times)
    assert 0 <= times[0] < times[-1] <= served.simulation.time_ns


def test_messages_come_close_to_the_published_time(served: Served, client: Client) -> None:
    """Lichtblick plots a message at the last time that it has received."""
    client.subscribe("/odom")
    client.wait("message", count=200)
    reported, off = None, []
    for event in client.of("time", "message"):
        if event["event"] == "time":
            reported = event["time"]
        elif reported is not None:
            off.append(abs(event["time"] - reported))
    assert sorted(off)[len(off) // 2] <= 30 * 10**6


class Late(SimulationControls):
    """As in another process, where the time comes from messages."""

    @property
    def time_ns(self) -> int:
        return max(0, super().time_ns - 70 * 10**6)


def test_time_takes_no_step_back_for_a_late_message(folder: Path) -> None:
    with serving(controls=Late) as served:
        client = Client(served.bridge.url, folder)
        client.subscribe("/odom")
        client.wait("message", count=200)
        times = [event["time"] for event in client.of("time")]
        assert times == sorted(times)
        simulation = served.simulation
        simulation.call(simulation.reset).result(120)
        client.wait("time", lambda e: e["time"] < times[-1], count=3)
        client.close()


def test_playback_control(folder: Path) -> None:
    def request(command: int, speed: float, seek: int | None = None) -> bytes:
        head = struct.pack("<BBfBQ", 3, command, speed, seek is not None, seek or 0)
        return head + struct.pack("<I", 1) + b"r"

    with serving(time_range=(0, 10**12)) as served:
        client = Client(served.bridge.url, folder)
        info = client.wait("serverInfo")["info"]
        assert "playbackControl" in info["capabilities"]
        client.wait("advertise")
        simulation = served.simulation
        client.send("raw", request(1, 1.0))
        until(lambda: simulation.run_state is RunState.PAUSED, "pause")
        client.send("raw", request(0, 2.5))
        until(lambda: simulation.run_state is RunState.RUNNING, "play")
        assert simulation.speed == 2.5
        until(lambda: simulation.time_ns > 10**9, "time")
        client.send("raw", request(1, 1.0, seek=0))
        until(lambda: simulation.run_state is RunState.PAUSED, "pause")
        assert simulation.time_ns < 10**9
        with connect(served.bridge.url, subprotocols=["foxglove.sdk.v1"]) as link:
            # Another than the client lets it go on: its opcode, status, time, speed, seek, request.
            simulation.call(simulation.resume).result(120)
            for message in link:
                if isinstance(message, bytes) and message[0] == 5 and message[1] == 0:
                    break
            _, _, reported, speed, sought, length = struct.unpack("<BBQfBI", message)
            assert (reported < 10**9, speed, sought, length) == (True, 1.0, 0, 0)
        client.close()


def test_the_connection_graph(served: Served, client: Client) -> None:
    client.do("graph")

    def has_odom(event: dict[str, Any]) -> bool:
        topics = event["graph"]["publishedTopics"]
        return any(t["name"] == "/odom" and t["publisherIds"] for t in topics)

    client.wait("graph", has_odom)


def test_meshes_and_nothing_else(served: Served, client: Client) -> None:
    client.wait("advertise")
    text = load_robot("rosbots.xacro").text
    start = text.index("package://")
    mesh = text[start : text.index('"', start)]
    wanted = [mesh, "package://rosbots_description/package.xml", "file:///etc/passwd",
              "package://rosbots_description/../../../etc/passwd", "package://none/a.stl",
              "package://rosbots_description/%2e%2e/a.stl", "file:///tmp/a.png"]  # fmt: skip
    for number, uri in enumerate(wanted):
        client.do("asset", uri=uri, id=number)
    first = client.wait("asset", lambda e: e["requestId"] == 0)
    found = next(Path("robots").rglob(mesh.rpartition("/")[2]))
    assert base64.b64decode(first["data"]) == found.read_bytes()
    for number in range(1, len(wanted)):
        answer = client.wait("asset", lambda e, n=number: e["requestId"] == n)
        assert answer["status"] != 0 and not answer["data"], wanted[number]


def test_what_is_said_comes_as_rosout(served: Served, client: Client, folder: Path) -> None:
    origin = Origin(file="a.xacro", line=7)
    served.bridge.log(Diagnostic(severity="warning", message="before", origin=origin))
    client.subscribe("/rosout")
    first = client.wait("message")["message"]
    assert (first["level"], first["msg"]) == (30, "before")
    assert (first["file"], first["line"]) == ("a.xacro", 7)
    other = Client(served.bridge.url, folder)
    other.subscribe("/rosout")
    other.subscribe("/robot_description")  # What comes of it, comes after that.
    other.wait("message", lambda e: e["topic"] == "/robot_description")
    # No second channel of that name, and no line twice.
    served.graph.subscribe("/rosout", print, type_name="rcl_interfaces/msg/Log")
    served.bridge.log(Diagnostic(severity="error", message="after"))
    for each in (client, other):
        each.wait("message", lambda e: e["message"].get("msg") == "after")
        channels = [c for e in each.of("advertise") for c in e["channels"]]
        assert [c["topic"] for c in channels].count("/rosout") == 1
        each.close()
    assert [e["message"]["msg"] for e in client.of("message")] == ["before", "after"]


def test_a_frozen_client_stalls_nobody(served: Served, folder: Path) -> None:
    frozen, awake = Client(served.bridge.url, folder), Client(served.bridge.url, folder)
    for client in (frozen, awake):
        client.subscribe(IMAGE)
        client.subscribe("/clock")
        client.wait("message", lambda e: e["topic"] == IMAGE)
    frozen.do("freeze")
    frozen.wait("frozen")
    begin = served.simulation.time_ns
    count = len(awake.of("message"))
    wall = time.monotonic()
    until(lambda: served.simulation.time_ns > begin + 5 * 10**9, "five seconds")
    # Real time: the pacer gives lag up, but a stall of seconds it cannot hide.
    assert time.monotonic() - wall < 100
    awake.wait("message", lambda e: e["topic"] == "/clock" and e["time"] > begin + 4 * 10**9)
    assert len(awake.of("message")) > count + 200
    until(lambda: coded(served.reports, SLOW_SUBSCRIBER), "the report")
    frozen.close()
    awake.close()


def test_hostile_bytes_end_nothing(served: Served, client: Client) -> None:
    client.wait("advertise")
    for data in (b"", b"\x03", b"\x01\xff", b"\x02" + b"\xff" * 40, b"\xff" * 100, b"\x03" * 19):
        client.send("raw", data)
    with socket.create_connection(("127.0.0.1", served.bridge.port)) as raw:
        raw.sendall(b"GET / HTTP/1.1\r\n\r\n" + b"\0" * 1000)
    client.subscribe("/clock")
    client.wait("message")


def test_a_taken_port_is_reported() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        session = Session(load_world("empty"))
        bridge = FoxgloveBridge(
            session.graph, name="a", port=port, controls=SimulationControls(session.simulation)
        )
        with raises(ADDRESS_UNAVAILABLE, port=port):
            bridge.start()
        session.close()


def test_without_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "foxglove", None)
    session = Session(load_world("empty"))
    with raises(PACKAGE_MISSING, package="foxglove-sdk", extra="foxglove"):
        FoxgloveBridge(session.graph, name="a", controls=SimulationControls(session.simulation))
    session.close()


XACRO = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"/>
  ${(lambda: ().__class__.__base__.__subclasses__())()}</robot>"""


def publishers(event: dict[str, Any], topic: str) -> list[str]:
    topics = event["graph"]["publishedTopics"]
    return [name for one in topics if one["name"] == topic for name in one["publisherIds"]]


def test_the_command_serves(folder: Path) -> None:
    process = launching.Popen(
        [PROGRAM, "run", "--headless", "--foxglove", "--foxglove-port", "0"],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        line = next(line for line in process.stdout if line.startswith("foxglove"))
        client = Client(line.split()[1], folder)
        client.subscribe("/odom")
        client.wait("message")
        # Nobody else would offer what Gazebo and robot_state_publisher do.
        client.wait("services", lambda e: any(s["name"] == "/spawn_entity" for s in e["services"]))
        request, made = service_classes("gazebo_msgs/srv/SpawnEntity")
        asked = from_dict(request.__msgtype__, {"name": "x", "xml": XACRO})
        client.send("call", encode_cdr(asked), service="/spawn_entity", encoding="cdr")
        data = base64.b64decode(client.wait("answer")["data"])
        answer = decode_cdr(data, made.__msgtype__)
        assert not answer.success
        with raises(XACRO_NOT_EXPANDED) as refused:
            load_plain(XACRO, file="<model_xml of x>")
        assert answer.status_message == one_line(refused.value)
        client.do("graph")
        client.wait("graph", lambda e: "robot_state_publisher" in publishers(e, "/tf"))
        client.subscribe("/rosout")
        client.wait("message", lambda e: e["topic"] == "/rosout")
        client.close()
    finally:
        process.terminate()
        assert process.wait(120) == 0
