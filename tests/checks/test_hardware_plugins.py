"""Hardware of ``<ros2_control>`` for Gazebo, and the plugins that run it."""

import pytest
from tests.corpus.carts import cart
from tests.corpus.carts import plugin as drive
from tests.dialects.ros_control.arms import (
    ROS1,
    beam,
    robot,
    ros2_joint,
    ros2_system,
    transmission,
)

import cartwheel
from cartwheel.codes.devices import HARDWARE_WITHOUT_PLUGIN
from cartwheel.corpus import try_robot

MANAGER = '<plugin filename="{file}" name="c"/>'


def arm(plugin, *, hardware="gz_ros2_control/GazeboSimSystem"):
    system = ros2_system(ros2_joint("beam_joint"))
    start, end = system.index("<plugin>") + len("<plugin>"), system.index("</plugin>")
    return robot(beam("beam", "world") + system[:start] + hardware + system[end:], plugin)


@pytest.mark.parametrize(
    ("text", "plugin"),
    [
        (arm(""), "gz_ros2_control-system"),
        (arm("", hardware="gazebo_ros2_control/GazeboSystem"), "libgazebo_ros2_control.so"),
        (arm("", hardware="mock_components/GenericSystem"), None),
        (arm(MANAGER.format(file="gz_ros2_control-system")), None),
        (arm(MANAGER.format(file="libmy_control.so")), None),
    ],
)
def test_hardware_for_gazebo_needs_its_plugin(tmp_path, text, plugin):
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    found = [e for e in cartwheel.check(path).findings if e.code is HARDWARE_WITHOUT_PLUGIN]
    assert [each.values["plugin"] for each in found] == [plugin] * (plugin is not None)


def test_without_it_the_robot_should_move_and_does_not(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(arm(""))
    verdict = try_robot(path, standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("controller", HARDWARE_WITHOUT_PLUGIN, "file")
    assert verdict.should_move
    assert not verdict.moves


SPAWN = '<node name="s" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/>'


@pytest.mark.parametrize(
    ("plugin", "gazebo", "controllers", "reported"),
    [
        ("", SPAWN, "arm_controller", True),
        ("", "", "arm_controller", False),
        ("", SPAWN, "joint_state_controller", False),
        (ROS1, SPAWN, "arm_controller", False),
        (ROS1.replace("libgazebo_ros_control", "libmy_control"), SPAWN, "arm_controller", False),
    ],
)
def test_transmissions_need_the_plugin_that_runs_controllers(
    tmp_path, plugin, gazebo, controllers, reported
):
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "arm.urdf").write_text(
        robot(beam("beam", "world") + transmission("beam_joint", "Effort"), plugin)
    )
    (tmp_path / "arm.launch").write_text(
        f'<launch><param name="robot_description" textfile="$(find arm)/arm.urdf"/>{gazebo}'
        f'<node name="c" pkg="controller_manager" type="spawner" args="{controllers}"/></launch>'
    )
    verdict = try_robot(tmp_path / "arm.urdf", standing=1.0)
    found = [
        (each.test, each.source) for each in verdict.faults if each.code is HARDWARE_WITHOUT_PLUGIN
    ]
    assert found == [("controller", "file")] * reported
    assert not reported or verdict.outcome == "file"


DRIVE = drive()
ARM_YAML = """arm_controller:
  type: effort_controllers/JointEffortController
  joint: {joint}
"""


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize(
    ("plugin", "joint", "reported"),
    [("", "beam_joint", True), (DRIVE, "beam_joint", True), (DRIVE, "left_joint", False)],
)
def test_controllers_need_a_manager_beside_other_plugins(
    tmp_path, version, plugin, joint, reported
):
    """Also if the robot has no transmissions."""
    kind = "ament_cmake" if version == 2 else "catkin"
    (tmp_path / "package.xml").write_text(
        f"<package><name>arm</name><buildtool_depend>{kind}</buildtool_depend></package>"
    )
    (tmp_path / "arm.yaml").write_text(ARM_YAML.format(joint=joint))
    arm_on_cart = beam("beam", "base") if plugin else beam("beam", "world")
    (tmp_path / "arm.urdf").write_text(
        f'<robot name="arm"><link name="world"/>{arm_on_cart}</robot>'
        if not plugin
        else f'<robot name="arm">{cart()}{arm_on_cart}{plugin}</robot>'
    )
    (tmp_path / "arm.launch").write_text(
        f'<launch><param name="robot_description" textfile="$(find arm)/arm.urdf"/>{SPAWN}'
        '<rosparam file="$(find arm)/arm.yaml" command="load"/>'
        '<node name="c" pkg="controller_manager" type="spawner" args="arm_controller"/></launch>'
    )
    found = [
        each
        for each in cartwheel.check(tmp_path / "arm.urdf").findings
        if each.code is HARDWARE_WITHOUT_PLUGIN
    ]
    faults = [
        (each.test, each.source)
        for each in try_robot(tmp_path / "arm.urdf", standing=1.0).faults
        if each.code is HARDWARE_WITHOUT_PLUGIN
    ]
    assert [each.values["joints"] for each in found] == [("beam_joint",)] * reported
    assert faults == [("controller", "file")] * reported
    wanted = "gz_ros2_control" if version == 2 else "libgazebo_ros_control.so"
    assert all(wanted in str(each.hint) for each in found)


MOCK = "mock_components/GenericSystem"
SIM = '<node pkg="ros_gz_sim" exec="create" args="-topic robot_description"/>'


@pytest.mark.parametrize(
    ("hardware", "launch", "reported"),
    [
        (MOCK, (SIM, "arm_controller", ""), True),
        ("own_arm/ArmHardware", (SIM, "arm_controller", ""), True),
        (MOCK, (SIM, "joint_state_broadcaster", ""), False),
        (MOCK, ("", "arm_controller", ""), False),
        (MOCK, (SIM, "arm_controller", " real:=$(eval clock())"), False),
    ],
)
def test_controllers_in_gazebo_need_hardware_for_it(tmp_path, hardware, launch, reported):
    gazebo, controllers, argument = launch
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "arm.urdf").write_text(arm("", hardware=hardware))
    (tmp_path / "arm.launch.xml").write_text(
        '<launch><node pkg="robot_state_publisher" exec="robot_state_publisher">'
        '<param name="robot_description" '
        f"value=\"$(command 'xacro $(find-pkg-share arm)/arm.urdf{argument}')\"/></node>{gazebo}"
        f'<node pkg="controller_manager" exec="spawner" args="{controllers}"/></launch>'
    )
    verdict = try_robot(tmp_path / "arm.urdf", standing=1.0)
    found = [
        (each.subject, each.reason.values["hardware"])
        for each in verdict.faults
        if each.code is HARDWARE_WITHOUT_PLUGIN
    ]
    assert found == [("arm_controller", hardware)] * reported
    assert verdict.outcome == ("file" if reported else "good")
    assert verdict.should_move is reported


