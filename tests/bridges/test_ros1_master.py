"""Masters that come, go and come again; names that others take; ends."""

import contextlib
import os
import re
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.bridges.conftest import Bridge
from tests.bridges.ros1_peers import (
    PATIENCE,
    REASON,
    Master,
    Subscriber,
    registered,
    simulation,
    wait_for,
)
from tests.coded import coded, raises
from tests.reserved import free_port

from cartwheel.bridges.ros1 import Ros1Bridge
from cartwheel.codes.wires import (
    ROS_MASTER_BACK,
    ROS_MASTER_LOST,
    ROS_MASTER_UNAVAILABLE,
    ROS_NODE_ENDED,
    ROS_URI_INVALID,
)
from cartwheel.errors import CartwheelError
from cartwheel.graph import Graph

pytestmark = [
    pytest.mark.timeout(300),
    pytest.mark.skipif(bool(REASON), reason=REASON),
]


@pytest.fixture
def master(tmp_path: Path) -> Iterator[Master]:
    """One of the test's own, which it may kill."""
    made = Master(tmp_path)
    yield made
    made.kill()


def test_a_master_that_is_restarted_learns_everything_anew(bridge: Bridge, master: Master) -> None:
    run = bridge("_colour:=red")
    wait_for(lambda: "/imu/service" in master.state()[2], "the registration")
    run.graph.parameters.set("/part2_cmr/gain", 2.5)
    wait_for(lambda: master.api.getParam("/test", "/part2_cmr/gain")[2] == 2.5, "the parameter")
    before = master.state()
    old = Subscriber(master, "/odom")
    old.read()
    time_ns = run.simulation.time_ns
    master.kill()
    wait_for(lambda: run.reported(ROS_MASTER_LOST) == 1, "the report")
    old.read()
    assert run.simulation.time_ns > time_ns
    master.start()
    wait_for(lambda: run.reported(ROS_MASTER_BACK), "the second report")
    wait_for(lambda: master.state() == before, "everything")
    assert master.api.getParam("/test", "/use_sim_time")[2] is True
    assert master.api.getParam("/test", "/part2_cmr/gain")[2] == 2.5
    assert master.api.getParam("/test", "/gazebo/colour")[2] == "red"
    new = Subscriber(master, "/odom")
    new.read()
    old.read()
    assert run.reported(ROS_MASTER_LOST) == 1
    talker = master.python(TALK)
    try:
        heard: list[float] = []
        run.graph.subscribe("/part2_cmr/cmd_vel", lambda twist: heard.append(twist.linear.x))
        wait_for(lambda: 0.25 in heard, "a peer of the new master")
    finally:
        talker.kill()
        talker.communicate()
    new.close()
    old.close()


TALK = """
import rospy, time
from geometry_msgs.msg import Twist
rospy.init_node("talker", disable_rostime=True)
publisher = rospy.Publisher("/part2_cmr/cmd_vel", Twist, queue_size=1, latch=True)
command = Twist()
command.linear.x = 0.25
publisher.publish(command)
rospy.spin()
"""


