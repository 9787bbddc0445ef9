"""The commands for a running simulation, on the shipped cart."""

import math
import os
import pty
import re
import select
import signal
import subprocess
import termios
import time

import pytest
import yaml

from cartwheel.codes.command import OPTION_INVALID, USAGE
from cartwheel.codes.devices import PLUGIN_UNKNOWN
from cartwheel.codes.graph import (
    FIELD_UNKNOWN,
    FIELD_VALUE_INVALID,
    GRAPH_NAME_INVALID,
    MESSAGE_TEXT_INVALID,
    MESSAGE_TYPE_UNKNOWN,
    SERVICE_UNKNOWN,
    TOPIC_TYPE_MISMATCH,
    TOPIC_UNKNOWN,
)
from cartwheel.codes.wires import MESSAGE_UNREAD
from cartwheel.codes.world import UNKNOWN_MODEL

from .conftest import CART_TOPIC, PROGRAM


def position(cart):
    text = cart("topic", "echo", "/odom", "-n", "1", "--field", "pose.pose.position").stdout
    return yaml.safe_load(text.removesuffix("---\n"))


def models(cart):
    return {line.split()[0] for line in cart("models").stdout.splitlines()[1:]}


def test_topic_list_and_info(cart):
    names = cart("topic", "list").stdout.splitlines()
    assert {"/clock", "/odom", "/imu/data", CART_TOPIC} <= set(names)
    long = cart("topic", "list", "-v").stdout
    assert re.search(r"/odom +nav_msgs/msg/Odometry +100 Hz", long)
    info = cart("topic", "info", CART_TOPIC).stdout
    assert info.startswith("Type: geometry_msgs/msg/Twist\n")
    assert "Publishers: None" in info
    done = cart("topic", "info", "/odm", status=2)
    assert f"[{TOPIC_UNKNOWN}]" in done.stderr


def test_echo(cart):
    text = cart("topic", "echo", "odom", "-n", "2").stdout
    assert text.count("---\n") == 2
    assert text.startswith("header: \n  stamp: \n    sec: ")
    first = yaml.safe_load(text.split("---\n")[0])
    assert first["child_frame_id"] == "base_link"
    assert "<array of float64, 36 long>" in cart("topic", "echo", "/odom", "-n1", "--no-arr").stdout
    name = cart("topic", "echo", "/tf", "-n1", "--field", "transforms[0].child_frame_id").stdout
    assert name == '"base_footprint"\n---\n'
    done = cart("topic", "echo", "/odom", "-n1", "--field", "pose.psoe", status=2)
    assert f"[{FIELD_UNKNOWN}]" in done.stderr
    done = cart("topic", "echo", "/tf", "-n1", "--field", "transforms[9]", status=2)
    assert f"[{FIELD_UNKNOWN}]" in done.stderr


def test_echo_ends_with_ctrl_c_and_with_its_reader(cart, ends):
    process = cart.start("topic", "echo", "/clock")
    assert process.stdout.readline() == "clock: \n"
    assert ends(process, signal.SIGINT) < 100
    assert process.returncode == 0
    assert process.stderr.read() == ""
    done = subprocess.run(
        f"{PROGRAM} topic echo /clock | head -2",
        shell=True,
        capture_output=True,
        text=True,
        env=cart.environment,
        timeout=120,
        check=False,
    )
    assert done.stdout.startswith("clock: \n")
    assert done.stderr == ""


def test_hz_is_that_of_the_publisher(cart):
    lines = cart("topic", "hz", "/odom", "-n", "2").stdout.splitlines()
    assert float(lines[-2].split()[2]) == pytest.approx(100, abs=0.5)
    assert "window: " in lines[-1]


def test_images_arrive(cart):
    text = cart("topic", "echo", "/rosbots/camera1/image_raw", "-n", "1").stdout
    assert "width: 320\n" in text
    assert re.search(r"data: \[\d+, .*, \.\.\.\]\n", text)


@pytest.mark.parametrize(
    "message",
    [
        ["geometry_msgs/Twist", "{linear: {x: 0.3}}"],
        ["geometry_msgs/msg/Twist", "[0.3, 0, 0]", "[0, 0, 0]"],
    ],
)
def test_pub_drives(cart, message):
    before = position(cart)["x"]
    done = cart("topic", "pub", CART_TOPIC, *message)
    assert "1 subscriber" in done.stderr
    deadline = time.monotonic() + 120
    while position(cart)["x"] < before + 0.05:
        assert time.monotonic() < deadline
    cart("topic", "pub", "-1", CART_TOPIC, "geometry_msgs/Twist")
    cart("reset")