CLASSIC, GZ, IGN = "gazebo_ros2_control", "gz_ros2_control", "ign_ros2_control"
SYSTEM = {
    CLASSIC: f"{CLASSIC}/GazeboSystem",
    GZ: f"{GZ}/GazeboSimSystem",
    IGN: f"{IGN}/IgnitionSystem",
}
FILE = {CLASSIC: f"lib{CLASSIC}.so", GZ: f"{GZ}-system", IGN: f"lib{IGN}-system.so"}


def managed(hardware, gazebo=CLASSIC):
    return arm(MANAGER.format(file=FILE[gazebo]), hardware=hardware)


def unloaded(path, **more):
    found = cartwheel.check(path, **more).findings
    return [each for each in found if each.code is HARDWARE_WITHOUT_PLUGIN]


def exported(folder, hardware, base):
    """A repository that exports a class."""
    (folder / ".gitignore").write_text("")
    (folder / "package.xml").write_text("<package><name>arm</name></package>")
    (folder / "plugins.xml").write_text(
        f'<library path="arm"><class name="{hardware}" base_class_type="{base}"/></library>'
    )


@pytest.mark.parametrize(
    ("hardware", "gazebo", "loaded"),
    [
        (SYSTEM[CLASSIC], CLASSIC, True),
        (SYSTEM[GZ], GZ, True),
        (SYSTEM[IGN], GZ, True),
        (SYSTEM[IGN], IGN, True),
        (SYSTEM[GZ], IGN, False),
        (SYSTEM[GZ], CLASSIC, False),
        (SYSTEM[CLASSIC], GZ, False),
        (f"{GZ}/GazeboSystem", GZ, False),
        ("own_arm/ArmHardware", CLASSIC, False),
        ("own_arm/ArmHardware", GZ, False),
        ("mock_components/GenericSystem", CLASSIC, False),
        ("own_arm_gazebo/ArmSystem", CLASSIC, True),
        ("simple_arm/ArmSystem", CLASSIC, False),
        ("gabebo_ros2_control/GazeboSystem", CLASSIC, False),
        ("gz_ros2_contol::GazeboSimSystem", GZ, False),
        ("my_gazebo_ros2_control/GazeboSystem", CLASSIC, True),
        ("igus_ros2_control/ArmSimSystem", GZ, True),
    ],
)
def test_gazebo_loads_only_hardware_for_its_own_plugin(tmp_path, hardware, gazebo, loaded):
    path = tmp_path / "arm.urdf"
    path.write_text(managed(hardware, gazebo))
    found = unloaded(path)
    assert [each.values["hardware"] for each in found] == [hardware] * (not loaded)
    assert all(each.severity == "warning" for each in found)


