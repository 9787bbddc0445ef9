"""Running a simulation from its start to its end."""

import os
import pty
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.api.test_placing import package
from tests.coded import raises

from cartwheel import options
from cartwheel.assembly import ports
from cartwheel.assembly.ports import refuse_taken
from cartwheel.codes.command import (
    OPTION_INVALID,
    OPTIONS_CONFLICT,
    OTHER_SIMULATION_RUNNING,
    PORT_TAKEN,
    SIMULATION_AMBIGUOUS,
    USAGE,
)
from cartwheel.control import Running

AT_ONCE = 100.0
"""s that ending may take on a busy machine; what would go on goes on for longer."""


def test_a_bounded_run_says_how_it_went(program):
    done = program("run", "--headless", "--for", "1.5", "--speed", "max")
    assert "robot   rosbots, 50.4 kg" in done.stdout
    assert "/odom" in done.stdout
    assert "simulated 1.500 s in " in done.stdout
    assert "\033" not in done.stdout + done.stderr


def test_the_package_is_the_command():
    done = subprocess.run(
        [sys.executable, "-m", "cartwheel", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("cartwheel ")


def test_real_time_is_kept(program):
    done = program("run", "--headless", "--for", "1")
    wall = float(done.stdout.split(" s in ")[1].split(" s")[0])
    assert 0.9 < wall < AT_ONCE


def test_any_file_from_any_folder(program):
    (program.folder / "box.urdf").write_text(BOX)
    done = program("run", "box.urdf", "--headless", "--for", "0.1", "--speed", "max", "-x", "-1.5")
    assert "robot   box, 2 kg, 1 link, 0 joints" in done.stdout
    assert "world   empty with ground_plane" in done.stdout
    done = program("run", "--headless", "--for", "0.1", "box.urdf", "--world", "walls")
    assert "world   " in done.stdout


def test_topics_have_the_names_of_a_bridge(program):
    (program.folder / "bridge.yaml").write_text(
        "- {ros_topic_name: /a, gz_topic_name: /b, ros_type_name: sensor_msgs/msg/Range}"
    )
    run = ("run", "--headless", "--for", "0.1", "--speed", "max", "--bridge", "bridge.yaml")
    done = program(*run)
    assert "bridge.yaml:1: warning: " in done.stderr and "[CW479 " in done.stderr
    done = program(*run, "--strict", status=2)
    assert "[CW479 " in done.stderr


def test_a_world_is_the_world(program):
    done = program("run", "walls", "--headless", "--for", "0.1", "--speed", "max")
    assert "robot" not in done.stdout
    done = program("run", "walls", "--world", "empty", "--headless", status=2)
    assert f"[{OPTIONS_CONFLICT}]" in done.stderr
    done = program("run", "walls", "-x", "1", "--headless", status=2)
    assert f"[{OPTIONS_CONFLICT}]" in done.stderr


@pytest.mark.parametrize("order", [("size:=2", "box.xacro"), ("box.xacro", "size:=2")])
def test_arguments_of_a_xacro_stand_anywhere(program, order):
    (program.folder / "box.xacro").write_text(
        '<robot name="box" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:arg name="size" default="1"/>'
        '<link name="base"><inertial><mass value="$(arg size)"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    done = program("run", *order, "--headless", "--for", "0.1", "--speed", "max")
    assert "box, 2 kg" in done.stdout


def test_warnings_have_their_place_and_strict_makes_them_errors(program):
    text = BOX.replace(
        "</robot>", '<gazebo><plugin name="p" filename="libnone.so"/></gazebo></robot>'
    )
    (program.folder / "box.urdf").write_text(text)
    done = program("run", "box.urdf", "--headless", "--for", "0.1", "--speed", "max")
    assert "box.urdf:8: warning: " in done.stderr and "[CW414 " in done.stderr
    done = program("run", "box.urdf", "--headless", "--for", "0.1", "--strict", status=2)
    assert "box.urdf:8: error: " in done.stderr and "[CW414 " in done.stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("speed", ["1", "max"])
def test_an_endless_run_ends_at_once_and_well(program, ends, number, speed):
    process = program.start("run", "--headless", "--speed", speed)
    program.wait_until_up(process)
    time.sleep(0.1)
    assert ends(process, number) < AT_ONCE
    assert process.returncode == 0
    assert process.stderr.read() == ""
    assert "simulated" in process.stdout.read()
    assert list((program.folder / "cartwheel").iterdir()) == []


def test_a_run_that_is_held_ends_at_once(program, ends):
    process = program.start("run", "--headless", "--paused")
    program.wait_until_up(process)
    assert ends(process, signal.SIGINT) < AT_ONCE
    assert process.returncode == 0


def test_a_bounded_run_that_is_ended_has_failed(program, ends):
    process = program.start("run", "--headless", "--for", "1000")
    program.wait_until_up(process)
    assert ends(process, signal.SIGINT) < AT_ONCE
    assert process.returncode == 130


@pytest.mark.parametrize(
    "module", ["typer", "xml.parsers", "cartwheel.description", "mujoco", "rosbags.typesys.idl"]
)
@pytest.mark.parametrize("delay", [0, 0.02])
def test_loading_ends_at_once_without_a_word(program, ends, module, delay):
    """Interrupted at and shortly after the import of a module, which the interpreter reports."""
    program.environment["PYTHONPROFILEIMPORTTIME"] = "1"
    process = program.start("run", "--headless")
    while process.stderr.readline().rsplit("|", 1)[-1].strip() != module:
        assert process.poll() is None
    time.sleep(delay)
    assert ends(process, signal.SIGINT) < AT_ONCE
    lines = process.stderr.read().splitlines()
    assert [line for line in lines if not line.startswith("import time:")] == []
    assert process.returncode in (0, 130)


SWALLOWED = """
import signal
from cartwheel.cli import interrupts

class Swallower:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)

interrupts.install()
made = Swallower()
del made
print("went on")
"""


def test_a_signal_counts_also_where_the_interpreter_swallows_exceptions():
    done = subprocess.run(
        [sys.executable, "-c", SWALLOWED], check=False, capture_output=True, text=True
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


def test_a_second_signal_ends_it_too(program):
    process = program.start("run", "--headless", "--speed", "max")
    program.wait_until_up(process)
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGINT)
    process.wait(timeout=AT_ONCE)
    assert process.returncode == 0
    assert process.stderr.read() == ""


def test_the_viewer_is_announced(program, ends):
    process = program.start("run", "--port", "0")
    program.wait_until_up(process)
    line = ""
    while not line.startswith("viewer"):
        line = process.stdout.readline()
    url = line.split()[1]
    assert url.startswith("http://127.0.0.1:")
    assert url in program("status").stdout
    port = url.rsplit(":", 1)[1]
    done = program("run", "--port", port, status=2)
    assert f"[{PORT_TAKEN}]" in done.stderr
    assert ends(process, signal.SIGINT) < AT_ONCE
    assert process.returncode == 0
    assert process.stderr.read() == ""


def test_a_port_of_another_program_is_said(program):
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        done = program("run", "--port", port, status=2)
        assert f"[{PORT_TAKEN}]" in done.stderr
        with raises(PORT_TAKEN, port=port):
            refuse_taken("127.0.0.1", port)


@pytest.mark.wording
def test_a_free_port_is_named_and_how_to_stop_a_simulation(monkeypatch):
    monkeypatch.setattr(options, "_caller", options.Caller.COMMAND_LINE)
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with raises(PORT_TAKEN) as caught:
            refuse_taken("127.0.0.1", port)
        assert re.fullmatch(r"Use a different port: --port \d+\.", caught.value.hint)
        entry = Running(pid=17, title="cart", world="empty", path=Path(), port=port)
        monkeypatch.setattr(ports, "running", lambda: [entry])
        with raises(PORT_TAKEN, port=port, pid=17) as caught:
            refuse_taken("127.0.0.1", port)
        assert caught.value.hint.endswith("Or stop that simulation: kill 17")


def test_two_simulations_are_distinguished(program, ends):
    first = program.start("run", "--headless")
    program.wait_until_up(first)
    second = program.start("run", "--headless", "empty")
    program.wait_until_up(second)
    done = program("topic", "list", status=2)
    assert f"[{SIMULATION_AMBIGUOUS}]" in done.stderr
    assert "/odom" in program("topic", "list", "--sim", first.pid).stdout
    assert "/odom" not in program("topic", "list", "--sim", second.pid).stdout
    program.environment["CARTWHEEL_SIM"] = str(first.pid)
    assert "/odom" in program("topic", "list").stdout
    for process in (first, second):
        ends(process, signal.SIGTERM)
    assert f"[{OTHER_SIMULATION_RUNNING}]" in second.stderr.read()


def test_a_terminal_gets_colours_and_something_to_try(program):
    leader, follower = pty.openpty()
    process = program.start(
        "run", "--headless", "--for", "0.2", stdin=follower, stdout=follower, stderr=follower
    )
    process.wait(timeout=120)
    os.close(follower)
    text = os.read(leader, 100_000).decode()
    os.close(leader)
    assert "cartwheel teleop" in text
    assert "\033[2m" in text


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--wrold", "empty"], USAGE),
        (["--speed", "fast"], OPTION_INVALID),
        (["--speed", "0"], OPTION_INVALID),
        (["--for", "-1"], OPTION_INVALID),
        (["--for", "nan"], OPTION_INVALID),
        (["--seed", "x"], OPTION_INVALID),
        (["--port", "70000"], OPTION_INVALID),
        (["a.urdf", "b.urdf"], USAGE),
        (["--world", "nowhere"], "CW101"),
    ],
)
def test_wrong_options(program, arguments, code):
    assert f"[{code}" in program("run", "--headless", *arguments, status=2).stderr


def test_the_same_seed_gives_the_same_run(program):
    outputs = [
        program("run", "--headless", "--for", "1", "--speed", "max", "--seed", "7").stdout
        for _ in range(2)
    ]
    assert outputs[0].splitlines()[:-1] == outputs[1].splitlines()[:-1]


def test_commands_import_only_what_they_need(program):
    heavy = {"mujoco", "rosbags", "viser", "rich", "xacro", "trimesh", "yaml"}
    assert imported(program, heavy, "topic", "list", status=2) == set()
    assert imported(program, heavy, "version") == set()
    run = imported(program, heavy, "run", "--headless", "--for", "0.1", "--speed", "max")
    assert not run & {"viser", "rich", "trimesh"}


def imported(program, heavy, *arguments, status=0):
    program.environment["PYTHONPROFILEIMPORTTIME"] = "1"
    done = program(*arguments, status=status)
    names = {line.rsplit("|", 1)[-1].strip() for line in done.stderr.splitlines()}
    assert "cartwheel.cli.app" in names
    return names & heavy


BOX = """<robot name="box">
  <link name="base">
    <inertial><mass value="2"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <collision><geometry><box size="1 1 1"/></geometry></collision>
  </link>
</robot>
"""


@pytest.mark.parametrize(
    ("tags", "plugin"),
    [
        (
            '<ros2_control name="s" type="system"><joint name="j">'
            '<command_interface name="position"/></joint></ros2_control>',
            "gz_ros2_control-system",
        ),
        (
            '<transmission name="t"><type>transmission_interface/SimpleTransmission</type>'
            '<joint name="j"><hardwareInterface>hardware_interface/EffortJointInterface'
            '</hardwareInterface></joint><actuator name="m"/></transmission>',
            "libgazebo_ros_control.so",
        ),
        ("", ""),
    ],
    ids=["ros2_control", "transmission", "neither"],
)
def test_joints_that_wait_for_controllers_nobody_starts_are_reported(
    program, tmp_path, tags, plugin
):
    file = tmp_path / "arm.urdf"
    file.write_text(f"""<robot name="arm"><link name="world"/><link name="a"><inertial>
      <mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="j" type="revolute"><parent link="world"/><child link="a"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>{tags}</robot>""")
    out = program("run", file, "--headless", "--for", 0.1, "--speed", "max").stdout
    assert ("so no joint is driven" in out) == bool(plugin)
    assert plugin in out


def test_automatic_controllers_are_those_of_the_launch_file(program, tmp_path):
    file = package(tmp_path)
    out = program("run", file, "--headless", "--for", 0.1, "--speed", "max").stdout
    assert "\ntry     --controllers auto\n" in out
    out = program(
        *("run", file, "--headless", "--for", 0.1, "--speed", "max", "--controllers", "auto")
    ).stdout
    assert "\ncontrol states, fast\n" in out
    assert "/fast/command" in out and "slow" not in out
