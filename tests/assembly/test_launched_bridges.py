"""Configuration files of ros_gz_bridge that a launch file names."""

import pytest

from cartwheel.assembly.launched import open_launch
from cartwheel.codes.devices import BRIDGE_FILE_INVALID

ENTRY = "- {{topic_name: {name}, ros_type_name: sensor_msgs/msg/Imu, gz_type_name: gz.msgs.IMU}}\n"
LAUNCH = """
share = get_package_share_directory("bot")

def generate_launch_description():
    return LaunchDescription([
        Node(package="ros_gz_bridge", executable="parameter_bridge",
             parameters=[{"config_file": os.path.join(share, "bridge.yaml")}]),
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{"robot_description":
                          Command(["xacro ", os.path.join(share, "bot.xacro")])}]),
        Node(package="ros_gz_sim", executable="create",
             arguments=["-topic", "robot_description", "-name", "one"]),
    ])
"""


@pytest.mark.parametrize(("name", "valid"), [("/imu", True), ("<robot>/imu", False)])
def test_a_file_in_which_the_launch_file_replaces_names_stops_nothing(tmp_path, name, valid):
    (tmp_path / "package.xml").write_text("<package><name>bot</name></package>")
    (tmp_path / "bot.xacro").write_text('<robot name="bot"><link name="base"/></robot>')
    (tmp_path / "bridge.yaml").write_text(ENTRY.format(name=name))
    (tmp_path / "a.launch.py").write_text(LAUNCH)
    found = open_launch(tmp_path / "a.launch.py", {})
    assert [each.name for each in found.models] == ["one"]
    assert found.bridges == ((tmp_path / "bridge.yaml",) if valid else ())
    said = [each for each in found.diagnostics if each.code is BRIDGE_FILE_INVALID]
    assert [each.severity for each in said] == ([] if valid else ["warning"])
    assert all(each.origin.line == 1 for each in said)