def test_a_misspelt_package_means_that_of_the_plugin(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(managed("gabebo_ros2_control/GazeboSystem"))
    assert [each.values["meant"] for each in unloaded(path)] == [SYSTEM[CLASSIC]]
    exported(tmp_path, "gabebo_ros2_control/GazeboSystem", "")
    assert not unloaded(path)


@pytest.mark.parametrize(
    ("base", "loaded"),
    [
        ("hardware_interface::SystemInterface", False),
        (f"{CLASSIC}::GazeboSystemInterface", True),
        (f"{GZ}::GazeboSimSystemInterface", True),
    ],
)
@pytest.mark.parametrize("name", ["own_arm/ArmHardware", "own_arm_sim/Arm"])
def test_the_base_class_that_the_repository_exports_decides(tmp_path, name, base, loaded):
    exported(tmp_path, name, base)
    path = tmp_path / "arm.urdf"
    path.write_text(managed(name))
    assert bool(unloaded(path)) is not loaded


def test_joints_of_the_real_robot_that_are_also_listed_for_gazebo_move(tmp_path):
    path = tmp_path / "arm.urdf"
    real = ros2_system(ros2_joint("beam_joint")).replace(SYSTEM[GZ], "own_arm/ArmHardware")
    both = managed(SYSTEM[GZ], GZ).replace("<ros2_control", real + "<ros2_control", 1)
    path.write_text(both)
    assert not unloaded(path)
    path.write_text(
        both.replace('<joint name="beam_joint"><command', '<joint name="x"><command', 1)
    )
    assert [each.values["hardware"] for each in unloaded(path)] == ["own_arm/ArmHardware"]


def test_the_hardware_of_the_real_robot_stands_still_in_gazebo(tmp_path):
    parameters = tmp_path / "c.yaml"
    parameters.write_text(
        "controller_manager: {ros__parameters: {move: "
        "{type: position_controllers/JointGroupPositionController}}}\n"
        "move: {ros__parameters: {joints: [beam_joint]}}\n"
    )
    path = tmp_path / "arm.urdf"
    plugin = f'<plugin filename="{FILE[CLASSIC]}" name="c"><parameters>{parameters}</parameters>'
    path.write_text(arm(plugin + "</plugin>", hardware="own_arm/ArmHardware"))
    verdict = try_robot(path, standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("controller", HARDWARE_WITHOUT_PLUGIN, "file")
    # The joint is driven here nevertheless, which shows other faults.
    assert verdict.reaches
    assert verdict.should_move
    assert not verdict.moves
    path.write_text(path.read_text().replace("own_arm/ArmHardware", SYSTEM[CLASSIC]))
    assert try_robot(path, standing=1.0).good


def selected(folder, *, included=False):
    """A xacro with an argument for the simulation, which is off by default."""
    start, end = "<ros2_control", "</ros2_control>"
    text = managed("own_arm/ArmHardware")
    at, to = text.index(start), text.index(end) + len(end)
    real = text[at:to]
    if included:
        (folder / "real.xacro").write_text(
            f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro">{real}</robot>'
        )
        real = '<xacro:include filename="real.xacro"/>'
    simulated = text[at:to].replace("own_arm/ArmHardware", SYSTEM[CLASSIC])
    path = folder / "arm.urdf.xacro"
    path.write_text(
        (
            text[:at]
            + f'<xacro:if value="$(arg sim)">{simulated}</xacro:if>'
            + f'<xacro:unless value="$(arg sim)">{real}</xacro:unless>'
            + text[to:]
        ).replace(
            '<robot name="arm">',
            '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
            '<xacro:arg name="sim" default="false"/>',
        )
    )
    return path


@pytest.mark.parametrize("name", ["arm", "my arm"])
def test_a_macro_call_that_an_argument_selects_is_a_note_in_any_folder(tmp_path, name):
    folder = tmp_path / name
    folder.mkdir()
    path = selected(folder)
    start, end = '<xacro:unless value="$(arg sim)">', "</xacro:unless>"
    head, rest = path.read_text().split(start)
    real, tail = rest.split(end)
    # The lines of the definition are not in the condition.
    macro = f'<xacro:macro name="real">\n{real}\n</xacro:macro>'
    path.write_text(f"{head}\n{macro}\n{start}\n<xacro:real/>\n{end}\n{tail}")
    (note,) = unloaded(path)
    assert note.severity == "info"


def launched(folder, argument):
    """A launch file that starts Gazebo, with an argument of the xacro."""
    (folder / "package.xml").write_text("<package><name>arm</name></package>")
    (folder / "arm.launch").write_text(
        '<launch><param name="robot_description" '
        f'command="xacro $(find arm)/arm.urdf.xacro {argument}"/>{SPAWN}</launch>'
    )


@pytest.mark.parametrize("included", [False, True])
def test_hardware_that_an_argument_selects_is_a_note_unless_gazebo_is_started_with_it(
    tmp_path, included
):
    path = selected(tmp_path, included=included)
    (note,) = unloaded(path)
    assert note.severity == "info"
    assert not unloaded(path, arguments={"sim": "true"})
    assert not [each for each in try_robot(path, standing=1.0).faults if each.reason == note]
    launched(tmp_path, "sim:=true")
    (note,) = unloaded(path)
    assert note.severity == "info"
    launched(tmp_path, "")
    (warning,) = unloaded(path)
    assert warning.severity == "warning"
    codes = [fault.code for fault in try_robot(path, standing=1.0).faults]
    assert HARDWARE_WITHOUT_PLUGIN in codes
