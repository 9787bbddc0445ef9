"""Controllers of a launch file that cannot start, and types that the repository defines."""

import pytest

import cartwheel
from cartwheel.codes.devices import (
    CONTROLLER_INTERFACE_MISMATCH,
    CONTROLLER_JOINT_UNKNOWN,
    CONTROLLER_TYPE_UNKNOWN,
)
from cartwheel.codes.running import CONTROLLER_NOT_STARTED
from cartwheel.description.files.plugin_xml import exporting_file
from cartwheel.dialects.ros_control.catalogue import find_type
from cartwheel.errors import UnknownNameError

BODY = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
OWN = "effort_controller/JointTrajectoryController"
EXPORTED = f'<library path="lib/x"><class name="{OWN}" type="own::Own"/></library>'


def joint(name, kind="revolute"):
    transmission = (
        f'<transmission name="{name}_t"><type>transmission_interface/SimpleTransmission</type>'
        f'<joint name="{name}"><hardwareInterface>hardware_interface/EffortJointInterface'
        '</hardwareInterface></joint><actuator name="m"/></transmission>'
    )
    return (
        f'<link name="{name}_link">{BODY}</link><joint name="{name}" type="{kind}">'
        f'<parent link="base"/><child link="{name}_link"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" effort="9" velocity="1"/></joint>'
    ) + transmission * (kind != "fixed")


def repository(tmp_path, controllers, started=("elbow_controller", "finger_controller")):
    folder = tmp_path / "bot"
    folder.mkdir()
    (folder / ".git").mkdir()
    (folder / "package.xml").write_text("<package><name>bot</name></package>")
    (folder / "bot.yaml").write_text(controllers)
    (folder / "bot.launch").write_text(
        '<launch><param name="robot_description" textfile="$(find bot)/bot.urdf"/>'
        '<rosparam command="load" file="$(find bot)/bot.yaml"/>'
        f'<node name="s" pkg="controller_manager" type="spawner" args="{" ".join(started)}"/>'
        "</launch>"
    )
    path = folder / "bot.urdf"
    plugin = '<gazebo><plugin name="c" filename="libgazebo_ros_control.so"/></gazebo>'
    parts = joint("elbow"), joint("wrist"), joint("mount", "fixed"), joint("plate", "fixed")
    path.write_text(
        f'<robot name="bot"><link name="base">{BODY}</link>{"".join(parts)}{plugin}</robot>'
    )
    return path


def found(path, code):
    return [each for each in cartwheel.check(path).findings if each.code is code]


EFFORT = "{0}_controller: {{type: effort_controllers/JointEffortController, joint: {0}}}\n"


@pytest.mark.parametrize(
    ("started", "expected"),
    [
        (("elbow_controller", "gripper_controller"), ["gripper_controller"]),
        # Of another variant of the robot
        (("elbow_controller",), []),
    ],
)
def test_a_launched_controller_without_its_joint_is_reported(tmp_path, started, expected):
    text = "".join(map(EFFORT.format, ("elbow", "wrist", "gripper")))
    reported = found(repository(tmp_path, text, started), CONTROLLER_NOT_STARTED)
    assert [each.values["controller"] for each in reported] == expected
    assert all(each.values["cause"] == CONTROLLER_JOINT_UNKNOWN.number for each in reported)


def test_a_misspelt_joint_is_reported_once(tmp_path):
    text = "".join(map(EFFORT.format, ("elbow", "wrist", "elbwo")))
    path = repository(tmp_path, text, ("elbow_controller", "elbwo_controller"))
    assert not found(path, CONTROLLER_NOT_STARTED)
    assert len(found(path, CONTROLLER_JOINT_UNKNOWN)) == 1


def own_controller(tmp_path, joints, exported=EXPORTED):
    path = repository(tmp_path, f"arm: {{type: {OWN}, joints: [{joints}]}}", ("arm",))
    package = path.parent / "bot_control"
    package.mkdir()
    (package / "package.xml").write_text("<package><name>bot_control</name></package>")
    (package / "controllers.xml").write_text(exported)
    return path


