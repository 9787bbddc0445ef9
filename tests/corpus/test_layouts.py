"""Files of controllers in a layout in which their manager does not find them."""

import pytest
from tests.corpus.carts import cart, controlled, written

import cartwheel
from cartwheel.codes.devices import CONTROLLERS_FILE_WITHOUT_CONTROLLERS, CONTROLLERS_NOT_FOUND
from cartwheel.corpus import try_robot
from cartwheel.corpus.listening import controllers_of

TRANSMISSION = (
    '<transmission name="t"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="left_joint"><hardwareInterface>hardware_interface/VelocityJointInterface'
    '</hardwareInterface></joint><actuator name="m"/></transmission>'
    '<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>'
)
LAUNCH = """<launch>
  <param name="robot_description" textfile="$(find cart)/robot.urdf"/>
  <node pkg="gazebo_ros" type="spawn_model" name="s" args="-urdf -param robot_description"/>
  <rosparam command="load" file="$(find cart)/wheel.yaml"/>
  <node pkg="controller_manager" type="spawner" name="c" args="wheel"/>
</launch>"""
WHEEL = """# For ROS 2.
controller_manager:
  ros__parameters:
    wheel: {type: velocity_controllers/JointVelocityController, joint: left_joint}
"""


def test_a_file_in_the_layout_of_ros_2_is_why_ros_1_finds_no_controllers(tmp_path):
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    (tmp_path / "wheel.yaml").write_text(WHEEL)
    (tmp_path / "sim.launch").write_text(LAUNCH)
    verdict = try_robot(written(tmp_path, cart(), TRANSMISSION), standing=1.0)
    (reason,) = {each.reason for each in verdict.faults if each.test == "controller"}
    assert reason is not None
    assert reason.code is CONTROLLERS_NOT_FOUND
    assert (reason.origin.file, reason.origin.line) == (str(tmp_path / "wheel.yaml"), 2)


def test_a_misspelt_key_for_which_ros_2_refuses_the_file_is_named(tmp_path):
    path = written(tmp_path, cart(), controlled(tmp_path))
    file = tmp_path / "base.yaml"
    file.write_text(file.read_text().replace("ros__parameters", "ros_parameters", 1))
    verdict = try_robot(path, standing=1.0)
    (reason,) = (each.reason for each in verdict.faults)
    assert reason is not None
    assert (reason.code, reason.values["key"]) == (
        CONTROLLERS_FILE_WITHOUT_CONTROLLERS,
        "ros_parameters",
    )
    assert (reason.origin.file, reason.origin.line) == (str(file), 2)


LOADED = '<rosparam command="load" file="$(find motors)/own/FILE.yaml"/>'
UPLOAD = '<param name="robot_description" textfile="$(find cart)/robot.urdf"/>'
STARTED = '<node pkg="controller_manager" type="spawner" name="c" args="wheel"/>'
ROS1_WHEEL = "wheel: {type: velocity_controllers/JointVelocityController, joint: left_joint}\n"


def apart(folder, sim, motors):
    """A cart, and the launch file and controllers of a second package."""
    for name in ("cart", "motors"):
        (folder / name).mkdir()
        (folder / name / "package.xml").write_text(f"<package><name>{name}</name></package>")
    (folder / "motors" / "own").mkdir()
    (folder / "motors" / "own" / "left_wheels.yaml").write_text(ROS1_WHEEL)
    begin, end = LAUNCH.partition("  <rosparam")[0], "</launch>"
    (folder / "cart" / "sim.launch").write_text(begin + sim + end)
    (folder / "motors" / "motors.launch").write_text(f"<launch>{motors}</launch>")
    return written(folder / "cart", cart(), TRANSMISSION)


@pytest.mark.parametrize(
    ("sim", "motors"),
    [
        # The launch file of the motors loads the description once more.
        ("", UPLOAD + LOADED + STARTED),
        # One launch file sets the parameters of the controller that another one starts.
        (STARTED, LOADED),
        (LOADED, STARTED),
        # Only an argument without a default states a part of the file's name.
        ("", '<arg name="side"/>' + LOADED.replace("FILE", "$(arg side)_wheels") + STARTED),
    ],
)
def test_the_controllers_of_another_package_are_found(tmp_path, sim, motors):
    texts = (each.replace("FILE", "left_wheels") for each in (sim, motors))
    path = apart(tmp_path, *texts)
    assert CONTROLLERS_NOT_FOUND not in {each.code for each in cartwheel.check(path).findings}
    verdict = try_robot(path, standing=1.0)
    assert verdict.controllers == ("wheel",)
    assert CONTROLLERS_NOT_FOUND not in {each.code for each in verdict.faults}
    with cartwheel.World("empty") as world:
        world.spawn(path, controllers="auto")
        assert "wheel" in {each.name for each in controllers_of(world).started}


def test_a_file_of_which_several_may_be_meant_is_not_guessed(tmp_path):
    motors = '<arg name="side"/>' + LOADED.replace("FILE", "$(arg side)_wheels") + STARTED
    path = apart(tmp_path, "", motors)
    (tmp_path / "motors" / "own" / "right_wheels.yaml").write_text(ROS1_WHEEL)
    assert try_robot(path, standing=1.0).controllers == ()


@pytest.mark.parametrize("given", ["", "<xacro:if value='$(arg named)'>{}</xacro:if>", "{}"])
@pytest.mark.parametrize("file", ["gz_ros2_control-system", "libgazebo_ros2_control.so"])
def test_the_plugin_of_gz_needs_the_tag_that_names_the_files(tmp_path, given, file):
    text = controlled(tmp_path)
    tag = text[text.index("<parameters>") : text.index("</plugin></gazebo>")]
    text = text.replace(tag, given.format(tag)).replace("gz_ros2_control-system", file)
    path = tmp_path / "robot.xacro"
    path.write_text(
        '<robot name="robot" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        f'<xacro:arg name="named" default="false"/>{cart()}{text}</robot>'
    )
    found = [each for each in cartwheel.check(path).findings if "plugin" in each.values]
    found = [each for each in found if each.code is CONTROLLERS_NOT_FOUND]
    strict = file.startswith("gz")
    expected = {"": ["warning"], "{}": []}.get(given, ["info"]) if strict else []
    assert [each.severity for each in found] == expected
    faults = try_robot(path, standing=1.0, controllers=[tmp_path / "base.yaml"]).faults
    reasons = [each.reason for each in faults if each.code is CONTROLLERS_NOT_FOUND]
    assert reasons == ([each for each in found if each.severity == "warning"])
