"""The systems that publish sensors in gz-sim, in the worlds that launch files start."""

import pytest

from cartwheel.checks import subject
from cartwheel.checks.checking import check
from cartwheel.checks.rules.worlds import sensor_systems
from cartwheel.codes.devices import SENSOR_SYSTEM_MISSING
from cartwheel.corpus import try_robot
from cartwheel.description.launches import LaunchSearch
from cartwheel.description.model import WorldDescription
from cartwheel.errors import Origin

BODY = (
    '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" '
    'ixy="0" ixz="0" iyz="0"/></inertial>'
    '<collision><geometry><box size="1 1 0.1"/></geometry></collision>'
)
SENSOR = '<sensor name="{kind}_1" type="{kind}"><topic>{kind}</topic></sensor>'
PLUGIN = '<plugin filename="{0}-system" name="{1}"/>'
PHYSICS = PLUGIN.format("gz-sim-physics", "gz::sim::systems::Physics")
SENSORS = PLUGIN.format("gz-sim-sensors", "gz::sim::systems::Sensors")
IMU = PLUGIN.format("libignition-gazebo6-imu", "ignition::gazebo::systems::Imu")
LAUNCH = """
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory("eye")
    description = Command(["xacro ", os.path.join(share, "urdf", "eye.urdf")])
    sim = os.path.join(get_package_share_directory("ros_gz_sim"), "launch", "gz_sim.launch.py")
    return LaunchDescription([
        DeclareLaunchArgument("world", default_value={world}),
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": description}}]),
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(sim),
            launch_arguments={{"{argument}": ["-r -v 4 ", LaunchConfiguration("world")]}}.items()),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description"]),
    ])
"""
OWN = 'os.path.join(share, "worlds", "{}.sdf")'


def package(tmp_path, kinds=("camera",), robot="", arena=PHYSICS, **launches):
    """A robot with sensors, a world and launch files; each starts a world."""
    folder = tmp_path / "eye"
    for name in ("urdf", "launch", "worlds", ".git"):
        (folder / name).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>eye</name></package>")
    sensors = "".join(SENSOR.format(kind=kind) for kind in kinds)
    path = folder / "urdf" / "eye.urdf"
    path.write_text(
        f'<robot name="eye"><link name="base">{BODY}</link>{robot}'
        f'<gazebo reference="base">{sensors}</gazebo></robot>'
    )
    world = f'<sdf version="1.9"><world name="arena">{arena}</world></sdf>'
    (folder / "worlds" / "arena.sdf").write_text(world)
    for name, stated in launches.items():
        argument = "ign_args" if name.startswith("ign") else "gz_args"
        text = LAUNCH.format(world=stated, argument=argument)
        (folder / "launch" / f"{name}.launch.py").write_text(text)
    return path


def missing(path):
    found = [each for each in check(path).findings if each.code is SENSOR_SYSTEM_MISSING]
    return {each.values["system"]: each for each in found}


@pytest.mark.parametrize("name", ["gz", "ign"])
@pytest.mark.parametrize(
    ("world", "arena", "systems"),
    [
        ('"empty.sdf"', "", {"sensors", "imu"}),
        ('"shapes.sdf"', "", {"sensors", "imu", "contact"}),
        (OWN.format("arena"), PHYSICS, {"sensors", "imu", "contact"}),
        (OWN.format("arena"), PHYSICS + SENSORS, {"imu", "contact"}),
        (OWN.format("arena"), IMU, {"sensors", "contact"}),
        (
            OWN.format("arena"),
            f'<model name="m"><link name="l"/>{IMU}</model>',
            {"sensors", "contact"},
        ),
        # A world of another package, and one that only the execution determines
        ('"depot.sdf"', "", set()),
        (OWN.format("unknown"), "", set()),
        ('os.environ["WORLD"]', "", set()),
    ],
)
def test_systems_that_the_world_of_a_launch_file_lacks(tmp_path, name, world, arena, systems):
    path = package(tmp_path, ("camera", "imu", "contact", "ray"), arena=arena, **{name: world})
    assert set(missing(path)) == {f"gz-sim-{each}-system" for each in systems}


@pytest.mark.parametrize(
    "robot",
    [
        f"<gazebo>{SENSORS}</gazebo>",
        f'<gazebo reference="base"><sensor name="s" type="camera">{SENSORS}</sensor></gazebo>',
    ],
)
def test_a_system_of_the_robot_acts_on_the_world(tmp_path, robot):
    assert not missing(package(tmp_path, robot=robot, one='"empty.sdf"'))


def test_a_launch_file_with_the_system_is_enough(tmp_path):
    path = package(tmp_path, arena=SENSORS, one='"empty.sdf"', two=OWN.format("arena"))
    assert not missing(path)