def test_pub_at_a_rate(cart):
    start = time.monotonic()
    command = ("topic", "pub", CART_TOPIC, "geometry_msgs/Twist", "{}", "-r", "50", "-n", "30")
    done = cart(*command)
    assert 29 / 50 < time.monotonic() - start < 120
    assert "at 50 Hz" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ((CART_TOPIC, "geometry_msgs/Twits", "{}"), MESSAGE_TYPE_UNKNOWN),
        ((CART_TOPIC, "geometry_msgs/Twist", "{linar: {}}"), FIELD_UNKNOWN),
        ((CART_TOPIC, "geometry_msgs/Twist", "{linear: {x: a}}"), FIELD_VALUE_INVALID),
        ((CART_TOPIC, "geometry_msgs/Twist", "{linear: [}"), MESSAGE_TEXT_INVALID),
        ((CART_TOPIC, "std_msgs/Empty", "{}"), TOPIC_TYPE_MISMATCH),
        (("/1x", "std_msgs/Empty", "{}"), GRAPH_NAME_INVALID),
        ((CART_TOPIC, "geometry_msgs/Twist", "{}", "-r", "0"), OPTION_INVALID),
    ],
)
def test_wrong_messages(cart, arguments, code):
    assert f"[{code}]" in cart("topic", "pub", *arguments, status=2).stderr


def test_pub_to_nobody_is_said(cart):
    done = cart("topic", "pub", "/cmd_vel", "geometry_msgs/Twist", "{}")
    assert f"[{MESSAGE_UNREAD}]" in done.stderr


def test_services(cart):
    listed = cart("service", "list").stdout.split()
    assert {"/imu/service", "/rosbots/camera1/set_camera_info"} <= set(listed)
    assert listed == sorted(listed)
    assert "std_srvs/srv/Empty" in cart("service", "list", "-v").stdout
    assert cart("service", "call", "/imu/service").stdout == ""
    assert f"[{SERVICE_UNKNOWN}]" in cart("service", "call", "/imu/servce", status=2).stderr
    done = cart("service", "call", "/imu/service", "{x: 1}", status=2)
    assert f"[{FIELD_UNKNOWN}]" in done.stderr


def test_what_is_reported_a_spawned_file_has_its_place(cart, tmp_path):
    file = tmp_path / "reported.urdf"
    file.write_text("""<robot name="reported"><link name="a"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<gazebo><plugin name="p" filename="libnone.so"/></gazebo></robot>""")
    done = cart("spawn", str(file), "-x", "-7")
    assert f"{file}:3: warning: " in done.stderr and f"[{PLUGIN_UNKNOWN}]" in done.stderr
    assert done.stderr.count("warning:") == 1
    cart("delete", "reported")


def test_spawn_and_delete(cart):
    done = cart("spawn", "box_small", "-x", "5", "-y", "-2", "-z", "1", "--model", "my_box")
    assert done.stdout == "my_box\n"
    row = next(line for line in cart("models").stdout.splitlines() if line.startswith("my_box"))
    assert row.split()[1:3] == ["5.000", "-2.000"]
    cart("spawn", "barrel", "-x", "7")
    assert {"my_box", "barrel", "rosbots"} <= models(cart)
    cart("delete", "my_box")
    cart("delete", "barrel")
    assert not {"my_box", "barrel"} & models(cart)
    assert f"[{UNKNOWN_MODEL}]" in cart("delete", "my_box", status=2).stderr
    assert f"[{USAGE}]" in cart("spawn", status=2).stderr


def test_time(cart):
    held = cart("pause").stdout
    assert held.startswith("paused at ")
    assert cart("pause").stdout == held
    seconds = float(held.split()[2])
    assert cart("step").stdout == f"paused at {seconds + 0.005:.3f} s\n"
    assert cart("step", "20").stdout == f"paused at {seconds + 0.105:.3f} s\n"
    assert "state       paused" in cart("status").stdout
    assert cart("resume").stdout.startswith("running at ")
    cart("speed", "2.5")
    assert "speed       2.5" in cart("status").stdout
    cart("speed", "1")
    assert cart("reset").stdout == "running at 0.000 s\n"
    for wrong in (["speed", "0"], ["speed", "fast"], ["step", "0"]):
        cart(*wrong, status=2)


def test_teleop_over_a_pipe(cart):
    done = cart("teleop", stdin="qqi l k")
    assert "linear 0.61 m/s" in done.stderr
    assert CART_TOPIC in done.stderr
    process = cart.start("teleop", "--speed", "0.4", stdin=subprocess.PIPE)
    process.stdin.write("i")
    process.stdin.flush()
    deadline = time.monotonic() + 120
    while position(cart)["x"] < 0.05:
        assert time.monotonic() < deadline
    process.stdin.close()
    assert process.wait(120) == 0
    # It stops what it has set in motion.
    deadline = time.monotonic() + 120
    while speed(cart) > 0.01:
        assert time.monotonic() < deadline
    cart("reset")


