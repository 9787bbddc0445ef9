"""Command lines of gzserver and gzclient, and where worlds and models are found."""

import os
from pathlib import Path

import pytest
from tests.coded import raises

from cartwheel.cli.commands.gazebo_arguments import parse_client, parse_server
from cartwheel.cli.commands.gazebo_paths import adopt_exports, find_world
from cartwheel.cli.commands.gzclient import is_same
from cartwheel.cli.commands.gzserver import translated
from cartwheel.codes.command import (
    GAZEBO_OPTION_UNSUPPORTED,
    OPTION_INVALID,
    USAGE,
    WORLD_NOT_FOUND,
)
from cartwheel.description.files.package_folders import share
from cartwheel.errors import CartwheelError

EMPTY = str(share() / "worlds" / "empty.world")


@pytest.mark.parametrize(
    ("line", "field", "value"),
    [
        ("", "world", "worlds/empty.world"),
        ("my.world", "world", "my.world"),
        ("", "paused", False),
        ("-u", "paused", True),
        ("--pause", "paused", True),
        ("--verbose", "verbose", True),
        ("", "verbose", False),
        ("--seed 7", "seed", 7),
        ("--seed=7.0", "seed", 7),
        ("--iters 250", "iterations", 250),
        ("", "iterations", None),
        ("-v", "version", True),
        ("__name:=gazebo __log:=/x/y.log my.world", "ros", ("__name:=gazebo", "__log:=/x/y.log")),
        ("-e ode worlds/mud.world __name:=gazebo", "world", "worlds/mud.world"),
        # What the launch files of gazebo_ros send, and what its scripts add.
        ("-u -r --verbose -e ode  worlds/empty.world", "paused", True),
        ("-s /a/libgazebo_ros_paths_plugin.so -s libgazebo_ros_api_plugin.so w", "world", "w"),
    ],
)
def test_what_the_server_is_sent(line, field, value):
    assert getattr(parse_server("gzserver", line.split()), field) == value


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("-e bullet", "-e bullet is ignored"),
        ("-ebullet", "-e bullet is ignored"),
        ("--physics=dart", "-e dart is ignored"),
        ("-r", "rosbag record"),
        ("--record_path /tmp/x", "rosbag record"),
        ("-r --record_path /tmp/x --record_period 1", "rosbag record"),
        ("--headless", "gui:=false"),
        ("-o fast", "-o fast is ignored"),
        ("--initial_sim_time 3", "time always starts at 0"),
        ("--minimal_comms", "--minimal_comms is ignored"),
        ("-s libmy_plugin.so", "-s libmy_plugin.so is ignored"),
        ("one.world two.world", "two.world is ignored"),
    ],
)
def test_what_does_not_apply_is_said_once(line, said):
    (note,) = parse_server("gzserver", line.split()).notes
    assert said in note
    assert "\n" not in note


@pytest.mark.parametrize(
    "line",
    [
        "",
        "-e ode",
        "--lockstep",
        "-u --verbose --seed 1 --iters 2",
        "-s libgazebo_ros_api_plugin.so",
        "-s libgazebo_ros_init.so -s libgazebo_ros_factory.so",
        "--initial_sim_time 0",
    ],
)
def test_what_applies_is_done_without_a_word(line):
    assert parse_server("gzserver", line.split()).notes == ()


def test_scripts_that_have_no_tool_here_say_so():
    assert "gdb" in parse_server("debug", []).notes[0]
    assert parse_server("debug", []).verbose
    assert "valgrind" in parse_server("perf", []).notes[0]


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("--nonsense", USAGE),
        ("--seed x", USAGE),
        ("--seed 1.5", USAGE),
        ("--iters 0", OPTION_INVALID),
        ("--iters", USAGE),
        ("-p state.log", GAZEBO_OPTION_UNSUPPORTED),
    ],
)
def test_refusals(line, code):
    with raises(code):
        parse_server("gzserver", line.split())


