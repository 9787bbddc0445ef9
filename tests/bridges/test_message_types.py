"""Types of a workspace, used by a third-party plugin, on every wire."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from tests import launching
from tests.bridges import ros1_peers
from tests.bridges.foxglove_client import Client, modules
from tests.bridges.ros1_peers import PROGRAM, PYTHON, Master, wait_for
from tests.bridges.ros2_peers import DOMAIN, REASON, Peer
from tests.message_packages import DOCK, MY_MSGS, ROS1, ROS2, write_package
from tests.reserved import free_port

from cartwheel.codes.graph import MESSAGE_DEFINITION_INVALID
from cartwheel.messages import from_dict, to_dict
from cartwheel.messages.library.library import TypeLibrary

pytestmark = pytest.mark.timeout(300)

PACKAGE = "story_msgs"
LOADS, CALIBRATE = f"{PACKAGE}/msg/WheelLoads", f"{PACKAGE}/srv/Calibrate"
DOCK_TYPE = f"{PACKAGE}/action/Dock"
PLUGIN = f"""
from dataclasses import dataclass

from cartwheel.messages import header, message_class
from cartwheel.plugin import Plugin, tag

WHEEL = message_class("{PACKAGE}/msg/Wheel")


@dataclass(frozen=True, kw_only=True)
class ScaleParameters:
    rate: float = tag("updateRate", default=50.0, unit="Hz", doc="Publish rate.")


class Scale(Plugin[ScaleParameters]):
    \"\"\"Weighs each wheel.\"\"\"

    filenames = ("libscale.so",)
    parameters = ScaleParameters

    def configure(self) -> None:
        self.offset = 0.0
        self.loads = self.advertise("loads", "{LOADS}", rate=self.config.rate)
        self.serve("calibrate", "{CALIBRATE}", self.calibrate)
        self.dock = self.offer_action(
            "dock", "{DOCK_TYPE}", on_goal=self.begin, on_cancel=lambda goal: None
        )
        self.subscribe("expected", "{LOADS}", self.expect)
        self.part.schedule(
            self.config.rate, after=self.publish, active=lambda: self.loads.wanted
        )

    def publish(self) -> None:
        message = self.message_class("{LOADS}")
        pose = message_class("geometry_msgs/msg/Pose")
        point = message_class("geometry_msgs/msg/Point")
        turn = message_class("geometry_msgs/msg/Quaternion")
        self.loads.publish(message(
            header=header(self.part.time_ns, "base_link"),
            pose=pose(
                position=point(x=1.0, y=2.0, z=3.0), orientation=turn(x=0.0, y=0.0, z=0.0, w=1.0)
            ),
            wheels=[WHEEL(side=WHEEL.RIGHT, load=9.5 + self.offset), WHEEL(side=0, load=7.25)],
            tyres=[1.0, 2.0, 3.0, 4.0],
        ))

    def expect(self, message) -> None:
        self.offset = message.wheels[0].load

    def calibrate(self, request):
        self.offset = request.offset
        response = self.message_class("{CALIBRATE}_Response")
        return response(success=True, message=f"side {{request.wheel.side}}")

    def begin(self, goal) -> None:
        goal.accept()
        goal.feedback(self.dock.message("Feedback", distance=0.5))
        goal.succeed(self.dock.message("Result", docked=goal.goal.target.side == 1))
"""
ROBOT = """<?xml version="1.0"?>
<robot name="crate">
  <link name="base_link">
    <inertial>
      <mass value="2"/>
      <inertia ixx="0.0133" ixy="0" ixz="0" iyy="0.0133" iyz="0" izz="0.0133"/>
    </inertial>
    <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
  </link>
  <gazebo><plugin name="scale" filename="libscale.so"/></gazebo>