def test_a_killed_teleop_stops_what_it_has_set_in_motion(cart):
    process = cart.start("teleop", "--speed", "0.4", stdin=subprocess.PIPE)
    process.stdin.write("i")
    process.stdin.flush()
    deadline = time.monotonic() + 120
    while speed(cart) < 0.1:
        assert time.monotonic() < deadline
    process.kill()
    deadline = time.monotonic() + 120
    while speed(cart) > 0.01:
        assert time.monotonic() < deadline
    process.communicate()
    cart("reset")


def test_a_suspended_teleop_stops_the_robot_and_goes_on_when_it_is_resumed(cart):
    process = cart.start("teleop", "--speed", "0.4", stdin=subprocess.PIPE)

    def drive():
        process.stdin.write("i")
        process.stdin.flush()
        deadline = time.monotonic() + 120
        while speed(cart) < 0.1:
            assert time.monotonic() < deadline

    drive()
    process.send_signal(signal.SIGTSTP)
    deadline = time.monotonic() + 120
    while speed(cart) > 0.01:
        assert time.monotonic() < deadline
    process.send_signal(signal.SIGCONT)
    drive()
    process.stdin.close()
    assert process.wait(120) == 0
    cart("reset")


def test_teleop_stamps_its_commands_where_they_are_read_so(program):
    (program.folder / "bridge.yaml").write_text(
        f"- {{topic_name: {CART_TOPIC}, ros_type_name: geometry_msgs/msg/TwistStamped}}"
    )
    running = program.start("run", "--headless", "--bridge", "bridge.yaml")
    program.wait_until_up(running)
    try:
        process = program.start("teleop", stdin=subprocess.PIPE)
        process.stdin.write("i")
        process.stdin.flush()
        deadline = time.monotonic() + 120
        while position(program)["x"] < 0.05:
            assert time.monotonic() < deadline
        process.stdin.close()
        assert process.wait(120) == 0
    finally:
        running.send_signal(signal.SIGINT)
    assert running.wait(120) == 0


def speed(cart):
    text = cart("topic", "echo", "/odom", "-n", "1", "--field", "twist.twist.linear.x").stdout
    return abs(float(text.split()[0]))


@pytest.mark.parametrize("end", [b"\x03", None])
def test_teleop_at_a_terminal_leaves_it_as_it_was(cart, end):
    leader, follower = pty.openpty()
    before = termios.tcgetattr(follower)
    process = cart.start(
        "teleop", stdin=follower, stdout=follower, stderr=follower, preexec_fn=take_terminal
    )
    read_until(leader, b"Ctrl-C quits")
    os.write(leader, b"i")
    read_until(leader, b"linear 0.50")
    assert termios.tcgetattr(follower)[3] != before[3]
    if end is None:
        process.send_signal(signal.SIGTERM)
    else:
        os.write(leader, end)
    assert process.wait(120) == 0
    assert termios.tcgetattr(follower) == before
    os.close(leader)
    os.close(follower)


def test_ctrl_z_at_a_terminal_stops_the_robot_and_fg_drives_on(cart):
    leader, follower = pty.openpty()
    shell = subprocess.Popen(
        ["setsid", "--ctty", "bash", "--noprofile", "--norc", "--noediting", "-i"],
        stdin=follower,
        stdout=follower,
        stderr=follower,
        env=cart.environment,
        cwd=cart.folder,
    )

    def type_in(text):
        os.write(leader, text.encode())

    def has_echo():
        return bool(termios.tcgetattr(follower)[3] & termios.ECHO)

    def wait_for(condition):
        deadline = time.monotonic() + 120
        while not condition():
            assert time.monotonic() < deadline
            time.sleep(0.01)

    try:
        type_in(f"{PROGRAM} teleop --speed 0.4\n")
        read_until(leader, b"Ctrl-C quits")
        type_in("i")
        wait_for(lambda: speed(cart) > 0.1)
        assert not has_echo()
        type_in("\x1a")
        wait_for(lambda: speed(cart) < 0.01)
        read_until(leader, b"Stopped")
        assert has_echo()
        type_in("fg\n")
        wait_for(lambda: not has_echo())
        type_in("i")
        wait_for(lambda: speed(cart) > 0.1)
        type_in("\x03")
        wait_for(has_echo)
        wait_for(lambda: speed(cart) < 0.01)
        type_in("echo status=$?\n")
        read_until(leader, b"status=0")
    finally:
        shell.kill()
        shell.wait()
        os.close(leader)
        os.close(follower)
    cart("reset")


def take_terminal():
    os.setsid()
    import fcntl

    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


def read_until(descriptor, text):
    data = b""
    deadline = time.monotonic() + 120
    while text not in data:
        assert time.monotonic() < deadline, data
        if select.select([descriptor], [], [], 1)[0]:
            data += os.read(descriptor, 10_000)


def test_nothing_was_lost_by_all_this(cart):
    assert math.isfinite(position(cart)["x"])
    assert "rosbots" in models(cart)