def test_a_world_of_the_same_name_in_the_repository_may_be_meant(tmp_path):
    path = package(tmp_path, one='"empty.sdf"')
    assert missing(path)
    (path.parents[1] / "worlds" / "arena.sdf").rename(path.parents[1] / "worlds" / "empty.sdf")
    assert missing(path)
    other = path.parents[1] / "worlds" / "more"
    other.mkdir()
    text = f'<sdf version="1.9"><world name="empty">{SENSORS}</world></sdf>'
    (other / "empty.sdf").write_text(text)
    assert not missing(path)


def test_other_default_systems_may_contain_the_system(tmp_path):
    path = package(tmp_path, one='"empty.sdf"')
    (path.parents[1] / "server.config").write_text("<server_config/>")
    assert not missing(path)


def test_without_a_launch_file_the_world_is_unknown(tmp_path):
    assert not missing(package(tmp_path))


@pytest.mark.wording
@pytest.mark.parametrize(
    ("world", "arena", "robot", "hint"),
    [
        (
            '"empty.sdf"',
            "",
            "",
            f"Add <gazebo>{SENSORS}</gazebo> to the robot, or start another world.",
        ),
        (
            OWN.format("arena"),
            PHYSICS,
            f"<gazebo>{PLUGIN.format('libignition-gazebo-pose-publisher', 'p')}</gazebo>",
            'Add <gazebo><plugin filename="ignition-gazebo-sensors-system" '
            'name="ignition::gazebo::systems::Sensors"/></gazebo> to the robot, or the plugin to '
            "the <world>.",
        ),
        (
            OWN.format("arena"),
            "",
            "",
            f"Add <gazebo>{SENSORS}</gazebo> to the robot, or the plugin to the <world>. "
            "Before Ionic, a <world> with a "
            "plugin also needs gz-sim-physics-system, gz-sim-user-commands-system and "
            "gz-sim-scene-broadcaster-system, which gz-sim only loads by itself into a world "
            "without plugins.",
        ),
    ],
)
def test_the_advice_names_the_plugin_to_write(tmp_path, world, arena, robot, hint):
    (found,) = missing(package(tmp_path, arena=arena, robot=robot, gz=world)).values()
    assert found.hint == hint
    assert found.values["sensors"] == ("camera_1",)


@pytest.mark.parametrize(
    ("plugins", "model", "systems"),
    [
        (PHYSICS, "", ["gz-sim-sensors-system"]),
        (PHYSICS + SENSORS, "", []),
        (PHYSICS, SENSORS, []),
        # It may be one for Gazebo Classic.
        ("", "", []),
    ],
)
def test_a_world_that_contains_the_robot(tmp_path, plugins, model, systems):
    path = tmp_path / "arena.sdf"
    camera = '<link name="l"><sensor name="c" type="camera"/></link>'
    path.write_text(
        f'<sdf version="1.9"><world name="w">{plugins}<model name="m">{camera}{model}</model>'
        "</world></sdf>"
    )
    assert list(missing(path)) == systems


@pytest.mark.parametrize(("arena", "faults"), [(PHYSICS + SENSORS, []), (PHYSICS, ["publish"])])
def test_a_sensor_without_its_system_is_a_fault_of_the_files(tmp_path, arena, faults):
    verdict = try_robot(package(tmp_path, arena=arena, gz=OWN.format("arena")), standing=0.5)
    assert [each.test for each in verdict.faults] == faults
    assert verdict.outcome == ("file" if faults else "good")


@pytest.mark.parametrize(("count", "found"), [(3, True), (10**6, False)])
def test_a_limited_number_of_folders_is_searched_once(tmp_path, monkeypatch, count, found):
    """A file outside of a repository may be in a folder with any number of them."""
    path = tmp_path / "world.sdf"
    sensor = SENSOR.format(kind="camera")
    path.write_text(
        f'<sdf version="1.9"><world name="arena">{PHYSICS}<model name="eye"><link name="base">'
        f"{BODY}{sensor}</link></model></world></sdf>"
    )
    visited = []

    def folders(folder):
        for number in range(count):
            visited.append(number)
            yield folder / str(number), []

    monkeypatch.setattr(subject, "source_folders", folders)
    assert bool(missing(path)) == found
    assert len(visited) <= min(count, subject.MOST_FOLDERS)


def test_a_world_is_read_once_for_all_launch_files(tmp_path, monkeypatch):
    included = "<include><uri>model://nowhere</uri></include>"
    launches = {f"launch_{number}": OWN.format("arena") for number in range(3)}
    path = package(tmp_path, arena=PHYSICS + included, **launches)
    read = []

    def load(file, **_):
        read.append(file)
        return WorldDescription(name="arena", origin=Origin(file=str(file)))

    monkeypatch.setattr(sensor_systems, "load_world", load)
    assert missing(path)
    assert len(read) == 1


def test_the_launch_files_of_a_robot_are_searched_once(tmp_path):
    path = package(tmp_path, robot=f"<gazebo>{IMU}</gazebo>", gz='"empty.sdf"')
    searched = []

    def search(file):
        searched.append(file)
        return LaunchSearch().of(file)

    assert check(path, launches=search).findings
    assert len(searched) == len(set(searched))