</robot>
"""
ROSPY = """
import json, sys, rospy, genpy.dynamic
rospy.init_node("reader", anonymous=True, disable_rostime=True)
reported = rospy.wait_for_message("/loads", rospy.AnyMsg, timeout=100)
header = reported._connection_header
# genpy generates the class from the definition, and computes the md5 sum itself.
made = genpy.dynamic.generate_dynamic(header["type"], header["message_definition"])
message = made[header["type"]]().deserialize(reported._buff)
print(json.dumps({
    "type": header["type"],
    "md5": header["md5sum"],
    "own": made[header["type"]]._md5sum,
    "frame": message.header.frame_id,
    "x": message.pose.position.x,
    "loads": [[wheel.side, wheel.load] for wheel in message.wheels],
    "tyres": list(message.tyres),
    "right": message.wheels[0].RIGHT,
}))
"""
EXPECTED = {
    "pose": {
        "position": {"x": 1.0, "y": 2.0, "z": 3.0},
        "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
    },
    "wheels": [{"side": 1, "load": 9.5}, {"side": 0, "load": 7.25}],
    "tyres": [1.0, 2.0, 3.0, 4.0],
}


def content(message: Any) -> dict[str, Any]:
    """A message without its header."""
    return {name: value for name, value in to_dict(message).items() if name != "header"}


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """A workspace with messages for ROS 2, a robot and a plugin."""
    return written(tmp_path / "ws", ROS2)


def written(folder: Path, manifest: str) -> Path:
    write_package(folder / "src" / PACKAGE, MY_MSGS, manifest=manifest)
    write_package(folder / "src" / "crate_description", {"urdf/crate.urdf": ROBOT})
    (folder / "scale.py").write_text(PLUGIN)
    return folder


class Here:
    """The workspace as this process sees it."""

    def __init__(self, workspace: Path) -> None:
        self._source = workspace / "src"

    def folders(self, package: str) -> list[Path]:
        return [self._source / package] if (self._source / package).is_dir() else []

    def may_read(self, path: Path, folder: Path) -> bool:
        return path.resolve().is_relative_to(folder.resolve())


@pytest.fixture
def known(workspace: Path) -> TypeLibrary:
    """The types of the workspace, in this process."""
    types = TypeLibrary(Here(workspace))
    for name in (LOADS, CALIBRATE, DOCK_TYPE):
        assert types.find(name)
    return types


Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start(workspace: Path, tmp_path: Path) -> Iterator[Start]:
    started: list[subprocess.Popen[str]] = []

    def run(*arguments: str, **environment: str) -> subprocess.Popen[str]:
        process = launching.Popen(
            [
                *(PROGRAM, "run", workspace / "src/crate_description/urdf/crate.urdf"),
                *("--headless", "--plugin", workspace / "scale.py", *arguments),
            ],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd="/",
            env={
                **os.environ,
                "XDG_RUNTIME_DIR": str(tmp_path),
                "ROS_DOMAIN_ID": str(DOMAIN + 5),
                **environment,
            },
        )
        started.append(process)
        return process

    yield run
    for process in started:
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=120)
        assert "Traceback" not in output, output
        assert process.returncode == 0, output


def command(tmp_path: Path, *arguments: str) -> str:
    """The output of ``cartwheel``, in a process that does not know the workspace."""

    errors: list[str] = []

    def done() -> tuple[str, ...]:
        made = launching.run(
            [PROGRAM, *arguments],
            capture_output=True,
            text=True,
            cwd="/",
            timeout=120,
            check=False,
            env={**os.environ, "XDG_RUNTIME_DIR": str(tmp_path)},
        )
        errors.append(made.stderr)
        return (made.stdout,) if made.returncode == 0 else ()

    try:
        (output,) = wait_for(done, " ".join(arguments), 30.0)
    except AssertionError as error:
        raise AssertionError(errors[-1]) from error
    return str(output)


def test_commands_read_and_write_the_types(start: Start, tmp_path: Path) -> None:
    start()
    echo = command(tmp_path, "topic", "echo", "/loads", "-n", "1")
    assert "wheels: \n  - \n    side: 1\n    load: 9.5\n" in echo
    assert f"Type: {LOADS}" in command(tmp_path, "topic", "info", "/loads")
    assert "side 1" in command(
        tmp_path, "service", "call", "/calibrate", "{wheel: {side: 1}, offset: 1.5}"
    )
    command(tmp_path, "topic", "pub", "/expected", LOADS, "{wheels: [{load: 3.0}]}")
    wait_for(
        lambda: "load: 12.5" in command(tmp_path, "topic", "echo", "/loads", "-n", "1"),
        "the command",
    )


@pytest.mark.skipif(bool(ros1_peers.REASON), reason=ros1_peers.REASON)
@pytest.mark.parametrize("manifest", [ROS1, ROS2])
def test_rospy_reads_the_type(start: Start, workspace: Path, tmp_path: Path, manifest: str) -> None:
    written(workspace, manifest)
    master = Master(tmp_path)
    try:
        start(
            "--ros1", **{key: master.environment[key] for key in ("ROS_MASTER_URI", "ROS_HOSTNAME")}
        )
        output, _ = master.python(ROSPY).communicate(timeout=120)
        reported = json.loads(output)
        assert reported.pop("md5") == reported.pop("own") == "0b24b21d6403bfab16631035cb454641"
        assert reported == {
            "type": f"{PACKAGE}/WheelLoads",
            "frame": "base_link",
            "x": 1.0,
            "loads": [[1, 9.5], [0, 7.25]],
            "tyres": [1.0, 2.0, 3.0, 4.0],
            "right": 1,
        }
        wait_for(lambda: "/dock/goal" in master.types(), "the action")
        assert master.types()["/dock/goal"] == f"{PACKAGE}/DockActionGoal"
        wait_for(lambda: "/calibrate" in master.state()[2], "the service")
        assert _call_with_rosservice(master, tmp_path, manifest) == "success: True message: side 1"
    finally:
        master.kill()


def _call_with_rosservice(master: Master, tmp_path: Path, manifest: str) -> str:
    """Calls the service with classes that ROS 1's own generators made."""
    source = write_package(tmp_path / "generated" / PACKAGE, MY_MSGS, manifest=manifest)
    made = tmp_path / "python" / PACKAGE
    includes = [f"-I{PACKAGE}:{source}/msg"]
    includes += [f"-I{name}:/usr/share/{name}/msg" for name in ("std_msgs", "geometry_msgs")]
    for generator, kind, files in (
        ("genmsg_py.py", "msg", ["Wheel", "WheelLoads"]),
        ("gensrv_py.py", "srv", ["Calibrate"]),
    ):
        (made / kind).mkdir(parents=True)
        program = [PYTHON, f"/usr/lib/genpy/{generator}"]
        for name in files:
            launching.run(
                [
                    *program,
                    *includes,
                    "-p",
                    PACKAGE,
                    "-o",
                    made / kind,
                    source / kind / f"{name}.{kind}",
                ],
                check=True,
            )
        launching.run([*program, "--initpy", "-p", PACKAGE, "-o", made / kind], check=True)
    (made / "__init__.py").touch()
    script = f"""
import sys
sys.path.insert(0, {str(made.parent)!r})
import rospy
from {PACKAGE}.srv import Calibrate, CalibrateRequest
rospy.init_node("caller", anonymous=True, disable_rostime=True)
rospy.wait_for_service("/calibrate", 100)
request = CalibrateRequest(offset=0.0)
request.wheel.side = 1
print(" ".join(str(rospy.ServiceProxy("/calibrate", Calibrate)(request)).split()).replace('"', ""))
"""
    output, _ = master.python(script).communicate(timeout=120)
    return output.strip()


