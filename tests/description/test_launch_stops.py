"""Launch files that need files that do not exist."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from tests.coded import coded

from cartwheel.checks import check
from cartwheel.codes.files import LAUNCH_STOPS
from cartwheel.corpus import try_robot
from cartwheel.description.launches import chosen, launches_near

BOT = """<robot name="bot"><link name="base"><inertial><mass value="1"/>
<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
<collision><geometry><box size="0.3 0.3 0.1"/></geometry></collision></link></robot>"""
SPAWN = """<param name="robot_description" textfile="$(find bot)/urdf/bot.urdf"/>
<node name="s" pkg="gazebo_ros" type="spawn_model" args="-urdf -param robot_description"/>"""
START = """<include file="$(find gazebo_ros)/launch/empty_world.launch">
<arg name="world_name" value="{}"/></include>"""
PYTHON = """
import os
def generate_launch_description():
    share = get_package_share_directory("bot")
    {before}
    return LaunchDescription([
        {action}
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": Command(["xacro ", share + "/urdf/bot.urdf"])}}]),
        Node(package="gazebo_ros", executable="spawn_entity.py",
             arguments=["-topic", "robot_description"]),
    ])
"""
INCLUDE = """IncludeLaunchDescription(PythonLaunchDescriptionSource(
            os.path.join({}, "launch", "rsp.launch.py"))),"""


@pytest.fixture
def bot(tmp_path: Path) -> Path:
    """The folder of a package of ROS 1 with a robot and a world."""
    folder = tmp_path / "bot"
    for name in ("launch", "urdf", "worlds"):
        (folder / name).mkdir(parents=True)
    package = "<package><name>bot</name><buildtool_depend>{}</buildtool_depend></package>"
    (folder / "package.xml").write_text(package.format("catkin"))
    (folder / "urdf/bot.urdf").write_text(BOT)
    (folder / "worlds/room.world").write_text("<sdf version='1.6'><world name='w'/></sdf>")
    return folder


def xml(folder: Path, text: str, name: str = "a.launch") -> None:
    (folder / "launch" / name).write_text(f"<launch>\n{text}\n{SPAWN}\n</launch>")


def python(folder: Path, action: str = "", before: str = "") -> None:
    package = "<package><name>bot</name><buildtool_depend>ament_cmake</buildtool_depend></package>"
    (folder / "package.xml").write_text(package)
    text = PYTHON.format(action=action, before=before or "pass")
    (folder / "launch/a.launch.py").write_text(text)


def missing(folder: Path) -> list[str]:
    """The names of the files that `check` reports as missing."""
    found = coded(check(folder / "urdf/bot.urdf").findings, LAUNCH_STOPS)
    return [Path(str(each.values["file"])).name for each in found]


@pytest.mark.parametrize("added", [False, True])
def test_a_launch_file_may_add_folders_with_worlds_of_other_packages(bot, added):
    env = '<env name="GAZEBO_RESOURCE_PATH" value="$(find houses)/worlds"/>' if added else ""
    xml(bot, env + START.format("house.world"))
    assert missing(bot) == ([] if added else ["house.world"])


def test_blank_lines_in_a_list_of_submodules_are_read_quickly(bot):
    (bot.parent / ".git").mkdir()
    (bot.parent / ".gitmodules").write_text("\n" * 200_000 + "\tpath = bot/worlds\n")
    xml(bot, START.format("$(find bot)/worlds/rom.world"))
    started = time.process_time()
    assert missing(bot) == []
    assert time.process_time() - started < 10.0


@pytest.mark.parametrize(
    ("text", "line", "name"),
    [
        (START.format("empty_world"), 3, "empty_world"),
        (START.format("$(find bot)/worlds/rom.world"), 3, "rom.world"),
        (START.format("/home/somebody/worlds/room.world"), 3, "room.world"),
        ('<include file="$(find bot)/launch/more.launch"/>', 2, "more.launch"),
        ('<param name="box" command="xacro $(find bot)/urdf/box.urdf"/>', 2, "box.urdf"),
        ('<param name="box" textfile="$(find bot)/urdf/box.urdf"/>', 2, "box.urdf"),
        ('<rosparam command="load" file="$(find bot)/gains.yaml"/>', 2, "gains.yaml"),
        (
            '<node name="g" pkg="gazebo_ros" type="gzserver" args="$(find bot)/a.world"/>',
            2,
            "a.world",
        ),
    ],
)
def test_a_missing_file_is_a_fault_at_its_line(bot: Path, text: str, line: int, name: str) -> None:
    xml(bot, text)
    (found,) = coded(check(bot / "urdf/bot.urdf").findings, LAUNCH_STOPS)
    assert found.origin is not None
    assert found.severity == "error"
    assert (Path(found.origin.file).name, found.origin.line) == ("a.launch", line)
    assert Path(str(found.values["file"])).name == name
    verdict = try_robot(bot / "urdf/bot.urdf", standing=0.5)
    assert [(each.code, each.source) for each in verdict.faults] == [(LAUNCH_STOPS, "file")]


@pytest.mark.parametrize(
    "text",
    [
        START.format("worlds/empty.world"),
        START.format("worlds/of_another_version.world"),
        START.format("room.world"),  # perhaps in GAZEBO_RESOURCE_PATH
        START.format("$(find bot)/worlds/room.world"),
        START.format("$(find another)/worlds/room.world"),
        START.format("$(env WORLDS)/room.world"),
        START.format("/opt/worlds/room.world"),
        f'<arg name="w"/>{START.format("$(find bot)/$(arg w).world")}',
        f'<arg name="w" default=""/>{START.format("$(find bot)/worlds/$(arg w).world")}',
        '<include file="$(find another)/launch/more.launch"/>',
        '<include if="$(env REAL)" file="$(find bot)/launch/more.launch"/>',
        '<arg name="w" value="x"/><arg if="$(env R)" name="w" value="y"/>'
        + START.format("$(arg w)_world"),
        '<arg name="real" default="false"/>'
        '<include if="$(arg real)" file="$(find bot)/launch/more.launch"/>',
    ],
)
def test_what_may_be_elsewhere_or_is_not_read_is_no_fault(bot: Path, text: str) -> None:
    xml(bot, text)
    assert missing(bot) == []


def test_what_an_included_file_needs_with_its_arguments_is_a_fault(bot: Path) -> None:
    inner = '<arg name="room" default="room"/>' + START.format(
        "$(find bot)/worlds/$(arg room).world"
    )
    (bot / "launch/world.launch").write_text(f"<launch>{inner}</launch>")
    include = '<include file="$(find bot)/launch/world.launch">{}</include>'
    xml(bot, include.format(""))
    assert missing(bot) == []
    xml(bot, include.format('<arg name="room" value="hall"/>'))
    assert missing(bot) == ["hall.world"]
    xml(bot, include.format('<arg name="room" value="$(env ROOM)"/>'))
    assert missing(bot) == []


def test_a_launch_file_that_starts_is_used_instead(bot: Path) -> None:
    xml(bot, START.format("empty_world"))
    assert missing(bot) == ["empty_world"]
    xml(bot, START.format("worlds/empty.world"), "b.launch")
    assert missing(bot) == []
    use = chosen(bot / "urdf/bot.urdf", launches_near(bot))
    assert use is not None
    assert use.file.name == "b.launch"


def test_what_a_build_makes_or_git_ignores_is_no_fault(bot: Path) -> None:
    xml(bot, START.format("$(find bot)/worlds/hall.world"))
    assert missing(bot) == ["hall.world"]
    template = bot / "worlds/hall.world.in"
    template.write_text("")
    assert missing(bot) == []
    template.unlink()
    (bot / "CMakeLists.txt").write_text("add_custom_command(OUTPUT worlds/hall.world)")
    assert missing(bot) == []
    (bot / "CMakeLists.txt").unlink()
    (bot / ".gitignore").write_text("# made\nhall.*\n")
    assert missing(bot) == []


@pytest.mark.parametrize(
    ("action", "before", "names"),
    [
        (INCLUDE.format("share"), "", ["rsp.launch.py"]),
        (INCLUDE.format('get_package_share_directory("another")'), "", []),
        ("", 'open(share + "/urdf/box.urdf").read()', ["box.urdf"]),
        ("", 'open(share + "/made.urdf", "w").write("")', []),
        ("", 'xacro.process_file(share + "/urdf/box.urdf")', ["box.urdf"]),
        ("", 'Command(["xacro ", share, "/urdf/box.urdf"])', ["box.urdf"]),
        ("", 'if os.path.exists(share): open(share + "/box.urdf")', []),
        (f"GroupAction([{INCLUDE.format('share')}], condition=IfCondition(REAL)),", "", []),
        ("later,", f"later = {INCLUDE.format('share')[:-1]}", ["rsp.launch.py"]),
        (
            "GroupAction([later], condition=IfCondition(REAL)),",
            f"later = {INCLUDE.format('share')[:-1]}",
            [],
        ),
        (
            'ExecuteProcess(cmd=["gazebo", "--verbose", share + "/worlds/hall.world"]),',
            "",
            ["hall.world"],
        ),
        (
            'IncludeLaunchDescription(get_package_share_directory("gazebo_ros") '
            '+ "/launch/gazebo.launch.py"),',
            'DeclareLaunchArgument("world", default_value=share + "/worlds/hall.world")',
            ["hall.world"],
        ),
        (
            'IncludeLaunchDescription(get_package_share_directory("ros_gz_sim") '
            '+ "/launch/gz_sim.launch.py", '
            'launch_arguments={"gz_args": ["-r ", share, "/worlds/hall.sdf"]}.items()),',
            "",
            ["hall.sdf"],
        ),
    ],
)
def test_launch_files_in_python_stop_as_well(
    bot: Path, action: str, before: str, names: list[str]
) -> None:
    python(bot, action, before)
    assert missing(bot) == names


def test_a_package_may_install_a_file_elsewhere_in_ros_2(bot: Path) -> None:
    python(bot, INCLUDE.format("share"))
    assert missing(bot) == ["rsp.launch.py"]
    (bot / "more").mkdir()
    (bot / "more/rsp.launch.py").write_text("")
    assert missing(bot) == []


def test_a_function_that_nothing_calls_stops_nothing(bot: Path) -> None:
    python(bot)
    file = bot / "launch/a.launch.py"
    unused = 'def unused():\n    open(get_package_share_directory("bot") + "/box.urdf")\n'
    file.write_text(unused + file.read_text())
    assert missing(bot) == []


def test_what_depends_on_the_value_for_another_robot_is_not_certain(bot: Path) -> None:
    text = SPAWN.replace("bot.urdf", "$(arg kind).urdf")
    start = START.format("$(find bot)/worlds/$(arg kind).world")
    (bot / "worlds/small.world").write_text("<sdf version='1.6'><world name='w'/></sdf>")
    for name in ("small", "large"):
        (bot / f"urdf/{name}.urdf").write_text(BOT)
    launch = bot / "launch/a.launch"
    kind = '<arg name="kind" default="small"/>'
    launch.write_text(f"<launch>{kind}{start}{text}</launch>")
    uses = {each.description: each.stopped for each in launches_near(bot) if each.simulated}
    assert uses[bot / "urdf/small.urdf"] == uses[bot / "urdf/large.urdf"] == ()
    (bot / "worlds/small.world").unlink()
    launch.write_text(f"<launch>{kind}{start}{START.format('hall')}{text}</launch>")
    found = {each.description: each.stopped for each in launches_near(bot) if each.simulated}
    assert [len(found[bot / f"urdf/{name}.urdf"]) for name in ("small", "large")] == [2, 1]
