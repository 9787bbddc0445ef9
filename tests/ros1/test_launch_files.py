"""Launch files as roslaunch reads them: nodes, arguments, parameters."""

import pytest
import yaml

WORLDS = ("elevator", "mud", "rubble", "shapes", "willowgarage")
PLAIN = ["-e", "ode", "worlds/empty.world"]


@pytest.fixture
def server(ros):
    """The words that the server's program is started with."""

    def read(file, *arguments):
        done = ros.run("roslaunch", "gazebo_ros", file, *arguments, "--args", "gazebo")
        program, *words = done.stdout.split()
        return program.rsplit("/", 1)[1], [word for word in words if ":=" not in word]

    return read


@pytest.mark.parametrize(
    ("argument", "program", "words"),
    [
        ("gui:=true", "gzserver", PLAIN),
        ("paused:=true", "gzserver", ["-u", *PLAIN]),
        ("recording:=true", "gzserver", ["-r", *PLAIN]),
        ("verbose:=true", "gzserver", ["--verbose", *PLAIN]),
        ("headless:=true", "gzserver", ["--headless", *PLAIN]),
        ("debug:=true", "debug", PLAIN),
        ("physics:=bullet", "gzserver", ["-e", "bullet", "worlds/empty.world"]),
        ("world_name:=my.world", "gzserver", ["-e", "ode", "my.world"]),
        (
            "extra_gazebo_args:=--seed 4",
            "gzserver",
            ["-e", "ode", "--seed", "4", "worlds/empty.world"],
        ),
    ],
)
def test_arguments_reach_the_server(server, argument, program, words):
    assert server("empty_world.launch", argument) == (program, words)


@pytest.mark.parametrize(
    ("arguments", "name", "value"),
    [
        ((), "/use_sim_time", True),
        (("use_sim_time:=false",), "/use_sim_time", False),
        ((), "/gazebo/enable_ros_network", True),
        (("enable_ros_network:=false",), "/gazebo/enable_ros_network", False),
        ((), "/gazebo/pub_clock_frequency", None),
        (("pub_clock_frequency:=20",), "/gazebo/pub_clock_frequency", None),
        (("use_clock_frequency:=true",), "/gazebo/pub_clock_frequency", 100),
        (
            ("use_clock_frequency:=true", "pub_clock_frequency:=20"),
            "/gazebo/pub_clock_frequency",
            20,
        ),
    ],
)
def test_arguments_become_parameters(ros, arguments, name, value):
    done = ros.run("roslaunch", "gazebo_ros", "empty_world.launch", *arguments, "--dump-params")
    assert yaml.safe_load(done.stdout).get(name) == value


LOADED = """
import sys, roslaunch, rospkg
folder = rospkg.RosPack().get_path("gazebo_ros") + "/launch/"
files = [(folder + sys.argv[1], sys.argv[2:])]
for node in roslaunch.config.load_config_default(files, None, verbose=False).nodes:
    print(node.name, node.type, node.output, node.respawn, node.required)
"""


@pytest.mark.parametrize(
    ("arguments", "nodes"),
    [
        ("", "gazebo gzserver screen False False\ngazebo_gui gzclient screen False False"),
        ("gui:=false", "gazebo gzserver screen False False"),
        ("gui:=false output:=log", "gazebo gzserver log False False"),
        ("gui:=false respawn_gazebo:=true", "gazebo gzserver screen True False"),
        (
            "server_required:=true gui_required:=true",
            "gazebo gzserver screen False True\ngazebo_gui gzclient screen False True",
        ),
    ],
)
def test_arguments_become_properties_of_nodes(ros, arguments, nodes):
    process = ros.python(LOADED, "empty_world.launch", *arguments.split())
    output, errors = process.communicate(timeout=60)
    assert output.strip() == nodes, errors


@pytest.mark.parametrize("world", WORLDS)
def test_worlds_have_launch_files_of_their_names(ros, server, world):
    program, words = server(f"{world}_world.launch", "paused:=true", "gui:=false")
    assert program == "gzserver"
    assert words[0] == "-u"
    assert words[-1] == f"worlds/{world}.world"
    done = ros.run("roslaunch", "gazebo_ros", f"{world}_world.launch", "gui:=false", "--nodes")
    assert done.stdout.split() == ["/gazebo"]


def test_the_ranges_world_is_a_file_of_gazebo_plugins(server):
    program, words = server("range_world.launch")
    assert program == "gzserver"
    assert words[-1].endswith("/gazebo_plugins/test/test_worlds/gazebo_ros_range.world")


@pytest.mark.parametrize("xacro", ["xacro", "xacro.py"])
@pytest.mark.parametrize("file", ["rviz.launch", "spawn.launch"])
def test_the_carts_launch_files_expand_it(ros, file, xacro):
    done = ros.run("roslaunch", "rosbots_description", file, f"xacro:={xacro}", "--dump-params")
    assert '<robot name="rosbots">' in yaml.safe_load(done.stdout)["/robot_description"]