@pytest.mark.skipif(bool(REASON), reason=REASON)
def test_ros2_reads_calls_and_commands(start: Start, known: TypeLibrary) -> None:
    del known
    peer = Peer(DOMAIN + 5)
    try:
        start("--ros2")
        peer.subscribe("/loads", LOADS)
        wait_for(lambda: peer.messages("/loads", LOADS), "a message")
        assert content(peer.messages("/loads", LOADS)[0]) == EXPECTED
        answer = peer.call(
            "/calibrate", CALIBRATE, {"wheel": {"side": 1}, "offset": 1.5}, hashes=True
        )
        assert to_dict(answer) == {"success": True, "message": "side 1"}
        peer.publish("/expected", LOADS, {"wheels": [{"load": 3.0}]})
        wait_for(lambda: peer.messages("/loads", LOADS)[-1].wheels[0].load == 12.5, "the command")
        goal = {"goal_id": {"uuid": list(range(16))}, "goal": {"target": {"side": 1}}}
        assert peer.call("/dock/_action/send_goal", f"{DOCK_TYPE}_SendGoal", goal).accepted
        result = peer.call("/dock/_action/get_result", f"{DOCK_TYPE}_GetResult", {
            "goal_id": goal["goal_id"],
        })  # fmt: skip
        assert (result.status, result.result.docked) == (4, True)
    finally:
        peer.close()


