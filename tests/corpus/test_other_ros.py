"""Plugins of the other version of ROS, which Cartwheel runs and Gazebo does not."""

import pytest
from tests.corpus.carts import cart, plugin, written

from cartwheel.codes.devices import PLUGIN_OF_OTHER_ROS
from cartwheel.codes.robot import WHEEL_SEPARATION_MISMATCH
from cartwheel.codes.running import PLUGIN_LEFT_OUT
from cartwheel.corpus import try_robot

ROS2 = "<package><name>cart</name><export><build_type>ament_cmake</build_type></export></package>"
ROS1 = "<package><name>cart</name><buildtool_depend>catkin</buildtool_depend></package>"
CONTROL = '<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>' + "".join(
    f'<transmission name="{side}"><type>transmission_interface/SimpleTransmission</type>'
    f'<joint name="{side}_joint"><hardwareInterface>hardware_interface/VelocityJointInterface'
    f'</hardwareInterface></joint><actuator name="{side}_motor"/></transmission>'
    for side in ("left", "right")
)
CONTROLLER = """base:
  type: diff_drive_controller/DiffDriveController
  left_wheel: left_joint
  right_wheel: right_joint
  wheel_separation: 0.3
  wheel_radius: 0.05
"""


@pytest.mark.parametrize(
    ("package", "code"), [(ROS1, PLUGIN_LEFT_OUT), (ROS2, PLUGIN_OF_OTHER_ROS)]
)
def test_tags_of_the_other_version_are_the_reason_before_the_joints_in_them(
    tmp_path, package, code
):
    (tmp_path / "package.xml").write_text(package)
    lost = plugin().replace(">left_joint<", ">no_such_joint<")
    (fault,) = try_robot(written(tmp_path, cart(), lost), standing=0.5).faults
    assert (fault.test, fault.code) == ("plugin", code)


@pytest.mark.parametrize(
    ("package", "expected"),
    [(ROS1, ("turn", WHEEL_SEPARATION_MISMATCH)), (ROS2, ("controller", PLUGIN_OF_OTHER_ROS))],
)
def test_how_a_controller_drives_is_no_fault_if_gazebo_does_not_run_it(tmp_path, package, expected):
    """The separation is that of wheels further apart, so the base turns too fast."""
    (tmp_path / "package.xml").write_text(package)
    (tmp_path / "config").mkdir()
    (tmp_path / "config/base.yaml").write_text(CONTROLLER)
    verdict = try_robot(written(tmp_path, cart(), CONTROL), standing=0.5)
    assert [each.topic for each in verdict.drives] == ["/base/cmd_vel"]
    assert [(each.test, each.code) for each in verdict.faults] == [expected]