def test_a_restart_between_two_looks_is_noticed_too(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    master.kill()
    master.start()
    registered(master)
    assert master.state()[0]["/clock"] == ["/gazebo"]
    wait_for(lambda: run.reported(ROS_MASTER_BACK), "the report")


def test_a_master_that_is_frozen_for_a_while_holds_up_nothing(
    bridge: Bridge, master: Master
) -> None:
    run = bridge()
    reader = Subscriber(master, "/odom")
    call = run.simulation.call
    for number in (1, 2):
        wait_for(lambda: "/imu/service" in master.state()[2], "the registration")
        pid = master.api.getPid("/test")[2]
        os.kill(pid, signal.SIGSTOP)
        try:
            short = call(lambda: run.graph.advertise("/short", "std_msgs/msg/String"))
            time_ns = run.simulation.time_ns
            wait_for(lambda number=number: run.reported(ROS_MASTER_LOST, losses=number), "the loss")  # type: ignore[misc]
            call(short.result(PATIENCE).close).result(PATIENCE)
            call(lambda: run.graph.advertise("/long", "std_msgs/msg/String")).result(PATIENCE)
            for _ in range(20):
                reader.read()
            assert run.simulation.time_ns > time_ns
        finally:
            os.kill(pid, signal.SIGCONT)
        wait_for(lambda number=number: run.reported(ROS_MASTER_BACK, losses=number), "its return")  # type: ignore[misc]
        wait_for(lambda: "/long" in master.state()[0], "what came meanwhile")
        # The master carries out what was asked of it while it was frozen.
        wait_for(lambda: "/short" not in master.state()[0], "the end of what went meanwhile")
    reader.read()
    reader.close()


def test_the_users_wall_time_is_left_alone(bridge: Bridge, master: Master) -> None:
    master.api.setParam("/test", "/use_sim_time", False)
    run = bridge(robot=False)
    assert run.graph.parameters.get("/use_sim_time") is False


def test_parameters_are_the_masters(bridge: Bridge, master: Master) -> None:
    master.api.setParam("/test", "/arm/gains", {"p": 1, "i": 0.5})
    run = bridge("_rate:=50", robot=False)
    parameters = run.graph.parameters
    assert parameters.get("/arm/gains") == {"p": 1, "i": 0.5}
    assert parameters.get("/arm/gains/p") == 1
    assert parameters.get("/arm/none", 3) == 3
    assert parameters.search("gains", "/arm/left") == {"p": 1, "i": 0.5}
    parameters.set("/arm/list", [1, 2.5, "text", True])
    parameters.set("/arm/large", 1 << 40)
    assert parameters.get("/arm/list") == [1, 2.5, "text", True]
    wait_for(lambda: master.api.getParam("/test", "/arm/large")[2] == float(1 << 40), "the values")
    assert master.api.getParam("/test", "/arm/list")[2] == [1, 2.5, "text", True]
    assert master.api.getParam("/test", "/gazebo/rate")[2] == 50


def test_a_node_of_the_same_name_takes_over(bridge: Bridge, master: Master) -> None:
    run = bridge(robot=False)
    other = master.python("import rospy; rospy.init_node('gazebo'); rospy.spin()")
    try:
        wait_for(lambda: run.ended, "the end")
        assert coded(run.ended, ROS_NODE_ENDED, node="/gazebo")
    finally:
        other.kill()
        other.communicate()


def test_rosnode_kill_ends_the_run(master: Master) -> None:
    with simulation(master, "empty.world") as process:
        registered(master)
        wait_for(lambda: "/gazebo/reset_world" in master.state()[2], "the services")
        assert "killed" in master.run("rosnode", "kill", "/gazebo")
        output, _ = process.communicate(timeout=PATIENCE)
        assert process.returncode == 0
        assert f"[{ROS_NODE_ENDED}]" in output


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_and_nothing_stays_registered(master: Master, number: int) -> None:
    with simulation(master, "empty.world") as process:
        registered(master)
        wait_for(lambda: "/gazebo/reset_world" in master.state()[2], "the services")
        process.send_signal(number)
        process.communicate(timeout=PATIENCE)
        assert process.returncode == 0
        assert master.state() == ({}, {}, {})


def test_a_master_is_started_where_none_is_and_ends_with_us(tmp_path: Path) -> None:
    made = Master(tmp_path)
    made.kill()
    with simulation(made, "empty.world") as process:
        wait_for(made.answers, "a master")
        registered(made)
        child = made.api.getPid("/test")[2]
        if "/rosout_agg" in made.types():
            assert made.run("rosnode", "list") == "/gazebo\n/rosout\n"
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=PATIENCE)
        assert process.returncode == 0
    wait_for(lambda: not Path(f"/proc/{child}").exists(), "its end")


def parent(pid: int) -> int:
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return int(next(line.split()[1] for line in lines if line.startswith("PPid:")))


def left(master: Master) -> list[str]:
    """All processes of the environment of a master, by their commands."""
    mark = f"ROS_HOME={master.environment['ROS_HOME']}".encode()
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if mark in (process / "environ").read_bytes().split(b"\0"):
                found.append((process / "cmdline").read_bytes().replace(b"\0", b" ").decode())
    return found