def test_foxglove_reads_the_type(start: Start) -> None:
    folder = modules()
    if isinstance(folder, str):
        pytest.skip(folder)
    port = free_port()
    process = start("--foxglove", "--foxglove-port", str(port))
    del process
    wait_for(lambda: _is_open(port), "Foxglove's server")
    client = Client(f"ws://127.0.0.1:{port}", folder)
    try:
        client.subscribe("/loads")
        message = client.wait("message", lambda e: e["topic"] == "/loads")["message"]
        assert {key: message[key] for key in EXPECTED} == EXPECTED
        services = client.wait(
            "services", lambda e: any(s["name"] == "/calibrate" for s in e["services"])
        )
        assert {"name": "/calibrate", "type": CALIBRATE} in services["services"]
    finally:
        client.close()


def _is_open(port: int) -> bool:
    import socket

    try:
        socket.create_connection(("127.0.0.1", port), 1).close()
    except OSError:
        return False
    return True


@pytest.mark.parametrize("name", ["a.mcap", "a.bag", "a_folder"])
def test_recordings_contain_the_definitions(
    start: Start, known: TypeLibrary, tmp_path: Path, name: str
) -> None:
    """Read by libraries that know neither the workspace nor Cartwheel."""
    del known
    file = tmp_path / name
    process = start(
        "--record", str(file), "--record-topics", "/loads", "--for", "0.5", "--speed", "max"
    )
    output, _ = process.communicate(timeout=120)
    assert process.returncode == 0, output
    if name == "a.mcap":
        from mcap.reader import make_reader
        from mcap_ros2.decoder import DecoderFactory

        with file.open("rb") as stream:
            reader = make_reader(stream, decoder_factories=[DecoderFactory()])
            found = [message for _, _, _, message in reader.iter_decoded_messages()]
        loads = [[wheel.side, wheel.load] for wheel in found[0].wheels]
    else:
        from rosbags.highlevel import AnyReader

        with AnyReader([file]) as reader:
            (connection,) = [one for one in reader.connections if one.topic == "/loads"]
            found = [
                reader.deserialize(data, connection.msgtype)
                for _, _, data in reader.messages([connection])
            ]
        loads = [[wheel.side, wheel.load] for wheel in found[0].wheels]
    assert loads == [[1, 9.5], [0, 7.25]]
    assert len(found) > 10


def test_a_malformed_file_is_reported_with_its_line(workspace: Path, tmp_path: Path) -> None:
    file = workspace / "src" / PACKAGE / "msg" / "Wheel.msg"
    file.write_text("uint8 side\nfloat65 load\n")
    done = launching.run(
        [
            *(PROGRAM, "run", workspace / "src/crate_description/urdf/crate.urdf"),
            *("--headless", "--plugin", workspace / "scale.py", "--for", "0.1"),
        ],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "XDG_RUNTIME_DIR": str(tmp_path)},
    )
    assert done.returncode == 2
    assert MESSAGE_DEFINITION_INVALID.number in done.stderr
    assert f"{file}:2" in re.sub(r"\s+", " ", done.stderr)


def test_the_dock_action_has_three_parts(known: TypeLibrary) -> None:
    del known
    assert DOCK.count("---") == 2
    assert from_dict(f"{DOCK_TYPE}_Goal", {"target": {"side": 1}}).target.side == 1


def test_a_played_recording_is_read_without_the_workspace(
    start: Start, workspace: Path, tmp_path: Path
) -> None:
    file = tmp_path / "a.mcap"
    process = start("--record", str(file), "--for", "0.5", "--speed", "max")
    output, _ = process.communicate(timeout=120)
    assert process.returncode == 0, output
    shutil.rmtree(workspace)
    player = launching.Popen(
        [PROGRAM, "play", file, "--headless", "--loop"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "XDG_RUNTIME_DIR": str(tmp_path)},
    )
    try:
        echo = command(tmp_path, "topic", "echo", "/loads", "-n", "1")
        assert "wheels: \n  - \n    side: 1\n    load: 9.5\n" in echo
    finally:
        player.send_signal(signal.SIGINT)
        output, _ = player.communicate(timeout=120)
    assert "Traceback" not in output, output