@pytest.mark.parametrize(
    ("exported", "severity", "meant"),
    [
        (EXPORTED, "info", False),
        (EXPORTED.replace("r/Joint", "r::Joint"), "info", False),
        (f"<!-- {EXPORTED} -->", "warning", True),
    ],
)
def test_a_type_that_the_repository_exports_exists(tmp_path, exported, severity, meant):
    path = own_controller(tmp_path, "elbow, wrist", exported)
    (reported,) = found(path, CONTROLLER_TYPE_UNKNOWN)
    assert (reported.severity, bool(reported.values["meant"])) == (severity, meant)
    with pytest.raises(UnknownNameError) as caught:
        find_type(OWN, ros2=False, file=str(path))
    assert bool(caught.value.values["meant"]) == meant


@pytest.mark.wording
@pytest.mark.parametrize(
    ("kind", "meant"),
    [
        ("my_impedance_controller/Controller", ""),
        ("my_position_controllers/JointPositionController", ""),
        ("position_controller/JointPositionController", "position_controllers"),
        ("position_controllers/JointPositionControler", "position_controllers"),
    ],
)
def test_a_type_of_a_package_with_another_name_may_exist(kind, meant):
    with pytest.raises(UnknownNameError) as caught:
        find_type(kind, ros2=False)
    assert str(caught.value.values["meant"]).partition("/")[0] == meant
    said = "does not exist" if meant else "is not supported"
    assert caught.value.message == f'controller type "{kind}" {said}'
    assert bool(caught.value.hint) == bool(meant)


def test_the_names_that_are_kept_of_a_file_are_bounded(tmp_path):
    """A repository may contain thousands of such files."""
    names = "".join(f'<class name="own/Controller{number}"/>' for number in range(500))
    path = own_controller(tmp_path, "elbow, wrist", names)
    assert exporting_file(path, "own/Controller0") is not None
    assert exporting_file(path, "own/Controller499") is None


@pytest.mark.parametrize(
    ("joints", "fixed"),
    [
        ("elbow, mount, wrist", ("mount",)),
        ("elbow, mount, plate", ("mount", "plate")),
        ("elbow, wrist", ()),
    ],
)
def test_fixed_joints_of_unsupported_controllers_are_reported(tmp_path, joints, fixed):
    reported = found(own_controller(tmp_path, joints), CONTROLLER_INTERFACE_MISMATCH)
    assert [each.values["joints"] for each in reported] == [fixed] * bool(fixed)


@pytest.mark.parametrize(
    ("hardware", "listed", "interface"),
    [
        ("gazebo_ros2_control/GazeboSystem", "position, velocity", ""),
        ("gazebo_ros2_control/GazeboSystem", "position, effort", "effort"),
        # Gazebo's hardware does not export it, although it is listed.
        ("gazebo_ros2_control/GazeboSystem", "position, acceleration", "acceleration"),
        ("mock_components/GenericSystem", "position, acceleration", ""),
    ],
)
def test_a_joint_must_offer_all_interfaces_of_a_controller(tmp_path, hardware, listed, interface):
    file = tmp_path / "arm.yaml"
    kind = "joint_trajectory_controller/JointTrajectoryController"
    file.write_text(
        f"controller_manager:\n  ros__parameters:\n    arm: {{type: {kind}}}\n"
        f"arm:\n  ros__parameters:\n    joints: [elbow]\n    command_interfaces: [{listed}]\n"
    )
    offered = "".join(
        f'<command_interface name="{each}"/>' for each in ("position", "velocity", "acceleration")
    )
    path = tmp_path / "arm.urdf"
    path.write_text(
        f'<robot name="arm"><link name="world"/><link name="hand">{BODY}</link>'
        '<joint name="elbow" type="revolute"><parent link="world"/><child link="hand"/>'
        '<limit lower="-1" upper="1" effort="9" velocity="3"/></joint>'
        f'<ros2_control name="s" type="system"><hardware><plugin>{hardware}</plugin></hardware>'
        f'<joint name="elbow">{offered}</joint></ros2_control><gazebo>'
        '<plugin name="c" filename="libgazebo_ros2_control.so">'
        f"<parameters>{file}</parameters></plugin></gazebo></robot>"
    )
    reported = found(path, CONTROLLER_INTERFACE_MISMATCH)
    assert [each.values["interface"] for each in reported] == [interface] * bool(interface)
