"""Findings in the stand-ins for packages that are not installed."""

import pytest

import cartwheel
from cartwheel.checks.reported import outside_stand_ins
from cartwheel.codes import files, robot
from cartwheel.description.files.package_folders import stand_ins
from cartwheel.errors import Origin

INSIDE = str(stand_ins() / "realsense2_description" / "urdf" / ".." / ".." / "parts.xacro")
CALL = "robot.xacro:12 xacro:sensor_d435"
BODY = (
    '<link name="base">'
    '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><box size="0.5 0.5 0.5"/></geometry></collision></link>'
)


def test_the_plugins_of_a_stand_in_are_not_reported_for_a_robot_of_ros2(tmp_path):
    stated = "<export><build_type>ament_cmake</build_type></export>"
    (tmp_path / "package.xml").write_text(f"<package><name>mine</name>{stated}</package>")
    path = tmp_path / "robot.xacro"
    path.write_text(
        f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{BODY}<xacro:include '
        'filename="$(find realsense2_description)/urdf/_d435i.urdf.xacro"/>'
        '<xacro:sensor_d435i parent="base"><origin xyz="0.2 0 0"/></xacro:sensor_d435i></robot>'
    )
    assert [each.code for each in cartwheel.check(path).findings] == [files.STAND_IN_USED]


@pytest.mark.parametrize("severity", ["info", "warning", "error"])
def test_errors_are_reported_at_the_call(severity):
    origin = Origin(file=INSIDE, line=75, stack=(f"{INSIDE}:9 xacro:part", CALL))
    found = robot.MASS_NOT_POSITIVE.diagnostic("m", origin=origin, severity=severity, mark="x")
    kept = list(outside_stand_ins("robot.xacro", [found]))
    expected = [(Origin(file="robot.xacro", line=12), "")] if severity == "error" else []
    assert [(each.origin, each.mark) for each in kept] == expected
    assert list(outside_stand_ins(INSIDE, [found])) == [found]