def test_the_server_as_a_run():
    options = translated(
        "gzserver",
        parse_server("gzserver", ["-u", "--seed", "3", "--iters", "9", "__name:=sim"]),
    )
    assert options.file == EMPTY
    assert (options.headless, options.paused, options.seed, options.steps) == (True, True, 3, 9)
    assert options.plan.ros1 == "gazebo"
    assert options.plan.ros1_arguments == ("__name:=sim",)
    assert not translated("gazebo", parse_server("gazebo", [])).headless


def test_what_the_client_is_sent():
    assert parse_client(["--verbose", "__name:=gui"]).ros == ("__name:=gui",)
    assert parse_client(["-g", "libgazebo_ros_paths_plugin.so"]).notes == ()
    assert "libx.so" in parse_client(["-g", "libx.so"]).notes[0]
    with pytest.raises(CartwheelError):
        parse_client(["--nonsense"])


def test_worlds_are_found_here_then_in_the_resource_path_then_among_the_shipped(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    resources = tmp_path / "resources"
    environment = {"GAZEBO_RESOURCE_PATH": f"/nowhere{os.pathsep}{resources}"}
    assert find_world("worlds/empty.world", environment) == Path(EMPTY)
    assert find_world("empty.world", environment) == Path(EMPTY)
    (resources / "worlds").mkdir(parents=True)
    theirs = resources / "worlds" / "empty.world"
    theirs.write_text("<sdf/>")
    assert find_world("worlds/empty.world", environment) == theirs
    (tmp_path / "worlds").mkdir()
    here = tmp_path / "worlds" / "empty.world"
    here.write_text("<sdf/>")
    assert find_world("worlds/empty.world", environment) == here
    assert find_world(str(theirs), {}) == theirs


def test_a_world_that_is_nowhere(tmp_path):
    with raises(WORLD_NOT_FOUND, world="worlds/emtpy.world", meant="worlds/empty.world"):
        find_world("worlds/emtpy.world", {"GAZEBO_RESOURCE_PATH": str(tmp_path)})
    with raises(WORLD_NOT_FOUND, world="/nowhere/my.world"):
        find_world("/nowhere/my.world", {})


def package(folder: Path, export: str) -> Path:
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(
        f"<package><name>{folder.name}</name><export>{export}</export></package>"
    )
    return folder


def test_packages_export_models_and_resources(tmp_path):
    source = tmp_path / "src"
    robot = package(
        source / "repository" / "robot",
        '<gazebo_ros gazebo_model_path="${prefix}/.." gazebo_media_path="${prefix}:${prefix}/m"/>',
    )
    package(source / "plain", "<build_type>catkin</build_type>")
    package(source / "broken", '<gazebo_ros gazebo_model_path="x" <')
    package(source / "ignored" / "hidden", '<gazebo_ros gazebo_model_path="${prefix}"/>')
    (source / "ignored" / "CATKIN_IGNORE").touch()
    environment = {"ROS_PACKAGE_PATH": f"{source}:/nowhere", "GAZEBO_MODEL_PATH": "/mine"}
    adopt_exports(environment)
    assert environment["GAZEBO_MODEL_PATH"].split(":") == ["/mine", str(robot.parent)]
    assert environment["GAZEBO_RESOURCE_PATH"].split(":") == [str(robot), str(robot / "m")]
    before = dict(environment)
    adopt_exports(environment)
    assert environment == before


def test_without_ros_nothing_is_exported():
    environment: dict[str, str] = {}
    adopt_exports(environment)
    assert environment == {}


def test_one_master_has_several_names():
    assert is_same("http://localhost:11311", "http://127.0.0.1:11311/")
    assert not is_same("http://localhost:11311", "http://localhost:11312")
    assert not is_same("http://robot:11311", "http://localhost:11311")
    assert not is_same(None, "http://localhost:11311")
