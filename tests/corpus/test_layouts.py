"""Files of controllers in a layout in which their manager does not find them."""

from tests.corpus.carts import cart, controlled, written

from cartwheel.codes.devices import CONTROLLERS_FILE_WITHOUT_CONTROLLERS, CONTROLLERS_NOT_FOUND
from cartwheel.corpus import try_robot

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