@pytest.mark.parametrize("victim", ["the run", "the bridge", "both"])
def test_what_we_started_ends_also_where_we_are_killed(tmp_path: Path, victim: str) -> None:
    made = Master(tmp_path)
    made.kill()
    with simulation(made, "empty.world") as process:
        wait_for(made.answers, "a master")
        registered(made)
        if shutil.which("rosout") or Path("/usr/lib/rosout/rosout").exists():
            wait_for(lambda: any("rosout" in command for command in left(made)), "rosout")
        child = made.api.getPid("/test")[2]
        bridge = parent(child)
        assert bridge != process.pid
        for pid in {"the run": [process.pid], "the bridge": [bridge]}.get(
            victim, [process.pid, bridge]
        ):
            os.kill(pid, signal.SIGKILL)
        wait_for(
            lambda: not [command for command in left(made) if " run " not in command], "its end"
        )
    wait_for(lambda: not left(made), "the end of all")


def test_a_bridges_child_can_be_ended_by_a_signal(tmp_path: Path) -> None:
    """A bridge hears no SIGTERM, but what it starts does not inherit that."""
    made = Master(tmp_path)
    made.kill()
    with simulation(made, "empty.world"):
        wait_for(made.answers, "a master")
        status = Path(f"/proc/{made.api.getPid('/test')[2]}/status").read_text()
        ignored = int(re.search(r"SigIgn:\s+(\w+)", status)[1], 16)  # type: ignore[index]
        assert not ignored >> (signal.SIGTERM - 1) & 1
        assert not ignored >> (signal.SIGINT - 1) & 1


def listening(pid: int) -> set[tuple[str, int]]:
    """Addresses and ports of TCP over IPv4 on which a process listens."""
    sockets = set()
    for file in Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(OSError):
            sockets.add(str(file.readlink()))
    found = set()
    for line in Path("/proc/net/tcp").read_text().splitlines()[1:]:
        words = line.split()
        if words[3] == "0A" and f"socket:[{words[9]}]" in sockets:
            address, _, port = words[1].partition(":")
            found.add((socket.inet_ntoa(bytes.fromhex(address)[::-1]), int(port, 16)))
    return found


@pytest.mark.parametrize(
    ("hostname", "words", "address"),
    [
        ("localhost", (), "127.0.0.1"),
        ("", ("__ip:=127.0.0.1",), "127.0.0.1"),
        (socket.gethostname(), (), "0.0.0.0"),
    ],
)
def test_who_can_reach_it(
    tmp_path: Path, hostname: str, words: tuple[str, ...], address: str
) -> None:
    """rospy's rule: loopback only where our own name is; the master of our own follows it."""
    made = Master(tmp_path)
    made.kill()
    made.environment["ROS_HOSTNAME"] = hostname
    with simulation(made, "empty.world", *words) as process:
        wait_for(made.answers, "a master")
        registered(made)
        master = made.api.getPid("/test")[2]
        assert listening(master) == {(address, made.port)}
        ports = {port for where, port in listening(parent(master)) if where == address}
        assert len(ports) == 2
        assert listening(parent(master)) == {(address, port) for port in ports}
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=PATIENCE)
    received = re.search(r"open to other computers without a password: ports (.*)", output)
    if address == "127.0.0.1":
        assert received is None
    else:
        assert received is not None
        assert {int(port) for port in received[1].split(", ")} == {made.port, *ports}


def test_a_remote_master_that_does_not_answer_is_an_error(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # An address that is kept for documentation: nobody is there.
    monkeypatch.setenv("ROS_MASTER_URI", "http://192.0.2.1:11311")
    bridge = Ros1Bridge(Graph())
    began = time.monotonic()
    with raises(ROS_MASTER_UNAVAILABLE, uri="http://192.0.2.1:11311"):
        bridge.start()
    assert time.monotonic() - began < 100
    bridge.close()


def test_what_is_no_master_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "here:or there")
    with raises(ROS_URI_INVALID):
        Ros1Bridge(Graph())


def test_a_port_that_something_else_has_is_reported(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    port = free_port()
    server = subprocess.Popen(
        ["/usr/bin/python3", "-m", "http.server", str(port), "--bind", "127.0.0.1"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        cwd=tmp_path,
    )
    try:
        monkeypatch.setenv("ROS_MASTER_URI", f"http://127.0.0.1:{port}")

        def refused() -> bool:
            bridge = Ros1Bridge(Graph())
            try:
                bridge.start()
            except CartwheelError as error:
                return error.code is ROS_MASTER_UNAVAILABLE
            finally:
                bridge.close()
            return False

        def listens() -> bool:
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port)):
                return True
            return False

        wait_for(listens, "the other program")
        assert refused()
    finally:
        server.kill()
        server.wait()
