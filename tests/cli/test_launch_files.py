"""``cartwheel run`` with a launch file."""

import pytest

from cartwheel.codes.command import OPTIONS_CONFLICT

BOX = """<robot name="box"><link name="link"><inertial><mass value="2"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>"""
LAUNCH = """<launch><arg name="height" default="1"/>
<include file="$(find gazebo_ros)/launch/empty_world.launch">
  <arg name="world_name" value="worlds/mud.world"/></include>
<node pkg="gazebo_ros" type="spawn_model" name="s"
  args="-file $(find boxes)/box.urdf -urdf -model one -z $(arg height)"/>
<node pkg="rviz" type="rviz" name="rviz"/></launch>"""


@pytest.fixture
def package(program):
    (program.folder / "package.xml").write_text("<package><name>boxes</name></package>")
    (program.folder / "box.urdf").write_text(BOX)
    (program.folder / "sim.launch").write_text(LAUNCH)
    return program


def test_a_launch_file_is_run(package):
    done = package("run", "sim.launch", "--headless", "--for", "0.1", "--speed", "max")
    assert "launch  sim.launch; only its models and their controllers are started" in done.stdout
    assert "world   mud with " in done.stdout
    assert "robot   one, 2 kg, 1 link, 0 joints" in done.stdout


def test_options_replace_what_a_launch_file_states(package):
    words = ("--headless", "--for", "0.1", "--speed", "max")
    done = package(
        "run", "sim.launch", "height:=3", "hight:=2", *words,
        "--world", "empty", "--model", "two", "-x", "1",
    )  # fmt: skip
    assert "world   empty with " in done.stdout
    assert "robot   two, 2 kg" in done.stdout
    assert 'the argument "hight" has no effect' in done.stderr
    assert 'Did you mean "height"?' in done.stderr
    done = package("run", "sim.launch", "--world", "nowhere", *words, status=2)
    assert "nowhere" in done.stderr
    (package.folder / "box.urdf").unlink()
    done = package("run", "sim.launch", *words, status=2)
    assert "the launch file names no description that exists" in done.stderr
    assert "CW107" in done.stderr


def test_a_model_that_the_world_contains_has_no_options(package):
    (package.folder / "sim.launch").write_text("""<launch>
      <include file="empty_world.launch"><arg name="world_name" value="box.sdf"/></include>
      <param name="robot_description" textfile="$(find boxes)/box.urdf"/></launch>""")
    model = "<model name='box'><static>1</static><link name='l'/></model>"
    (package.folder / "box.sdf").write_text(
        f"<sdf version='1.6'><world name='w'>{model}</world></sdf>"
    )
    words = ("run", "sim.launch", "--headless", "--for", "0.1", "--speed", "max")
    assert "world   w with box" in package(*words).stdout
    assert f"[{OPTIONS_CONFLICT}]" in package(*words, "-x", "1", status=2).stderr


def test_a_launch_file_may_start_only_a_world(package):
    (package.folder / "sim.launch").write_text("""<launch><arg name="arena" default="mud"/>
      <include file="$(find gazebo_ros)/launch/empty_world.launch">
        <arg name="world_name" value="worlds/$(arg arena).world"/></include></launch>""")
    words = ("run", "sim.launch", "--headless", "--for", "0.1", "--speed", "max")
    done = package(*words)
    assert "launch  sim.launch; only its world is started" in done.stdout
    assert "world   mud with " in done.stdout
    done = package(*words, "-x", "1", status=2)
    assert f"[{OPTIONS_CONFLICT}]" in done.stderr
    done = package(*words, "arena:=absent", status=2)
    assert "worlds/absent.world" in done.stderr
    assert "[CW101 file-missing]" in done.stderr


def test_other_commands_say_that_it_is_a_launch_file(package):
    (package.folder / "sim.launch.py").write_text("x = 1")
    for name in ("sim.launch", "sim.launch.py"):
        done = package("check", name, status=2)
        assert "the file is a launch file" in done.stdout + done.stderr
        assert "cartwheel run" in done.stdout + done.stderr
